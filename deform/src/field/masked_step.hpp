#pragma once
// A step that changes a shape in place, of which a mask then undoes what it does not leave.

#include <cstdint>
#include <memory>
#include <vector>

#include <nendo/deform/vertex_mask.hpp>

#include "field/block_evaluator.hpp"

namespace nendo::deform {

/// Belongs to one thread. After the constructor nothing allocates.
class MaskedStep {
public:
  /// Without a mask (null), the functions do nothing.
  explicit MaskedStep(std::shared_ptr<const VertexMask> mask);

  const VertexMask* mask() const noexcept { return mask_.get(); }
  void begin(const BlockShape& shape) noexcept; ///< call it before the shape changes
  void end(BoundedShape& shape) const noexcept; ///< call it afterwards; updates bounds and stamps

private:
  std::shared_ptr<const VertexMask> mask_;
  std::vector<VertexBlock> kept_; ///< one for each part of the mask
  std::vector<std::uint64_t> stamps_;
};

} // namespace nendo::deform
