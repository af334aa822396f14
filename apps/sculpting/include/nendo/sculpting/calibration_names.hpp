#pragma once
// Finds calibrations as users name them: by a path, by a stored file's name without .toml, or by a
// wearer.

#include <functional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration_store.hpp>

namespace nendo::sculpting {

/// Receives a notice for the user in one line. It is called on the thread
/// of the function that it is given to.
using Note = std::function<void(std::string_view)>;

/// Returns the calibrations in the folders that the environment gives. Notes which files cannot be
/// read. Blocks.
NENDO_API hand::CalibrationList stored_calibrations(const Note& note);

/// Returns the calibration that `name` means. A text with a slash or the ending .toml is a path. A
/// wearer's name means those of the wearer's calibrations that are in effect. Blocks. Errors:
/// bad_input (there is none, or it cannot be read), usage (several are meant).
NENDO_API Result<hand::StoredCalibration> named_calibration(const std::string& name,
                                                            const Note& note);

/// Returns a text such as "Anna, right hand, glove A1".
NENDO_API std::string title_of(const hand::WearerCalibration& wearer);

/// Returns "index_pip", or "index_pip and ring_mcp", and so on.
NENDO_API std::string sensors_in_words(SensorMask sensors);
NENDO_API bool is_one(SensorMask sensors) noexcept;

} // namespace nendo::sculpting
