#pragma once
// Evaluates a field of many functions, each of which reaches few points.

#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// Computes what displace() does, bit for bit: a point's terms are added in the same order, without
/// those that are out of reach. It takes time only for the functions in reach. Allocates. `out`
/// must have as many columns as `points`, and may be `points` itself.
void displace_by_cells(const CsrbfField& field, const Points& points, Points& out);

} // namespace nendo::deform
