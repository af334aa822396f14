#pragma once
// Parts of a model as rigid bodies, which hands take, move, turn and put down. The model is not
// deformed, and parts go through each other.

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

/// The parts of a mesh: two vertices are of one part if edges lead from the one to the other. They
/// are numbered from 0 by their first vertices. It does not change: thread-safe.
class NENDO_API ModelParts {
public:
  /// Allocates. The layout is the mesh's.
  ModelParts(const Mesh& mesh, const BlockLayout& layout);

  /// A block with vertices of a part: bit k is that of the k-th.
  struct Block {
    std::uint32_t number = 0;
    std::uint64_t lanes = 0;

    /// Calls `visit` with the number in the block of each of them.
    template <class Visit>
    void each_lane(const Visit& visit) const {
      for (std::uint64_t left = lanes; left != 0; left &= left - 1)
        visit(static_cast<std::size_t>(std::countr_zero(left)));
    }
  };
  std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(starts_.size()) - 1; }
  /// Returns those of a part, by rising numbers.
  std::span<const Block> blocks_of(std::uint32_t part) const noexcept {
    return {blocks_.data() + starts_[part], blocks_.data() + starts_[part + 1]};
  }
  /// Returns the part of the vertex at that place in block order; no_index if it has no face.
  std::uint32_t at_place(std::size_t place) const noexcept { return of_place_[place]; }

private:
  std::vector<std::uint32_t> of_place_;
  std::vector<std::size_t> starts_;
  std::vector<Block> blocks_;
};

/// What a hand does, in model units.
struct PartGrip {
  /// It turns with the hand, and its origin is where fingers meet.
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  bool is_closed = false;
};

struct PartMoverOptions {
  std::size_t hands = 2;
  double reach = 0.0; ///< reach of closing fingers, model units, > 0
  /// Parts with a vertex of a weight below 1/2 stay where they are.
  std::shared_ptr<const VertexMask> mask{};
};

/// A hand that closes takes the part whose nearest vertex is nearest to its frame's origin, if that
/// is within reach or within the part's box. The part then goes with the frame, until the hand
/// opens. What two hands hold goes with both: the line between them leads it, and the mean of their
/// turns about that line.
class NENDO_API PartMover {
public:
  /// Allocates. Call release() before another deformer works on `shape`, which must outlive this.
  PartMover(SculptedShape& shape, std::shared_ptr<const ModelParts> parts,
            const PartMoverOptions& options);
  ~PartMover();
  PartMover(PartMover&&) noexcept;
  PartMover& operator=(PartMover&&) noexcept;

  /// Ends the stroke before, which can then be undone. What hands hold they hold on to, from
  /// where `grips`, one a hand, are now. The status is ok or not_finite, in which case nothing
  /// changes.
  FieldStatus begin(std::span<const PartGrip> grips) noexcept;
  /// Does the same, but without ending the stroke before.
  FieldStatus grab(std::span<const PartGrip> grips) noexcept;
  /// Releases until the next begin() or grab(). With `is_step`, the stroke has ended.
  void release(bool is_step) noexcept;
  /// Moves what is held, and takes or puts down what hands that close or open have under them.
  /// Wait-free, without allocation; its cost is that of the vertices that move, and of all where a
  /// hand closes. Before begin() or grab(), this is begin().
  FieldStatus move_to(std::span<const PartGrip> grips) noexcept;

  /// Does what Type2Deformer::go() does; `grips` are where the hands then are.
  FieldStatus go(HistoryMove move, std::span<const PartGrip> grips) noexcept;

  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  const BlockShape& shape() const noexcept { return shape_->shape(); }
  /// Returns whether the last move_to() moved anything.
  bool is_moved() const noexcept;
  /// Returns the part that a hand holds; no_index: none.
  std::uint32_t held_by(std::size_t hand) const noexcept;

private:
  class Work;

  SculptedShape* shape_;
  std::unique_ptr<Work> work_;
};

} // namespace nendo::deform
