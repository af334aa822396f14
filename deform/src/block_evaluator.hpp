#pragma once
// Evaluates fields on shapes in blocks, with vector instructions: what Type-1 and Type-2 have in
// common.

#include <cstddef>
#include <memory>
#include <vector>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/field.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// A shape that knows its blocks' bounds.
struct BoundedShape {
  explicit BoundedShape(BlockShape blocks);
  /// Becomes equal to `other`. Allocates only where the sizes differ.
  void follow(const BoundedShape& other);

  BlockShape shape;
  std::vector<BlockBounds> bounds; ///< one a block
  double extent = 0.0;             ///< no coordinate is larger
};

/// Not for two threads at a time. Functions without a word on it neither allocate nor wait.
class BlockEvaluator {
public:
  /// Allocates for fields of so many entries.
  BlockEvaluator(const BlockLayout& layout, Eigen::Index entries, const EvaluationOptions& options);
  ~BlockEvaluator();
  BlockEvaluator(BlockEvaluator&&) noexcept;
  BlockEvaluator& operator=(BlockEvaluator&&) noexcept;

  /// The field for the next calls; false, and the zero field, if it has a number that is not finite
  /// or too large for float. Allocates only for more entries than ever before.
  bool set_field(const CsrbfField& field) noexcept;
  /// to = from + s(from). Blocks that nothing reaches are copied only where `to` differs from
  /// `from`. False, and `to` is `from`, if the result might not be finite.
  bool displace(const BoundedShape& from, BlockShape& to) noexcept;
  /// shape += s(shape), bounds and stamps included. Returns false, and does nothing, if the result
  /// might not be finite.
  bool displace(BoundedShape& shape) noexcept;
  /// How many pairs of a block and a support that reaches its bounds there are: what displace()
  /// lists before it evaluates, 64 influences each.
  std::size_t count_pairs(const BoundedShape& shape) noexcept;

  struct Parts;
  /// Of the library's own: what Type-1's weights share.
  Parts& parts() noexcept { return *parts_; }

private:
  bool fits(const BoundedShape& shape) const noexcept;
  bool fits_measured(BoundedShape& shape) const noexcept;

  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::deform
