#include "calibrate/report.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/files.hpp>

namespace nendo::calibrate {
namespace {

// The measures of the picture, in pixels.
constexpr int top = 40;
constexpr int row_height = 20;
constexpr int range_left = 190;
constexpr int range_width = 360;
constexpr int residual_left = 640;
constexpr double pixels_a_degree = 12.0;
constexpr double most_degrees = 12.0;

std::string_view kept_text(const hand::SensorFit& sensor) {
  if (sensor.gain_determined && sensor.offset_determined) return "";
  if (sensor.gain_determined) return "offset is the default's";
  return sensor.offset_determined ? "gain is the default's" : "the default's";
}

template <class Visit>
void for_each_sensor(SensorMask sensors, Visit&& visit) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (sensors.has(static_cast<Sensor>(slot))) visit(static_cast<Sensor>(slot), slot);
}

void print_readings(std::ostream& out, const hand::CalibrationFit& fit,
                    std::span<const hand::PoseReading> readings) {
  constexpr double unusual = 2.0; // deviations; about 1 is what wearers do
  for (std::size_t k = 0; k < readings.size() && k < fit.readings.size(); ++k) {
    const hand::ReadingFit& reading = fit.readings[k];
    const hand::CalibrationPose& pose = hand::pose_of(readings[k].pose);
    if (pose.touch)
      out << fmt::format("{}: the pads are {:.0f} mm apart\n", pose.name, 1000.0 * reading.gap_m);
    if (reading.misfit > unusual)
      out << fmt::format("{} agrees badly with the others ({:.1f} times what is usual); take it "
                         "again\n",
                         pose.name, reading.misfit);
  }
}

/// Returns the row of a sensor in the picture, with its top at `y`.
std::string row(Sensor sensor, const hand::SensorFit& quality, const hand::SensorCalibration& line,
                double counts_most, int y) {
  const auto angle_deg = [&](double counts) {
    return to_degrees(line.gain_rad_per_count * (counts - line.offset_counts));
  };
  const double low = range_left + quality.low_counts / counts_most * range_width;
  const double high = range_left + quality.high_counts / counts_most * range_width;
  const double residual_deg = to_degrees(quality.residual_rad);
  const double bar = pixels_a_degree * std::min(residual_deg, most_degrees);
  return fmt::format(
      R"(<text x="10" y="{}">{}</text>
<rect x="{}" y="{}" width="{}" height="12" fill="#eeeeee"/>
<rect x="{:.1f}" y="{}" width="{:.1f}" height="12" fill="{}"/>
<text x="{:.1f}" y="{}" class="s">{:.0f} to {:.0f} deg</text>
<rect x="{}" y="{}" width="{:.1f}" height="12" fill="#c1121f"/>
<text x="{:.1f}" y="{}" class="s">{:.1f} deg</text>
)",
      y + 11, name_of(sensor), range_left, y, range_width, low, y, std::max(high - low, 1.0),
      kept_text(quality).empty() ? "#2a6f97" : "#b0b0b0", high + 4.0, y + 10,
      angle_deg(quality.low_counts), angle_deg(quality.high_counts), residual_left, y, bar,
      residual_left + 4.0 + bar, y + 10, residual_deg);
}

} // namespace

void print_report(std::ostream& out, const hand::CalibrationFit& fit,
                  std::span<const hand::PoseReading> readings, SensorMask sensors) {
  out << "sensor                      counts  deg/count   residual    sure to\n";
  for_each_sensor(sensors, [&](Sensor sensor, std::size_t slot) {
    const hand::SensorFit& quality = fit.sensors[slot];
    const std::string range =
        fmt::format("{:.0f} to {:.0f}", quality.low_counts, quality.high_counts);
    out << fmt::format("{:22} {:>11}  {:9.3f}  {:5.1f} deg  {:5.1f} deg  {}\n", name_of(sensor),
                       range, to_degrees(fit.calibration[sensor].gain_rad_per_count),
                       to_degrees(quality.residual_rad), to_degrees(quality.deviation_rad),
                       kept_text(quality));
  });
  print_readings(out, fit, readings);
  // Where the poses leave a sensor's gain or offset to the default, a condition says nothing.
  if (fit.undetermined.bits == 0)
    out << fmt::format("condition {:.0f} (above 1000, poses are missing); ", fit.condition);
  out << fmt::format("{} poses\n", readings.size());
}

Result<void> write_report_picture(const std::filesystem::path& path,
                                  const hand::CalibrationFit& fit, SensorMask sensors,
                                  CountScale counts) {
  std::string rows;
  int y = top;
  for_each_sensor(sensors, [&](Sensor sensor, std::size_t slot) {
    rows += row(sensor, fit.sensors[slot], fit.calibration[sensor], counts.most, y);
    y += row_height;
  });
  return replace_file(
      path,
      fmt::format(
          R"(<svg xmlns="http://www.w3.org/2000/svg" width="840" height="{}" font-family="sans-serif" font-size="12">
<style>.s{{font-size:10px;fill:#444444}}</style>
<rect width="100%" height="100%" fill="white"/>
<text x="{}" y="24">counts that were covered, of {}, and angles; grey: kept</text>
<text x="{}" y="24">residual of the poses</text>
{}</svg>
)",
          y + top / 2, range_left, counts.most, residual_left, rows));
}

} // namespace nendo::calibrate
