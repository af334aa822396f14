#pragma once
// What the deformation is measured against.

#include <nendo/deform/csrbf.hpp>

namespace nendo::test {

/// s at the points, by the paper's equations as one system in world coordinates, with another
/// factorisation.
deform::Points dense_displacements(const deform::CsrbfOptions& options,
                                   const deform::Points& starts, double radius,
                                   const deform::Points& displacements,
                                   const deform::Points& points);

} // namespace nendo::test
