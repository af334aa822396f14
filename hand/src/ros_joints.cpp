#include "ros_joints.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>

#include "calibration_check.hpp"

namespace nendo::hand {
namespace {

constexpr std::size_t max_joint_points = 4096;
constexpr double min_raw = -0.1; // drivers' own files have -0.001
constexpr double max_raw = 1.1;
constexpr double max_angle_deg = 1e9; // a steep line is far beyond its joint at the counts' ends
constexpr double reported_deviation_deg = 0.05;

std::string fixed_text(double value, int decimals) {
  std::array<char, 400> text{}; // the largest double has 309 digits before the point
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                 std::chars_format::fixed, decimals)
                       .ptr;
  return {text.data(), end};
}

std::optional<std::size_t> slot_named(std::string_view name) {
  const auto found = std::find(ros_names.begin(), ros_names.end(), name);
  if (name.empty() || found == ros_names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - ros_names.begin());
}

double cross_of(const RosPoint& a, const RosPoint& b, const RosPoint& c) noexcept {
  return (b.raw - a.raw) * (c.angle_deg - a.angle_deg) -
         (b.angle_deg - a.angle_deg) * (c.raw - a.raw);
}

/// The upper side of the points' convex hull (sign 1), or the lower one (sign -1).
std::vector<RosPoint> hull_of(const std::vector<RosPoint>& points, double sign) {
  std::vector<RosPoint> hull;
  for (const RosPoint& point : points) {
    while (hull.size() > 1 && sign * cross_of(hull[hull.size() - 2], hull.back(), point) >= 0.0)
      hull.pop_back();
    hull.push_back(point);
  }
  return hull;
}

/// The line of that slope in the middle between the points.
BestLine middle_line(const std::vector<RosPoint>& points, double slope) noexcept {
  const auto height = [slope](const RosPoint& point) {
    return point.angle_deg - slope * point.raw;
  };
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [&](const RosPoint& a, const RosPoint& b) {
        return height(a) < height(b);
      });
  const double middle = 0.5 * (height(*low) + height(*high));
  return {slope, middle, height(*high) - middle, high->raw};
}

std::string complaint_about_points(std::vector<RosPoint>& points) {
  if (points.size() < 2) return "has fewer than two points; measure another angle";
  if (points.size() > max_joint_points) return "has more than 4096 points; leave some out";
  for (const RosPoint& point : points) {
    if (!(point.raw >= min_raw && point.raw <= max_raw))
      return "raw value " + decimal_text(point.raw) +
             " is not from 0 to 1; write a count as (count - 1) / 254";
    if (!(std::abs(point.angle_deg) <= max_angle_deg))
      return "angle " + decimal_text(point.angle_deg) + " is absurd; give degrees";
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const RosPoint& a, const RosPoint& b) { return a.raw < b.raw; });
  for (std::size_t at = 1; at < points.size(); ++at)
    if (points[at].raw == points[at - 1].raw && points[at].angle_deg != points[at - 1].angle_deg)
      return "raw value " + decimal_text(points[at].raw) + " has two angles; leave one out";
  if (points.front().raw == points.back().raw) return "has one point only; measure another angle";
  return {};
}

SensorCalibration counted(const BestLine& line) noexcept {
  const double raw_at_zero = -line.at_zero / line.slope;
  return {from_degrees(line.slope) / ros_counts, ros_first_count + ros_counts * raw_at_zero};
}

class JointImport {
public:
  explicit JointImport(std::string_view name) : name_(name) { lines_.gaps_may_fall = true; }

  Result<void> add(RosJoint& joint) {
    const auto slot = slot_named(joint.name);
    if (!slot) {
      if (std::exchange(any_unknown_, true)) unknown_ += ", ";
      unknown_ += in_quotes(joint.name);
      return {};
    }
    if (seen_[*slot])
      return bad_line(name_, joint.line, joint.name + " is here twice; leave one out");
    seen_[*slot] = true;
    if (const std::string wrong = complaint_about_points(joint.points); !wrong.empty())
      return bad_line(name_, joint.line, joint.name + ": " + wrong);
    return add_line(*slot, joint);
  }

