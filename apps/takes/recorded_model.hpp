#pragma once
// The model over which a loop was recorded.

#include <string>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/setup.hpp>

namespace nendo::takes {

struct RecordedModel {
  deform::Mesh mesh;
  bool is_recorded = true;       ///< it is made of the file as it was then
  deform::ReadOptions reading{}; ///< how the file was read
  deform::UpAxis up() const noexcept { return reading.up.value_or(deform::UpAxis::y); }
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

/// Prints a note on standard error that something is missing in the recording.
void note_missing(const std::string& file);

} // namespace nendo::takes
