#pragma once
// One face for the two ways of deforming, so that the loop need not know which it runs.

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>

namespace nendo::flow {

/// type1: the start points are frozen, the rest shape is deformed anew each tick. type2: the
/// fingertips' paths are followed piece by piece.
enum class Mode : std::uint8_t { type1, type2 };

std::string_view name_of(Mode mode) noexcept;
std::optional<Mode> mode_named(std::string_view name) noexcept;

struct SculptorOptions {
  Mode mode = Mode::type1;
  double piece_length = 0.05; ///< of a cut of type 2, in model units
  deform::DeformerOptions deformer;
};

class Sculptor {
public:
  Sculptor(deform::Points rest, Eigen::Index control_points, const SculptorOptions& options);

  /// The fingertips take hold of the model here (3 by control_points, model units).
  deform::FieldStatus grab(const deform::Points& tips) noexcept;
  /// The shape for the fingertips' present places, into `out`; what `out` has of it already is not
  /// written again. Wait-free (with a second thread: no longer than that needs); no allocation if
  /// `out` has the size.
  deform::FieldStatus update(const deform::Points& tips, deform::BlockShape& out) noexcept;
  /// Does what update() does, and completes the stroke up to `tips`.
  deform::FieldStatus finish(const deform::Points& tips, deform::BlockShape& out) noexcept;
  /// To be called after finish() with the same tips: the shape that it gave becomes the rest shape,
  /// and the fingertips hold that where they are. Unless solved, nothing changes. No allocation.
  deform::FieldStatus commit(const deform::Points& tips) noexcept;

  /// Back to the rest shape before the last commit, or to the one that the last stroke began with
  /// (Type1Deformer::undo, Type2Deformer::undo); the fingertips hold it at `tips`. Unless solved,
  /// nothing changes. No allocation.
  deform::FieldStatus undo(const deform::Points& tips) noexcept;
  /// Forth to what the last undo came from, if nothing was committed since (Type1Deformer::redo,
  /// Type2Deformer::redo). Where there is nothing to redo, nothing changes, and it is ok.
  deform::FieldStatus redo(const deform::Points& tips) noexcept;
  std::size_t undo_steps() const noexcept;
  std::size_t redo_steps() const noexcept;
  /// How many could be undone once, and went for want of memory.
  std::size_t forgotten_steps() const noexcept;

  /// The shape that nobody holds: the rest shape, or where the last stroke ended.
  const deform::BlockShape& rest() const noexcept;
  /// Makes points in the mesh's order of shapes in blocks.
  const deform::BlockLayout& layout() const noexcept;

  /// Returns the fields of the last update: for type 1 they lead from the rest shape to this shape,
  /// for type 2 from the shape before.
  const deform::FieldSequence& fields() const noexcept;
  /// Returns what the last update() needed to stay injective; all 0 if that is not asked for.
  deform::ChainReport report() const noexcept;

private:
  std::variant<deform::Type1Deformer, deform::Type2Deformer> deformer_;
};

} // namespace nendo::flow
