#pragma once
// Calibrations as users name them: a path, a stored file's name without .toml, or a wearer.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration_store.hpp>

namespace nendo::gloves {

/// What is stored on this machine, by the environment's folders; says on standard error which files
/// cannot be read.
hand::CalibrationList stored_calibrations();

/// A text with a slash or the ending .toml is a path. Of a wearer's calibrations those in force
/// count. Errors: bad_input (no such, cannot be read), usage (several are meant).
Result<hand::StoredCalibration> named_calibration(const std::string& name);

/// "Anna, right hand, glove A1".
std::string title_of(const hand::WearerCalibration& wearer);

} // namespace nendo::gloves
