#pragma once
// A wearer's calibration as a file. It contains the wearer, the glove, the hand, the method and the
// numbers. The format is TOML, because users read and edit it. These functions throw no exceptions.
// Functions that take a path block on file I/O.

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
  double min_counts = 0.0;   ///< the lowest count that this wearer reached
  double max_counts = 0.0;   ///< the highest count that this wearer reached
  double confidence = 0.0;   ///< 0 to 1
  friend bool operator==(const SensorQuality&, const SensorQuality&) = default;
};
/// Shifts both ends that the wearer reached by a slip of the sensor, clamped to the scale.
NENDO_API void move_ends(SensorQuality& quality, double by_counts, CountScale glove) noexcept;

/// A wearer's calibration with its origin. Strings are one line of UTF-8, at most 200 bytes. A
/// sensor whose gain is 0 is not calibrated.
struct WearerCalibration {
  std::string user;
  std::string glove_model;  ///< as GloveInfo::model; empty: any
  std::string glove_serial; ///< serial number or stable name; empty: not known
  CountScale counts;        ///< the scale of gains and offsets
  Side side = Side::right;
  std::chrono::sys_seconds made{}; ///< UTC, 1970 to 9999
  std::string method;              ///< "quick", "full", "imported", ...
  HandSize size;
  Calibration calibration;
  std::array<std::optional<SensorQuality>, sensor_slots> quality{}; ///< calibrated sensors only
  SensorMask left_out{}; ///< stuck at calibration, so not calibrated and not used
};

/// Returns the ranges of counts that the wearer reached, for sensors that have SensorQuality.
NENDO_API CountRanges reached_ends(const WearerCalibration& wearer) noexcept;

/// Reads the text of a calibration file. The reader is strict: every key must be known, of the
/// right type, and present. Messages call the text `name`. Fails with bad_input, "NAME:LINE: what;
/// remedy".
NENDO_API Result<WearerCalibration> parse_calibration(std::string_view text, std::string_view name);
/// Returns a text that parse_calibration() parses to the same bits, except that offsets of
/// uncalibrated sensors become 0. The same calibration gives the same text. Fails with bad_input,
/// naming the value that cannot be written.
NENDO_API Result<std::string> calibration_text(const WearerCalibration& wearer);

/// Reads a calibration file. Fails with bad_input, also if it is not a regular file or is larger
/// than 1 MiB.
NENDO_API Result<WearerCalibration> read_calibration(const std::filesystem::path& path);

inline constexpr std::size_t max_earlier_versions = 20;

/// Replaces `path` atomically, by a temporary file that is synced and renamed. Creates the folder
/// if needed. Keeps the old file as NAME.DATE.toml in the same folder (the newest 20 are kept) and
/// returns its path, or an empty path if there was none. Errors: bad_input (as calibration_text()),
/// failed (the disk).
NENDO_API Result<std::filesystem::path> write_calibration(const std::filesystem::path& path,
                                                          const WearerCalibration& wearer);
/// Renames the file to an earlier version, so that it is not used, and returns the new path. Error:
/// failed.
NENDO_API Result<std::filesystem::path> retire_calibration(const std::filesystem::path& path);
/// Returns whether the file name is that of an earlier version.
NENDO_API bool is_earlier_version(const std::filesystem::path& path);

/// Returns the calibration, converted to a glove of this scale. Uncalibrated sensors get the
/// default's line; so do all sensors if only one of the two scales is self-calibrated.
NENDO_API Calibration calibration_for(const WearerCalibration& wearer, CountScale glove) noexcept;

/// Returns a time in UTC, in the format of RFC 3339: "2026-11-21T19:27:05Z".
NENDO_API std::string rfc3339(std::chrono::sys_seconds time);

} // namespace nendo::hand
