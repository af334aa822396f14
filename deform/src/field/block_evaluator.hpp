#pragma once
// Shapes in blocks with their bounds, and the evaluation of fields on them by vector instructions.

#include <cstddef>
#include <memory>
#include <vector>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/field.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// A shape that knows its blocks' bounds.
struct NENDO_API BoundedShape {
  explicit BoundedShape(BlockShape blocks);
  /// Becomes equal to `other`. Allocates only where the sizes differ.
  void follow(const BoundedShape& other);

  BlockShape shape;
  std::vector<BlockBounds> bounds; ///< one per block
  double extent = 0.0;             ///< no coordinate is larger
};

/// Makes what a block has beyond its `used` vertices equal to the last of these, as
/// BlockLayout::pack() does.
inline void repeat_last(VertexBlock& block, std::size_t used) noexcept {
  const Eigen::Vector3f last = vertex_in(block, used - 1);
  for (std::size_t lane = used; lane < block_size; ++lane)
    set_vertex(block, lane, last);
}

/// An evaluator belongs to one thread at a time. Its functions neither allocate nor wait, except
/// where they say so.
class NENDO_API BlockEvaluator {
public:
  /// Allocates for fields of `entries` functions.
  BlockEvaluator(const BlockLayout& layout, Eigen::Index entries, const EvaluationOptions& options);
  ~BlockEvaluator();

  /// Allocates for fields that are halfway (CsrbfField::is_halfway).
  void reserve_halves(const BlockLayout& layout);
  /// Sets the field for the next calls. Returns false, and sets the zero field, if a number in it
  /// is not finite or is too large for float. Allocates only for more entries than ever before.
  bool set_field(const CsrbfField& field) noexcept;
  /// Computes to = from + s(from). Blocks that nothing reaches are copied only where `to` differs
  /// from `from`. Returns false, and makes `to` equal to `from`, if the result might not be finite.
  bool displace(const BoundedShape& from, BlockShape& to) noexcept;
  /// Computes shape += s(shape), with its bounds and stamps. Returns false, and does nothing, if
  /// the result might not be finite. A field that is halfway is kept for the next call, which must
  /// be for the same shape.
  bool displace(BoundedShape& shape) noexcept;
  /// Returns the number of pairs of a block and a support that reaches its bounds. displace() lists
  /// these pairs before it evaluates; each has 64 influences.
  std::size_t count_pairs(const BoundedShape& shape) noexcept;

  struct Parts;
  /// Returns the parts that Type-1's weights share. For this library only.
  Parts& parts() noexcept { return *parts_; }

private:
  bool fits(const BoundedShape& shape) const noexcept;
  bool fits_measured(BoundedShape& shape) const noexcept;

  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::deform
