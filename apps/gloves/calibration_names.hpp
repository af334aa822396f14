#pragma once
// Finds calibrations as users name them: by a path, by a stored file's name without .toml, or by a
// wearer.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration_store.hpp>

namespace nendo::gloves {

/// Returns what is stored on this machine, in the folders that the environment gives. Says on
/// standard error which files cannot be read. Blocks.
hand::CalibrationList stored_calibrations();

/// Returns the calibration that `name` means. A text with a slash or the ending .toml is a path. A
/// wearer's name means those of the wearer's calibrations that are in force. Blocks. Errors:
/// bad_input (there is none, or it cannot be read), usage (several are meant).
Result<hand::StoredCalibration> named_calibration(const std::string& name);

/// Returns a text such as "Anna, right hand, glove A1".
std::string title_of(const hand::WearerCalibration& wearer);

} // namespace nendo::gloves
