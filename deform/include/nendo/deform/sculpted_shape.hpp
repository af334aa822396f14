#pragma once
// A shape that deformers change, with its layout and its history. Several deformers may work on one
// shape, one after another, so that their settings can change and the shape and its history stay.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include <nendo/base/api.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

struct DeformerOptions;

/// What a caller notes of a step of the history, for example its name, or the settings before it.
/// The bytes mean nothing to this library.
struct StepNote {
  alignas(8) std::array<std::byte, 192> bytes;

  template <class Value>
  void set(const Value& value) noexcept {
    static_assert(std::is_trivially_copyable_v<Value> && sizeof(Value) <= sizeof(StepNote));
    std::memcpy(bytes.data(), &value, sizeof value);
  }
  template <class Value>
  Value get() const noexcept {
    Value value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
};

/// What a deformer does with the history of its shape. What it has made of the shape since the last
/// step becomes a step first, except by a redo, which drops it.
enum class HistoryMove : std::uint8_t {
  undo, ///< goes back before the last step; without one, the shape stays
  redo, ///< goes to the shape before the last undo; without one, nothing happens (status ok)
  reset ///< goes to the original shape, as a step
};

class NENDO_API SculptedShape {
public:
  /// Allocates for the vertices (3 by #vertices) and for the history: DeformerOptions::undo_bytes
  /// and undo_memory. With `first`, which has the layout's size, the shape is that one, and
  /// `original` is only what HistoryMove::reset goes to.
  SculptedShape(Points original, const DeformerOptions& options, const BlockShape* first = nullptr)
      : SculptedShape(BlockLayout(std::move(original)), options, first) {}
  SculptedShape(BlockLayout layout, const DeformerOptions& options, const BlockShape* first);
  ~SculptedShape();
  SculptedShape(const SculptedShape&) = delete;
  SculptedShape& operator=(const SculptedShape&) = delete;

  const BlockLayout& layout() const noexcept { return layout_; }
  /// Returns the shape as the deformer left it that works on it: Type1Deformer::rest() or
  /// Type2Deformer::shape().
  const BlockShape& shape() const noexcept;

  /// Returns how many steps can be undone, and how many undone ones can be redone.
  std::size_t undo_steps() const noexcept;
  std::size_t redo_steps() const noexcept;
  /// Returns how many steps can no longer be undone because memory ended.
  std::size_t forgotten_steps() const noexcept;
  /// Sets what is noted of the steps that deformers make from now on, and of resets.
  void set_notes(const StepNote& note, const StepNote& of_reset) noexcept;
  /// Adds a step that does not change the shape, for something else that can be undone in its
  /// order.
  void mark(const StepNote& note) noexcept;
  /// Undoes, or does again, the next step, which is one that mark() added. What a deformer has made
  /// since the step before is dropped; call its release() first. Wait-free.
  void undo_mark() noexcept;
  void redo_mark() noexcept;
  /// Returns the note of the step that would be undone, or done again, next; null if there is none.
  const StepNote* to_undo() const noexcept;
  const StepNote* to_redo() const noexcept;
  /// Changes that note. There must be such a step.
  void note_to_undo(const StepNote& note) noexcept;
  void note_to_redo(const StepNote& note) noexcept;
  /// Copies the notes of the last steps that can be undone, the last one first, and of the first of
  /// those that were undone, the first one first. Returns how many there were to copy.
  std::size_t copy_undoable(std::span<StepNote> notes) const noexcept;
  std::size_t copy_undone(std::span<StepNote> notes) const noexcept;
  /// Returns a number that changes whenever these lists do.
  std::uint64_t history_version() const noexcept;
  /// Lets undo go back to the present shape and no farther, and forgets what can be redone. A
  /// recording that begins here then has all that an undo needs. Wait-free, like unfence().
  void fence() noexcept;
  /// Lets undo go back as far as before.
  void unfence() noexcept;

  struct Parts;
  /// Returns what the deformers work on. For this library only.
  Parts& parts() noexcept { return *parts_; }
  const Parts& parts() const noexcept { return *parts_; }

private:
  BlockLayout layout_;
  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::deform
