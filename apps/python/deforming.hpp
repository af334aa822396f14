#pragma once
// The options that a field and the deformers have in common, as Python passes them.

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/deformer_options.hpp>

#include "python/arrays.hpp"

namespace nendo::python {

/// Returns the kernel of this name. Throws ValueError.
deform::Wendland kernel_of(const std::string& name);
/// Returns the supports of `points` control points: one radius, or one for each. Throws TypeError
/// or ValueError.
deform::Supports supports_of(const py::object& radius, Eigen::Index points);
/// Throws Error unless the status is that of a solved field.
void check(deform::FieldStatus status);

} // namespace nendo::python
