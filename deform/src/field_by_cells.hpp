#pragma once
// Evaluation of a field of many functions, each of which few points feel.

#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// As displace(), bit for bit: a point's terms are added in the same order, without those that are
/// out of reach. The time is that of the functions in reach. Allocates. out: as many as points; may
/// be `points` itself.
void displace_by_cells(const CsrbfField& field, const Points& points, Points& out);

} // namespace nendo::deform
