#pragma once
// Reads the model of a run, which may be in several files.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::takes {

/// Reads that file, or those of cli::files_of_name(), which then stand side by side
/// (deform::side_by_side()). Errors: those of deform::read_mesh(); bad_input (too large together).
Result<deform::Mesh> read_models(const std::string& name);

} // namespace nendo::takes
