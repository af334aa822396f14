#pragma once
// A wearer's calibration as a file: whose it is, for which glove and hand, how it was made, and the
// numbers. TOML, because people read it and mend it by hand. No exception leaves these functions;
// they block for as long as the disk does.

#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// How well one sensor's line is known.
struct SensorQuality {
  double residual_rad = 0.0; ///< root mean square distance of the poses from the line
  double least_counts = 0.0; ///< of this wearer
  double most_counts = 0.0;  ///< of this wearer
  double confidence = 0.0;   ///< 0 to 1
  friend bool operator==(const SensorQuality&, const SensorQuality&) = default;
};

/// Texts are one line of UTF-8, at most 200 bytes. A sensor whose gain is 0 is not calibrated.
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
  std::array<std::optional<SensorQuality>, sensor_slots> quality{}; ///< of calibrated sensors
};

/// The text of a calibration file. Strict: every key known, typed and there. `name` is what errors
/// call the text. Error: bad_input, "NAME:LINE: what; remedy".
Result<WearerCalibration> parse_calibration(std::string_view text, std::string_view name);
/// What parse_calibration() reads back to the same bits; offsets of uncalibrated sensors become 0.
/// The same calibration gives the same text. Error: bad_input, naming what cannot be written.
Result<std::string> calibration_text(const WearerCalibration& wearer);

/// Error: bad_input, also for what is no regular file or larger than 1 MiB.
Result<WearerCalibration> read_calibration(const std::filesystem::path& path);

/// How many earlier versions stay beside a calibration file.
inline constexpr std::size_t most_earlier_versions = 20;

/// Writes beside, syncs and renames, so that `path` is the old file or the whole new one; makes its
/// folder if need be. An old file stays as NAME.<date>.toml beside it, the newest 20 of them; gives
/// that path, or an empty one. Errors: bad_input (as calibration_text()), failed (the disk).
Result<std::filesystem::path> write_calibration(const std::filesystem::path& path,
                                                const WearerCalibration& wearer);
/// Takes the file out of use: it becomes an earlier version of itself, whose path this gives.
/// Error: failed.
Result<std::filesystem::path> retire_calibration(const std::filesystem::path& path);
/// Whether a path is named as an earlier version is.
bool is_earlier_version(const std::filesystem::path& path);

/// The calibration in the counts of a glove of this scale. A sensor that is not calibrated gets the
/// default's line, as do all if one of the scales is a whole range and the other is not.
Calibration calibration_for(const WearerCalibration& wearer, CountScale glove) noexcept;

/// RFC 3339 in UTC: "2026-11-21T19:27:05Z".
std::string rfc3339(std::chrono::sys_seconds time);

} // namespace nendo::hand
