#pragma once
// Reads and writes the calibrations of other programs. No text is trusted before it has been read
// to the end. Only the last two functions touch files.
//
// About signs: the vendor's angle is -gain * (count - offset) in a frame where flexion is negative.
// Its positive gains are therefore also positive in our frame, where flexion and spreading are
// positive: a CyberGlove's counts rise with both. If all bend sensors (or all pair sensors) of a
// text have the other sign, the text means the other frame, and their signs are turned. A text that
// has both signs among them is refused. The ROS forms say for certain that spreading is positive,
// so their gaps' signs are kept.

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
  std::optional<Side> side;       ///< nullopt: the text does not say
  std::vector<std::string> notes; ///< what was not read as written, one line each
};

struct ExportedCalibration {
  std::string text;
  std::vector<std::string> notes; ///< what the format cannot hold, one line each
};

enum class CalibrationFormat : std::uint8_t {
  toml,
  virtualhand,
  two_point,
  csv,
  ros_yaml,
  ros_xml
};

/// Guesses the format of a text; virtualhand if it looks like no known format.
NENDO_API CalibrationFormat format_of(std::string_view text) noexcept;

// All readers fail with bad_input and the message "NAME:LINE: what; remedy". All writers fail with
// bad_input.

/// Reads a VirtualHand .cal file: six groups of four rows `joint offset gain`. It may be written as
/// by VTI's library (version, comments, FINGER headings, geometry), the Device Configuration
/// Utility (a header line, headed groups) or MotorControl (tabs, no headings). The row of the
/// sensor that no glove has (slot 7) holds the gain of slot 11, and slot 11's own gain is the
/// middle bias.
NENDO_API Result<ImportedCalibration> parse_virtualhand(std::string_view text,
                                                        std::string_view name);
/// Writes a .cal file as VTI's library does. Offsets are rounded to whole counts, gains to five
/// decimals. Refuses offsets outside 0 to 255, sensors that every glove has but that are not
/// calibrated, and self-calibrating gloves.
NENDO_API Result<ExportedCalibration> virtualhand_text(const Calibration& calibration,
                                                       CountScale counts);

/// Reads a calibration of asr_cyberglove: 22 lines `angle_rad:count angle_rad:count`, two points of
/// each sensor's line, in the order of its hand model: wrist, thumb, then each finger with its
/// abduction second. It has a line for the palm arch, which is not used.
NENDO_API Result<ImportedCalibration> parse_two_point(std::string_view text, std::string_view name);

/// Reads a table (nendo/base/table.hpp) with the columns sensor, gain_rad_per_count (or
/// gain_deg_per_count) and offset_counts. A note names other columns.
NENDO_API Result<ImportedCalibration> parse_calibration_csv(std::string_view text,
                                                            std::string_view name);
/// Writes the calibrated sensors only, in numbers that read back to the same bits.
NENDO_API Result<ExportedCalibration> calibration_csv_text(const Calibration& calibration);

/// Reads what ROS drivers for this glove keep (parameter cyberglove_calibration, in YAML's flow or
/// block style): for each joint G_... two to 4096 points [raw, degrees], a piecewise linear curve.
/// Raw 0 to 1 is count 1 to 255. The line that is off the curve the least replaces it, and a note
/// says by how many degrees it is off, and where. Notes name joints that are not known, not there,
/// or that measure nothing, which are left out. Gaps between fingers keep their signs.
NENDO_API Result<ImportedCalibration> parse_ros_yaml(std::string_view text, std::string_view name);
/// Reads the older XML form of the same, in the same way.
NENDO_API Result<ImportedCalibration> parse_ros_xml(std::string_view text, std::string_view name);
/// Writes these forms, with two points for each calibrated sensor, at raw 0 and 1, in nine
/// decimals. Refuses self-calibrating gloves.
NENDO_API Result<ExportedCalibration> ros_yaml_text(const Calibration& calibration,
                                                    CountScale counts);
NENDO_API Result<ExportedCalibration> ros_xml_text(const Calibration& calibration,
                                                   CountScale counts);

/// Reads a regular file of at most 1 MiB; a pipe or a device is refused. Blocks. Error: bad_input.
NENDO_API Result<std::string> read_calibration_text(const std::filesystem::path& path);
/// Writes the whole text, or leaves the file as it was if that fails. Blocks. Error: failed.
NENDO_API Result<void> write_calibration_text(const std::filesystem::path& path,
                                              std::string_view text);

} // namespace nendo::hand
