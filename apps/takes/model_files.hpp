#pragma once
// Reads the model of a run, which may be in several files.

#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "cli/command.hpp"

namespace nendo::takes {

/// Reads one file, and notes on standard error what its reader notes and what is strange about it.
/// Vertices of a model far from zero count from deform::usual_offset(). Errors: those of
/// deform::read_model().
Result<deform::ReadModel> read_model(const std::string& file,
                                     const deform::ReadOptions& options = {});

/// Reads that file, or those of cli::files_of_name(), which then are placed side by side
/// (deform::side_by_side()). The offset is the same. Errors: those of
/// deform::read_mesh(); bad_input (too large together).
Result<deform::ReadModel> read_models(const std::string& name,
                                      const deform::ReadOptions& options = {});
/// Does the same, but prints nothing.
Result<deform::ReadModel> read_models_silently(const std::string& name,
                                               const deform::ReadOptions& options = {});

/// Says on standard error what the notes say of the model of that name.
void note_all(const std::string& name, const std::vector<std::string>& notes);

/// Writes the mesh into a file whose axis `up` points up, and notes on standard error what such a
/// file cannot keep. Errors: those of deform::write_mesh().
Result<void> write_model(const std::string& file, const deform::Mesh& mesh,
                         deform::UpAxis up = deform::UpAxis::y);

/// Adds --up to a command that reads models.
void add_up_option(cli::Command& command, std::string& up);
/// Returns what that option says.
deform::ReadOptions reading(const std::string& up);
/// Returns the axis that points up in files that are read so.
inline deform::UpAxis axis_of(const deform::ReadOptions& options) noexcept {
  return options.up.value_or(deform::UpAxis::y);
}

} // namespace nendo::takes
