#include "calibrate/report.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/files.hpp>

#include "cli/svg_drawing.hpp"

namespace nendo::calibrate {
namespace {

// The measures of the picture, in pixels.
constexpr double picture_width = 840.0;
constexpr double top = 66.0; ///< top of the first row
constexpr double row_height = 20.0;
constexpr double range_left = 190.0;
constexpr double range_width = 360.0;
constexpr double residual_left = 640.0;
constexpr double pixels_a_degree = 12.0;
constexpr double max_degrees = 12.0;

std::string_view kept_text(const hand::SensorFit& sensor) {
  if (sensor.gain_determined && sensor.offset_determined) return "";
  if (sensor.gain_determined) return "offset is the default's";
  return sensor.offset_determined ? "gain is the default's" : "the default's";
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

void print_outliers(std::ostream& out, const hand::CalibrationFit& fit,
                    std::span<const hand::PoseReading> readings) {
  for (const hand::Outlier& outlier : fit.outliers)
    out << fmt::format("{}: {} contradicts the other poses and was not used\n",
                       hand::pose_of(readings[outlier.reading].pose).name,
                       outlier.sensor ? name_of(*outlier.sensor) : "the touch");
  if (fit.uses_quick_fit.bits == 0) return;
  out << "two poses predict the others better for:";
  for (const Sensor sensor : fit.uses_quick_fit)
    out << ' ' << name_of(sensor);
  out << '\n';
}

void print_stiff(std::ostream& out, const hand::CalibrationFit& fit) {
  for (std::size_t finger = 0; finger < hand::finger_count; ++finger) {
    if (!fit.limited_range[finger]) continue;
    const auto name = hand::name_of(static_cast<hand::Finger>(finger));
    out << fmt::format("{0}: it went less far than the poses ask; if it is stiff, use --stiff {0}, "
                       "and if not, take the poses again\n",
                       name);
  }
}

void print_hand(std::ostream& out, const hand::CalibrationFit& fit) {
  if (fit.touch_residual_m == 0.0) return;
  out << fmt::format(
      "hand: {:.0f} mm long, {:.0f} mm broad; pads that touch are {:.1f} mm apart in "
      "it (root mean square)\n",
      1000.0 * fit.size.length_m, 1000.0 * fit.size.breadth_m, 1000.0 * fit.touch_residual_m);
}

/// Returns a number as people write it: without decimals that are not there, and 0 without a sign.
std::string number_text(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  // -0.0 + 0.0 is 0.0
  return fmt::format("{:.{}f}", std::round(value * unit) / unit + 0.0, decimals);
}

/// Draws the row of a sensor, with its top at `y`.
void draw_row(cli::SvgDrawing& drawing, Sensor sensor, const hand::SensorFit& quality,
              const hand::SensorCalibration& line, double counts_max, double y) {
  constexpr double bar_height = 12.0;
  const cli::SvgText name{12.0};
  const cli::SvgText number{10.0, "#444444"};
  const auto angle_text = [&](double counts) {
    return number_text(to_degrees(line.gain_rad_per_count * (counts - line.offset_counts)), 0);
  };
  const double low = range_left + quality.low_counts / counts_max * range_width;
  const double high = range_left + quality.high_counts / counts_max * range_width;
  const double residual_deg = to_degrees(quality.residual_rad);
  const double bar = pixels_a_degree * std::min(residual_deg, max_degrees);
  const char* colour = kept_text(quality).empty() ? "#2a6f97" : "#b0b0b0";
  drawing.text(10.0, y + 11.0, std::string(name_of(sensor)), name);
  drawing.box(range_left, y, range_width, bar_height, "#eeeeee", 1.0);
  drawing.box(low, y, std::max(high - low, 1.0), bar_height, colour, 1.0);
  drawing.text(high + 4.0, y + 10.0,
               angle_text(quality.low_counts) + " to " + angle_text(quality.high_counts) + " deg",
               number);
  drawing.box(residual_left, y, bar, bar_height, "#c1121f", 1.0);
  drawing.text(residual_left + 4.0 + bar, y + 10.0, number_text(residual_deg, 1) + " deg", number);
}

} // namespace

void print_report(std::ostream& out, const hand::CalibrationFit& fit,
                  std::span<const hand::PoseReading> readings, SensorMask sensors,
                  SensorMask left_out) {
  out << "sensor                      counts  deg/count   residual    sure to\n";
  for (const Sensor sensor : sensors) {
    const hand::SensorFit& quality = fit.sensors[index_of(sensor)];
    const std::string range =
        fmt::format("{:.0f} to {:.0f}", quality.low_counts, quality.high_counts);
    out << fmt::format("{:22} {:>11}  {:9.3f}  {:5.1f} deg  {:5.1f} deg  {}\n", name_of(sensor),
                       range, to_degrees(fit.calibration[sensor].gain_rad_per_count),
                       to_degrees(quality.residual_rad), to_degrees(quality.deviation_rad),
                       kept_text(quality));
  }
  for (const Sensor sensor : left_out)
    out << fmt::format("{:22} is stuck: left out, and estimated from the sensors beside\n",
                       name_of(sensor));
  print_readings(out, fit, readings);
  print_outliers(out, fit, readings);
  print_stiff(out, fit);
  print_hand(out, fit);
  // Where the poses leave a sensor's gain or offset to the default, a condition says nothing.
  if (fit.undetermined.bits == 0)
    out << fmt::format("condition {:.0f} (above 1000, poses are missing); ", fit.condition);
  out << fmt::format("{} poses\n", readings.size());
}

Result<void> write_report_picture(const std::filesystem::path& path,
                                  const hand::CalibrationFit& fit,
                                  const hand::WearerCalibration& wearer, SensorMask sensors) {
  const auto rows = static_cast<double>(std::popcount(sensors.bits));
  cli::SvgDrawing drawing(picture_width, top + row_height * rows + 20.0);
  drawing.text(10.0, 24.0,
               "Calibration of " + wearer.user + ", " + std::string(name_of(wearer.side)) +
                   " hand, " + hand::rfc3339(wearer.made),
               {15.0, "#000000", "start", true});
  const cli::SvgText heading{12.0};
  drawing.text(range_left, 50.0,
               fmt::format("counts that were covered, of {}, and angles; grey: kept",
                           wearer.counts.max_count),
               heading);
  drawing.text(residual_left, 50.0, "residual of the poses", heading);
  double y = top;
  for (const Sensor sensor : sensors) {
    draw_row(drawing, sensor, fit.sensors[index_of(sensor)], fit.calibration[sensor],
             wearer.counts.max_count, y);
    y += row_height;
  }
  return replace_file(path, std::move(drawing).finished());
}

} // namespace nendo::calibrate