  Result<ImportedCalibration> finish() {
    if (std::none_of(seen_.begin(), seen_.end(), [](bool seen) { return seen; }))
      return Error{Errc::bad_input, std::string(name_) + ":1: has no joint of a CyberGlove, like "
                                                         "G_IndexMPJ; it is another file"};
    std::string missing;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      if (!ros_names[slot].empty() && !seen_[slot])
        missing.append(missing.empty() ? "" : ", ").append(ros_names[slot]);
    if (any_unknown_) notes_.push_back("not known and not read: " + unknown_);
    if (!missing.empty()) notes_.push_back("not in the file, so not calibrated: " + missing);
    auto result = imported(lines_, name_, false);
    if (result) result->notes.insert(result->notes.end(), notes_.begin(), notes_.end());
    return result;
  }

private:
  Result<void> add_line(std::size_t slot, const RosJoint& joint) {
    const BestLine best = best_line(joint.points);
    const std::string_view sensor = sensor_names[slot];
    const std::string who = joint.name + " (" + std::string(sensor) + ")";
    const double counts = ros_counts * (joint.points.back().raw - joint.points.front().raw);
    SensorCalibration line;
    if (best.slope != 0.0) line = counted(best);
    const SensorCalibration steepness{std::abs(line.gain_rad_per_count), line.offset_counts};
    if (!complaint_about(static_cast<Sensor>(slot), steepness, CountScale{}).empty()) {
      notes_.push_back(
          who + " is left out: between its first and last point there are " +
          fixed_text(counts, 1) + " counts and " +
          fixed_text(joint.points.back().angle_deg - joint.points.front().angle_deg, 0) +
          " degrees, which measures nothing");
      return {};
    }
    lines_.sensors[slot] = line;
    lines_.line[slot] = joint.line;
    if (best.deviation >= reported_deviation_deg)
      notes_.push_back(who + ": a line replaces its " + std::to_string(joint.points.size()) +
                       " points, and is off by up to " + fixed_text(best.deviation, 1) +
                       " degrees, as at raw value " + fixed_text(best.deviation_at, 3));
    // Points at the ends of the counts, as we write them, are where no thumb goes.
    const bool are_reached = counts < 0.9 * ros_counts;
    if (slot == 0 && are_reached &&
        std::any_of(joint.points.begin(), joint.points.end(),
                    [](const RosPoint& point) { return point.angle_deg < 0.0; }))
      notes_.push_back(who + " goes below 0 degrees: its zero is within the thumb's range, ours is "
                             "the thumb beside the index finger; kept as written");
    return {};
  }

  std::string_view name_;
  ReadLines lines_;
  std::array<bool, sensor_slots> seen_{};
  std::string unknown_;
  bool any_unknown_ = false;
  std::vector<std::string> notes_;
};

/// Writes `text`, two points of each sensor's line as `joint_text` writes them, and `end`.
template <class JointText>
Result<ExportedCalibration> written(const Calibration& calibration, CountScale counts,
                                    std::string text, const JointText& joint_text,
                                    std::string_view end) {
  if (counts.self_calibrated || counts.max_count == 0)
    return Error{Errc::bad_input,
                 "the ROS forms are for a CyberGlove's bare counts, and this glove "
                 "calibrates itself; export as toml or csv"};
  const double scale = 255.0 / counts.max_count;
  ExportedCalibration result{std::move(text), {}};
  bool any = false;
  std::string missing;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (ros_names[slot].empty()) continue;
    const SensorCalibration& line = calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) {
      missing.append(missing.empty() ? "" : ", ").append(sensor_names[slot]);
      continue;
    }
    const auto angle_text = [&](double raw) { // where the sensor's range begins and ends
      const double count = (ros_first_count + ros_counts * raw) / scale;
      return fixed_text(to_degrees(line.gain_rad_per_count * (count - line.offset_counts)), 9);
    };
    result.text += joint_text(std::string(ros_names[slot]), angle_text(0.0), angle_text(1.0));
    any = true;
  }
  if (!any) return Error{Errc::bad_input, "no sensor is calibrated; `nendo calibrate` does it"};
  if (!missing.empty())
    result.notes.push_back("not calibrated, so left out: " + missing +
                           "; a ROS driver that needs them stops");
  if (calibration.has_couplings())
    result.notes.emplace_back("the couplings (mixed_in) are lost: the ROS forms have none");
  if (calibration.middle_bias != 0.0)
    result.notes.emplace_back("the middle bias is lost: the ROS forms have none");
  result.text += end;
  return result;
}

} // namespace

BestLine best_line(const std::vector<RosPoint>& points) {
  // The narrowest strip that holds all points has an edge of their hull as a side.
  std::optional<BestLine> best;
  for (const double sign : {1.0, -1.0}) {
    const auto hull = hull_of(points, sign);
    for (std::size_t at = 1; at < hull.size(); ++at) {
      const double width = hull[at].raw - hull[at - 1].raw;
      if (!(width > 0.0)) continue;
      const BestLine line =
          middle_line(points, (hull[at].angle_deg - hull[at - 1].angle_deg) / width);
      if (!best || line.deviation < best->deviation) best = line;
    }
  }
  return best.value_or(BestLine{});
}

Result<ImportedCalibration> imported_joints(std::vector<RosJoint> joints, std::string_view name) {
  JointImport import(name);
  for (RosJoint& joint : joints)
    if (auto fine = import.add(joint); !fine) return fine.error();
  return import.finish();
}

Result<ExportedCalibration> ros_yaml_text(const Calibration& calibration, CountScale counts) {
  const auto joint_text = [](const std::string& name, const std::string& at_0,
                             const std::string& at_1) {
    return "['" + name + "', [[0.000000000," + at_0 + "],[1.000000000," + at_1 + "]]],\n";
  };
  return written(calibration, counts, "{'cyberglove_calibration': [\n", joint_text, "]}\n");
}

Result<ExportedCalibration> ros_xml_text(const Calibration& calibration, CountScale counts) {
  const auto joint_text = [](const std::string& name, const std::string& at_0,
                             const std::string& at_1) {
    return "<Joint name=\"" + name + "\">\n<calib raw_value=\"0.000000000\" calibrated_value=\"" +
           at_0 + "\"/>\n<calib raw_value=\"1.000000000\" calibrated_value=\"" + at_1 +
           "\"/>\n</Joint>\n";
  };
  return written(calibration, counts, "<?xml version=\"1.0\" ?>\n<Cyberglove_calibration>\n",
                 joint_text, "</Cyberglove_calibration>\n");
}

} // namespace nendo::hand
