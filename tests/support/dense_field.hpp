#pragma once
// The reference with which the deformation is compared.

#include <nendo/deform/csrbf.hpp>

namespace nendo::test {

/// Returns s at the points. It solves the paper's equations as one system in world coordinates,
/// with another factorisation.
deform::Points dense_displacements(const deform::CsrbfOptions& options,
                                   const deform::Points& starts, double radius,
                                   const deform::Points& displacements,
                                   const deform::Points& points);

} // namespace nendo::test
