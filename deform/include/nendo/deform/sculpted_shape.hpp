#pragma once
// A shape that deformers change, with its layout and undo history. Several deformers may work on
// one shape in turn, so that settings can change while the shape and its history are kept.

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

/// A caller's data about a step of the history, for example its name, or the previous settings.
/// This library does not interpret the bytes.
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

/// A move in the history of a shape. Changes since the last step become a step first, except by a
/// redo, which discards them.
enum class HistoryMove : std::uint8_t {
  undo, ///< reverts the last step; without one, the shape is unchanged
  redo, ///< restores the shape before the last undo; without one, does nothing (status ok)
  reset ///< restores the original shape, as a step
};

class NENDO_API SculptedShape {
public:
  /// Allocates for the vertices (3 by #vertices) and for the history: DeformerOptions::undo_bytes
  /// and undo_memory. With `first`, which must have the layout's size, the shape begins as `first`,
  /// and HistoryMove::reset restores `original`.
  SculptedShape(Points original, const DeformerOptions& options, const BlockShape* first = nullptr)
      : SculptedShape(BlockLayout(std::move(original)), options, first) {}
  SculptedShape(BlockLayout layout, const DeformerOptions& options, const BlockShape* first);
  ~SculptedShape();
  SculptedShape(const SculptedShape&) = delete;
  SculptedShape& operator=(const SculptedShape&) = delete;

  const BlockLayout& layout() const noexcept { return layout_; }
  /// Returns the shape as the current deformer left it: Type1Deformer::rest() or
  /// Type2Deformer::shape().
  const BlockShape& shape() const noexcept;

  /// Return the numbers of steps that can be undone and redone.
  std::size_t undo_steps() const noexcept;
  std::size_t redo_steps() const noexcept;
  /// Returns the number of steps that can no longer be undone because memory was full.
  std::size_t forgotten_steps() const noexcept;
  /// Sets the notes of future steps by deformers, and of future resets.
  void set_notes(const StepNote& note, const StepNote& of_reset) noexcept;
  /// Adds a step that does not change the shape, for another undoable change in the same history.
  void mark(const StepNote& note) noexcept;
  // In the next four functions, `move` is undo or redo, and the next step is the next one to undo,
  // or to redo.

  /// Undoes, or redoes, the next step, which mark() must have added. Changes since the previous
  /// step are discarded; call the deformer's release() first. Wait-free.
  void pass_mark(HistoryMove move) noexcept;
  /// Returns the note of the next step; null if there is none.
  const StepNote* next_note(HistoryMove move) const noexcept;
  /// Changes that note. There must be such a step.
  void set_next_note(HistoryMove move, const StepNote& note) noexcept;
  /// Copies the notes of the next steps, the next one first, at most notes.size(). Returns the
  /// number of copied notes.
  std::size_t copy_notes(HistoryMove move, std::span<StepNote> notes) const noexcept;
  /// Returns a number that changes whenever these notes change.
  std::uint64_t history_version() const noexcept;
  /// Limits undo to the current shape, and removes the steps that can be redone. A recording that
  /// begins now then has all data that undo needs. Wait-free, like unfence().
  void fence() noexcept;
  /// Removes the limit of fence().
  void unfence() noexcept;

  struct Parts;
  /// Returns the data that deformers work on. For this library only.
  Parts& parts() noexcept { return *parts_; }
  const Parts& parts() const noexcept { return *parts_; }

private:
  BlockLayout layout_;
  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::deform
