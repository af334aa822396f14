#pragma once
// Reads the model of a run, which may be in several files.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh_file.hpp>

namespace nendo::takes {

/// Reads one file, and notes on standard error what its reader notes and what is strange about it.
/// Vertices of a model far from zero count from deform::usual_offset(). Errors: those of
/// deform::read_model().
Result<deform::ReadModel> read_model(const std::string& file,
                                     const deform::ReadOptions& options = {});

/// Reads that file, or those of cli::files_of_name(), which then stand side by side
/// (deform::side_by_side()). Its vertices count likewise. Errors: those of deform::read_mesh();
/// bad_input (too large together).
Result<deform::ReadModel> read_models(const std::string& name,
                                      const deform::ReadOptions& options = {});
/// Does the same, but its vertices count from zero, as those of old recordings did.
Result<deform::ReadModel> read_models_from_zero(const std::string& name,
                                                const deform::ReadOptions& options = {});

} // namespace nendo::takes
