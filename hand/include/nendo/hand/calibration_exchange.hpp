#pragma once
// Calibrations of other programs, in and out. All texts are hostile until they have been read to
// the end; nothing here touches a file but the last two functions.
//
// Signs: the vendor's angle is -gain * (count - offset) in a frame where flexion is negative, so
// its positive gains are those of ours, where flexion and spreading are positive: a CyberGlove's
// counts rise with both. A text whose bend sensors (or pair sensors) all have the other sign means
// the other frame, and is turned; one that has both signs among them is refused.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::hand {

struct ImportedCalibration {
  Calibration calibration;        ///< in counts of 0 to 255
  std::optional<Side> side;       ///< if the text tells
  std::vector<std::string> notes; ///< what was read otherwise than written, one line each
};

struct ExportedCalibration {
  std::string text;
  std::vector<std::string> notes; ///< what the format cannot hold, one line each
};

enum class CalibrationFormat : std::uint8_t { toml, virtualhand, two_point, csv };

/// By what the text looks like; virtualhand if like nothing known.
CalibrationFormat format_of(std::string_view text) noexcept;

// Errors of all readers: bad_input, "NAME:LINE: what; remedy". Of all writers: bad_input.

/// VirtualHand's .cal as VTI's library writes it (version, comments, FINGER headings, geometry), as
/// the Device Configuration Utility does (a header line, headed groups), and as MotorControl does
/// (tabs, no headings): six groups of four rows `joint offset gain`. In it the row of the sensor
/// that no glove has (slot 7) holds the gain of slot 11, whose own gain is the middle bias.
Result<ImportedCalibration> parse_virtualhand(std::string_view text, std::string_view name);
/// In VTI's structure; offsets are rounded to whole counts, gains to five decimals. Refuses offsets
/// outside 0 to 255, uncalibrated sensors that every glove has, and self-calibrating gloves.
Result<ExportedCalibration> virtualhand_text(const Calibration& calibration, CountScale counts);

/// asr_cyberglove's: 22 lines `angle_rad:count angle_rad:count`, two points of each sensor's line,
/// in the order of its hand model: wrist, thumb, then each finger with its abduction second. The
/// place of the palm arch is there but not used.
Result<ImportedCalibration> parse_two_point(std::string_view text, std::string_view name);

/// Lines `sensor,gain_rad_per_count,offset_counts` under that header; # begins a comment.
Result<ImportedCalibration> parse_calibration_csv(std::string_view text, std::string_view name);
/// Calibrated sensors only, in numbers that read back to the same bits.
Result<ExportedCalibration> calibration_csv_text(const Calibration& calibration);

/// A regular file of at most 1 MiB; a pipe or device is refused. Blocks. Error: bad_input.
Result<std::string> read_calibration_text(const std::filesystem::path& path);
/// All of it or, if that fails, what was there before. Blocks. Error: failed.
Result<void> write_calibration_text(const std::filesystem::path& path, std::string_view text);

} // namespace nendo::hand
