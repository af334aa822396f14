#pragma once
// A wearer's calibration as a file. It says whose calibration it is, for which glove and hand, how
// it was made, and the numbers. The format is TOML, because people read it and correct it by hand.
// No exception leaves these functions. Those that take a path block for as long as the disk does.

#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/range_capture.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

struct SensorQuality {
  double residual_rad = 0.0; ///< root mean square distance of the poses from the line
  double min_counts = 0.0;   ///< the least that this wearer reached
  double max_counts = 0.0;   ///< the most that this wearer reached
  double confidence = 0.0;   ///< 0 to 1
  friend bool operator==(const SensorQuality&, const SensorQuality&) = default;
};
/// Moves the ends that the wearer reached, as the sensor slips, within what the glove can count.
NENDO_API void move_ends(SensorQuality& quality, double by_counts, CountScale glove) noexcept;

/// A wearer's calibration with its origin. Strings are one line of UTF-8, at most 200 bytes. A
/// sensor whose gain is 0 is not calibrated.
struct WearerCalibration {
  std::string user;
  std::string glove_model;  ///< as GloveInfo::model; empty: any
  std::string glove_serial; ///< serial number or stable name; empty: not known
  CountScale counts;        ///< what the gains and offsets count
  Side side = Side::right;
  std::chrono::sys_seconds made{}; ///< UTC, 1970 to 9999
  std::string method;              ///< "quick", "full", "imported", ...
  HandSize size;
  Calibration calibration;
  std::array<std::optional<SensorQuality>, sensor_slots> quality{}; ///< calibrated sensors only
  SensorMask left_out{}; ///< stuck when it was made, so not calibrated and not used
};

/// Returns the counts that the wearer reached, of the sensors for which the calibration has them.
NENDO_API CountRanges reached_ends(const WearerCalibration& wearer) noexcept;

/// Reads the text of a calibration file. The reader is strict: every key must be known, of the
/// right type, and present. `name` is what errors call the text. Fails with bad_input, "NAME:LINE:
/// what; remedy".
NENDO_API Result<WearerCalibration> parse_calibration(std::string_view text, std::string_view name);
/// Returns a text that parse_calibration() reads back to the same bits, except that offsets of
/// uncalibrated sensors become 0. The same calibration gives the same text. Fails with bad_input,
/// naming what cannot be written.
NENDO_API Result<std::string> calibration_text(const WearerCalibration& wearer);

/// Reads a calibration file. Fails with bad_input, also if it is not a regular file or is larger
/// than 1 MiB.
NENDO_API Result<WearerCalibration> read_calibration(const std::filesystem::path& path);

inline constexpr std::size_t max_earlier_versions = 20;

/// Writes a temporary file beside `path`, syncs and renames it, so that `path` is always the old
/// file or the whole new one. Makes the folder if need be. An old file stays as NAME.DATE.toml
/// beside it (the newest 20 stay); its path is returned, or an empty path if there was none.
/// Errors: bad_input (as calibration_text()), failed (the disk).
NENDO_API Result<std::filesystem::path> write_calibration(const std::filesystem::path& path,
                                                          const WearerCalibration& wearer);
/// Takes the file out of use: it becomes an earlier version of itself, whose path is returned.
/// Error: failed.
NENDO_API Result<std::filesystem::path> retire_calibration(const std::filesystem::path& path);
/// Returns whether a path is named as an earlier version is.
NENDO_API bool is_earlier_version(const std::filesystem::path& path);

/// Returns the calibration in the counts of a glove of this scale. A sensor that is not calibrated
/// gets the default's line. All sensors do if only one of the two scales is a whole range.
NENDO_API Calibration calibration_for(const WearerCalibration& wearer, CountScale glove) noexcept;

/// Returns a time as RFC 3339 writes it in UTC: "2026-11-21T19:27:05Z".
NENDO_API std::string rfc3339(std::chrono::sys_seconds time);

} // namespace nendo::hand
