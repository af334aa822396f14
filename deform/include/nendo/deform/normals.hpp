#pragma once
// Normals of a surface that a field deforms, without its faces: x -> x + s(x) takes tangents by its
// Jacobian J = I + ds/dx, and so a normal n, their cross product, by J's cofactors: cof(J) n, which
// is det(J) J^-T n. That is exact for the field, whatever the mesh; it needs no neighbours, and
// what no support reaches keeps its normal. Those of a mesh's faces (vertex_normals()) come near it
// as the faces become small; where the field folds space, both turn over.

#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// normals: 3 by #points, of the surface at `points` (3 by #points, before the field moves them);
/// each becomes cof(J) n of unit length. One stays as it is where that has no length (a zero
/// normal, a surface that is crushed to a line) or is not finite, or where s has no derivative. In
/// double; BlockEvaluator::turn() is the fast way. No allocation.
void turn_normals(const CsrbfField& field, const Points& points, Points& normals) noexcept;

} // namespace nendo::deform
