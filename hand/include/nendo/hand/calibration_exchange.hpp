#pragma once
// Reads and writes the calibrations of other programs. A text is used only if all of it is valid.
// Only the last function accesses files.
//
// Signs: the vendor's angle is -gain * (count - offset) in a frame where flexion is negative. Its
// positive gains are therefore also positive in our frame, where flexion and spreading are
// positive: a CyberGlove's counts rise with both. If all flexion sensors (or all gap sensors) of a
// text have the other sign, the text uses the other frame, and their signs are inverted. A text
// with mixed signs is refused. The ROS formats define spreading as positive, so the signs of their
// gaps are kept.

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
  std::optional<Side> side;       ///< nullopt if the text has none
  std::vector<std::string> notes; ///< deviations from the text, one line each
};

struct ExportedCalibration {
  std::string text;
  std::vector<std::string> notes; ///< values that the format cannot hold, one line each
};

enum class CalibrationFormat : std::uint8_t {
  toml,
  virtualhand,
  two_point,
  csv,
  ros_yaml,
  ros_xml
};

/// Guesses the format of a text; virtualhand if it recognizes none.
NENDO_API CalibrationFormat format_of(std::string_view text) noexcept;

// All readers fail with bad_input and the message "NAME:LINE: what; remedy". All writers fail with
// bad_input.

/// Reads a VirtualHand .cal file: six groups of four rows `joint offset gain`. It accepts the
/// variants of VTI's library (version, comments, FINGER headings, geometry), the Device
/// Configuration Utility (a header line, headed groups) and MotorControl (tabs, no headings). The
/// row of slot 7, a sensor that no glove has, holds the gain of slot 11, and the gain in the row of
/// slot 11 is the middle bias.
NENDO_API Result<ImportedCalibration> parse_virtualhand(std::string_view text,
                                                        std::string_view name);
/// Writes a .cal file as VTI's library does. Offsets are rounded to whole counts, gains to five
/// decimals. Refuses offsets outside 0 to 255, uncalibrated sensors that every glove has, and
/// self-calibrating gloves.
NENDO_API Result<ExportedCalibration> virtualhand_text(const Calibration& calibration,
                                                       CountScale counts);

/// Reads a calibration of asr_cyberglove: 22 lines `angle_rad:count angle_rad:count`, two points of
/// each sensor's line, in the order of its hand model: wrist, thumb, then each finger with its
/// abduction second. The line of the palm arch is ignored.
NENDO_API Result<ImportedCalibration> parse_two_point(std::string_view text, std::string_view name);

/// Reads a table (nendo/base/table.hpp) with the columns sensor, gain_rad_per_count (or
/// gain_deg_per_count) and offset_counts. A note names other columns.
NENDO_API Result<ImportedCalibration> parse_calibration_csv(std::string_view text,
                                                            std::string_view name);
/// Writes only the calibrated sensors, in decimals that parse to the same bits.
NENDO_API Result<ExportedCalibration> calibration_csv_text(const Calibration& calibration);

/// Reads the calibration of ROS drivers for this glove (parameter cyberglove_calibration, in YAML's
/// flow or block style): for each joint G_... a piecewise linear curve of two to 4096 points [raw,
/// degrees]. Raw 0 to 1 is count 1 to 255. The line with the least maximum deviation replaces the
/// curve, and a note gives this deviation in degrees. Notes name unknown and missing joints, and
/// joints that measure nothing, which are omitted. Gaps between fingers keep their signs.
NENDO_API Result<ImportedCalibration> parse_ros_yaml(std::string_view text, std::string_view name);
/// Reads the older XML form, as parse_ros_yaml() does.
NENDO_API Result<ImportedCalibration> parse_ros_xml(std::string_view text, std::string_view name);
/// Writes these forms, with two points per calibrated sensor, at raw 0 and 1, with nine decimals.
/// Refuses self-calibrating gloves.
NENDO_API Result<ExportedCalibration> ros_yaml_text(const Calibration& calibration,
                                                    CountScale counts);
NENDO_API Result<ExportedCalibration> ros_xml_text(const Calibration& calibration,
                                                   CountScale counts);

/// Reads a regular file of at most 1 MiB; a pipe or a device is refused. Blocks. Error: bad_input.
NENDO_API Result<std::string> read_calibration_text(const std::filesystem::path& path);

} // namespace nendo::hand
