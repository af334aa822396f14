// Writes calibrations as ROS drivers read them: two points of each sensor's line.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>
#include <nendo/hand/calibration_exchange.hpp>

#include "ros_joints.hpp"

namespace nendo::hand {
namespace {

struct TwoPoints {
  std::string_view name;
  std::array<RosPoint, 2> points;
};

struct WrittenJoints {
  std::vector<TwoPoints> joints;
  std::vector<std::string> notes;
};

Result<WrittenJoints> joints_for(const Calibration& calibration, CountScale counts) {
  if (counts.whole_range || counts.most == 0)
    return Error{Errc::bad_input,
                 "the ROS forms are for a CyberGlove's bare counts, and this glove "
                 "calibrates itself; export as toml or csv"};
  const double scale = 255.0 / counts.most;
  WrittenJoints written;
  std::string missing;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (ros_names[slot].empty()) continue;
    const SensorCalibration& line = calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) {
      missing.append(missing.empty() ? "" : ", ").append(sensor_names[slot]);
      continue;
    }
    TwoPoints joint{ros_names[slot], {}};
    for (std::size_t at = 0; at < 2; ++at) { // where the sensor's range begins and ends
      const double raw = at == 0 ? 0.0 : 1.0;
      const double count = (ros_first_count + ros_counts * raw) / scale;
      joint.points[at] = {raw, to_degrees(line.gain_rad_per_count * (count - line.offset_counts))};
    }
    written.joints.push_back(joint);
  }
  if (written.joints.empty())
    return Error{Errc::bad_input, "no sensor is calibrated; `nendo calibrate` does it"};
  if (!missing.empty())
    written.notes.push_back("not calibrated, so left out: " + missing +
                            "; a ROS driver that needs them stops");
  if (calibration.has_couplings())
    written.notes.emplace_back("the couplings (mixed_in) are lost: the ROS forms have none");
  if (calibration.middle_bias != 0.0)
    written.notes.emplace_back("the middle bias is lost: the ROS forms have none");
  return written;
}

std::string number_text(double value) {
  std::array<char, 400> digits{}; // the largest double has 309 before the point
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::fixed, 9)
                       .ptr;
  return {digits.data(), end};
}

} // namespace

Result<ExportedCalibration> ros_yaml_text(const Calibration& calibration, CountScale counts) {
  auto written = joints_for(calibration, counts);
  if (!written) return written.error();
  std::string text = "{'cyberglove_calibration': [\n";
  for (const TwoPoints& joint : written->joints) {
    text.append("['").append(joint.name).append("', [");
    for (const RosPoint& point : joint.points)
      text += std::string(&point == joint.points.data() ? "" : ",") + "[" + number_text(point.raw) +
              "," + number_text(point.angle_deg) + "]";
    text += "]],\n";
  }
  return ExportedCalibration{text + "]}\n", std::move(written->notes)};
}

Result<ExportedCalibration> ros_xml_text(const Calibration& calibration, CountScale counts) {
  auto written = joints_for(calibration, counts);
  if (!written) return written.error();
  std::string text = "<?xml version=\"1.0\" ?>\n<Cyberglove_calibration>\n";
  for (const TwoPoints& joint : written->joints) {
    text.append("<Joint name=\"").append(joint.name).append("\">\n");
    for (const RosPoint& point : joint.points)
      text += "<calib raw_value=\"" + number_text(point.raw) + "\" calibrated_value=\"" +
              number_text(point.angle_deg) + "\"/>\n";
    text += "</Joint>\n";
  }
  return ExportedCalibration{text + "</Cyberglove_calibration>\n", std::move(written->notes)};
}

} // namespace nendo::hand
