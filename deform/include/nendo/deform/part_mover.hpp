#pragma once
// Parts of a model as rigid bodies, which hands grab, move, rotate and release. The model is not
// deformed, and parts may pass through each other.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/sculpted_shape.hpp>

namespace nendo::deform {

/// The parts of a mesh: its edge-connected components, indexed from 0 by first vertex. Immutable:
/// thread-safe.
class NENDO_API ModelParts {
public:
  /// Allocates. The layout must be the mesh's.
  ModelParts(const Mesh& mesh, const BlockLayout& layout);

  /// A block with vertices of a part. Bit k of `lanes` is set if vertex k of the block belongs to
  /// it.
  struct Block {
    std::uint32_t number = 0;
    std::uint64_t lanes = 0;

    /// Calls `visit` with the index in the block of each of these vertices.
    template <class Visit>
    void each_lane(const Visit& visit) const {
      for (std::uint64_t left = lanes; left != 0; left &= left - 1)
        visit(static_cast<std::size_t>(std::countr_zero(left)));
    }
  };
  std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(starts_.size()) - 1; }
  /// Returns the blocks of a part, by increasing number.
  std::span<const Block> blocks_of(std::uint32_t part) const noexcept {
    return {blocks_.data() + starts_[part], blocks_.data() + starts_[part + 1]};
  }
  /// Returns the part of a vertex, given its index in block order; no_index if it has no face.
  std::uint32_t at_place(std::size_t place) const noexcept { return of_place_[place]; }

private:
  std::vector<std::uint32_t> of_place_;
  std::vector<std::size_t> starts_;
  std::vector<Block> blocks_;
};

/// The state of a hand, in model units.
struct PartGrip {
  /// The hand's frame, with its origin where the fingers meet.
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  bool is_closed = false;
};

struct PartMoverOptions {
  std::size_t hands = 2;
  double reach = 0.0; ///< reach of closing fingers, model units, > 0
  /// Parts with a vertex of weight below 1/2 do not move.
  std::shared_ptr<const VertexMask> mask{};
};

/// A closing hand grabs the part with the vertex nearest to its frame's origin, if the vertex is
/// within reach or the origin is in the part's box. The part follows the frame until the hand
/// opens. A part that two hands hold follows the line between them, and the mean of their rotations
/// about this line.
class NENDO_API PartMover {
public:
  /// Allocates. Call release() before another deformer works on `shape`, which must outlive this.
  PartMover(SculptedShape& shape, std::shared_ptr<const ModelParts> parts,
            const PartMoverOptions& options);
  ~PartMover();
  PartMover(PartMover&&) noexcept;
  PartMover& operator=(PartMover&&) noexcept;

  /// Ends the previous stroke, which can then be undone. Hands keep the parts that they hold,
  /// relative to `grips`, one per hand. The status is ok, or not_finite, in which case nothing
  /// changes.
  FieldStatus begin(std::span<const PartGrip> grips) noexcept;
  /// Does the same without ending the previous stroke.
  FieldStatus grab(std::span<const PartGrip> grips) noexcept;
  /// Releases the shape until the next begin() or grab(). With `is_step`, ends the stroke.
  void release(bool is_step) noexcept;
  /// Moves the held parts; a closing hand grabs a part, and an opening hand releases it. Wait-free,
  /// without allocation; the cost is linear in the moving vertices, or in all vertices when a hand
  /// closes. Before begin() or grab(), it does what begin() does.
  FieldStatus move_to(std::span<const PartGrip> grips) noexcept;

  /// Does what Type2Deformer::go() does; `grips` are the hands afterwards.
  FieldStatus go(HistoryMove move, std::span<const PartGrip> grips) noexcept;

  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  const BlockShape& shape() const noexcept { return shape_->shape(); }
  /// Returns whether the last move_to() moved anything.
  bool is_moved() const noexcept;
  /// Returns the part that a hand holds; no_index: none.
  std::uint32_t held_by(std::size_t hand) const noexcept;
  /// Returns the part that an open hand would grab now; no_index: none.
  std::uint32_t in_reach_of(std::size_t hand) const noexcept;

private:
  class Work;

  SculptedShape* shape_;
  std::unique_ptr<Work> work_;
};

} // namespace nendo::deform
