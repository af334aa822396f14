#pragma once
// Normals in vectors: what a field makes of them, with or without moving the vertices.

#include "simd/field_kernels.hpp"

namespace nendo::deform {

/// Of the same blocks as a BlockPass; `to` may be `from`.
struct NormalPass {
  const VertexBlock* from;
  VertexBlock* to;
};

/// displace_pass(), and the normals of what it makes, of unit length. pass.to may be null: then
/// only normals are written. A vertex whose surroundings are crushed, or without a normal before,
/// keeps what it had.
void displace_normals_pass(const FieldView& field, const BlockPass& pass,
                           const NormalPass& normals) noexcept;

} // namespace nendo::deform
