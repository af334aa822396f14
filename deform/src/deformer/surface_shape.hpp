#pragma once
// What the deformers along the surface do with a field and a shape.

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/surface_field.hpp>

#include "field/block_evaluator.hpp"

namespace nendo::deform {

/// Solves for these control vectors (3 by #points, model units) of a shape whose coordinates are at
/// most `extent`. If float could not hold what they make of it, the coefficients are 0 and the
/// status is not_finite.
FieldStatus solve_within(const SurfaceField& field, const Points& vectors, double extent,
                         SurfaceField::Coefficients& coefficients) noexcept;

/// Writes to = from + s, with the bounds. `from` may be the shape of `to`. Does not allocate.
void displace(const SurfaceField& field, const SurfaceField::Coefficients& by,
              const BlockShape& from, BoundedShape& to) noexcept;

} // namespace nendo::deform
