#include <nendo/deform/sculpted_shape.hpp>

#include <cassert>
#include <utility>

#include <nendo/deform/deformer_options.hpp>

#include "sculpted_parts.hpp"

namespace nendo::deform {

SculptedShape::SculptedShape(Points original, const DeformerOptions& options,
                             const BlockShape* first)
    : layout_(std::move(original)) {
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

void SculptedShape::fence() noexcept {
  parts_->history.fence();
}

void SculptedShape::unfence() noexcept {
  parts_->history.unfence();
}

} // namespace nendo::deform
