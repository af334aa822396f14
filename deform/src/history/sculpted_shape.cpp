#include <nendo/deform/sculpted_shape.hpp>

#include <cassert>
#include <utility>

#include <nendo/deform/deformer_options.hpp>

#include "history/sculpted_parts.hpp"

namespace nendo::deform {

SculptedShape::SculptedShape(BlockLayout layout, const DeformerOptions& options,
                             const BlockShape* first)
    : layout_(std::move(layout)) {
  BoundedShape loaded(layout_.pack());
  BoundedShape now = first != nullptr ? BoundedShape(*first) : loaded;
  assert(now.shape.block_count() == layout_.block_count());
  ShapeHistory history(now.shape, options.undo_bytes, options.undo_memory);
  parts_ = std::make_unique<Parts>(Parts{std::move(loaded), std::move(now), std::move(history)});
}

SculptedShape::~SculptedShape() = default;

const BlockShape& SculptedShape::shape() const noexcept {
  return parts_->now.shape;
}

std::size_t SculptedShape::undo_steps() const noexcept {
  return parts_->history.steps();
}

std::size_t SculptedShape::redo_steps() const noexcept {
  return parts_->history.undone();
}

std::size_t SculptedShape::forgotten_steps() const noexcept {
  return parts_->history.forgotten();
}

void SculptedShape::set_notes(const StepNote& note, const StepNote& of_reset) noexcept {
  parts_->note = note;
  parts_->note_of_reset = of_reset;
}

void SculptedShape::mark(const StepNote& note) noexcept {
  parts_->history.mark(note);
}

void SculptedShape::undo_mark() noexcept {
  parts_->revert();
  parts_->history.undo(parts_->now);
}

void SculptedShape::redo_mark() noexcept {
  parts_->go(HistoryMove::redo);
}

const StepNote* SculptedShape::to_undo() const noexcept {
  return parts_->history.to_undo();
}

const StepNote* SculptedShape::to_redo() const noexcept {
  return parts_->history.to_redo();
}

void SculptedShape::note_to_undo(const StepNote& note) noexcept {
  parts_->history.note_to_undo(note);
}

void SculptedShape::note_to_redo(const StepNote& note) noexcept {
  parts_->history.note_to_redo(note);
}

std::size_t SculptedShape::copy_undoable(std::span<StepNote> notes) const noexcept {
  return parts_->history.copy_undoable(notes);
}

std::size_t SculptedShape::copy_undone(std::span<StepNote> notes) const noexcept {
  return parts_->history.copy_undone(notes);
}

std::uint64_t SculptedShape::history_version() const noexcept {
  return parts_->history.version();
}

void SculptedShape::fence() noexcept {
  parts_->history.fence();
}

void SculptedShape::unfence() noexcept {
  parts_->history.unfence();
}

} // namespace nendo::deform
