#pragma once
// Reads the model of a run, which may be in several files.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/setup.hpp>

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

/// Writes the mesh into a file whose axis `up` points up, and notes on standard error what such a
/// file cannot keep. Errors: those of deform::write_mesh().
Result<void> write_model(const std::string& file, const deform::Mesh& mesh,
                         deform::UpAxis up = deform::UpAxis::y);

/// Adds --up to a command that reads models.
void add_up_option(cli::Command& command, std::string& up);
/// Returns what that option says.
deform::ReadOptions reading(const std::string& up);

struct RecordedModel {
  deform::Mesh mesh;
  bool is_recorded = true;       ///< it is made of the file as it was then
  deform::ReadOptions reading{}; ///< how the file was read
  deform::UpAxis up() const noexcept { return reading.up_axis(); }
};
/// Reads the model from the file `named`, or from the recorded file name if `named` is empty, and
/// subdivides and refines it as it was before the recording began. It is read as it was then: of
/// the ways to read it, with y or z up for example, that whose vertices are the recorded ones.
/// Prints a note on standard error if it is not the recorded model. Errors: those of
/// deform::read_mesh(); bad_input if the recorded file has changed, or the named one cannot be
/// refined so.
Result<RecordedModel> find_recorded_model(const recording::LoopSetup& loop,
                                          const std::string& named = {});
/// Does the same for the recording in `file`. Error: also bad_input if no loop was recorded.
Result<RecordedModel> recorded_model(const std::string& file, const recording::Setup& setup,
                                     const std::string& named = {});

/// Writes the shape with which a recording began in the middle of a run into `file`, and makes it
/// the setup's model, as if the run had begun with it; `model` becomes the one read from there.
/// Returns whether it did: not for a recording that began with its model. Blocks. Errors: those of
/// write_mesh() and read_mesh().
Result<bool> begin_with_first_shape(const std::string& file, recording::Setup& setup,
                                    RecordedModel& model);

/// Prints a note on standard error that something is missing in the recording.
void note_missing(const std::string& file);

} // namespace nendo::takes
