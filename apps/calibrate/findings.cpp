#include "calibrate/findings.hpp"

#include <algorithm>

#include "calibrate/pose_advice.hpp"

namespace nendo::calibrate {
namespace {

std::string list_of(SensorMask sensors) {
  std::string list;
  for (const Sensor sensor : sensors)
    list += (list.empty() ? "" : "; ") + std::string(in_words(sensor));
  return list;
}

SensorMask with_certainty(const FinishedCalibration& finished, Certainty certainty) {
  SensorMask found;
  for (const Sensor sensor : SensorMask{finished.sensors.bits | finished.wearer.left_out.bits})
    if (certainty_of(finished, sensor) == certainty) found.add(sensor);
  return found;
}

void add_poses(const FinishedCalibration& finished, std::vector<Finding>& found) {
  constexpr double unusual = 2.0; // deviations; about 1 is what wearers do
  for (const hand::Outlier& outlier : finished.fit.outliers)
    found.push_back({"The pose " + title_of(finished.readings[outlier.reading].pose) +
                         " contradicts the others" +
                         (outlier.sensor ? ": " + std::string(in_words(*outlier.sensor)) : "") +
                         ".",
                     "That joint of it was not used. Take the pose again if it was held badly."});
  for (std::size_t at = 0; at < finished.readings.size(); ++at)
    if (finished.fit.readings[at].misfit > unusual)
      found.push_back(
          {"The pose " + title_of(finished.readings[at].pose) + " agrees badly with the others.",
           "Take it again."});
}

} // namespace

Certainty certainty_of(const FinishedCalibration& finished, Sensor sensor) noexcept {
  if (finished.wearer.left_out.has(sensor)) return Certainty::estimated;
  const hand::SensorFit& fit = finished.fit.sensors[index_of(sensor)];
  if (!fit.gain_determined || !fit.offset_determined) return Certainty::average;
  return fit.deviation_rad > sure_to_rad ? Certainty::less_sure : Certainty::sure;
}

std::vector<Finding> findings(const FinishedCalibration& finished, CalibrationKind kind) {
  std::vector<Finding> found;
  for (const Sensor sensor : with_certainty(finished, Certainty::estimated))
    found.push_back({std::string(in_words(sensor)) + ": the sensor is stuck.",
                     "Its neighbours give the angle. After a repair, calibrate again."});
  for (std::size_t at = 0; at < hand::finger_count; ++at)
    if (finished.fit.limited_range[at])
      found.push_back({"The " + std::string(in_words(static_cast<hand::Finger>(at))) +
                           " went less far than the poses ask.",
                       "Take its poses again. If it is stiff, begin with --stiff " +
                           std::string(hand::name_of(static_cast<hand::Finger>(at))) + "."});
  add_poses(finished, found);
  if (const SensorMask average = with_certainty(finished, Certainty::average); average.bits != 0)
    found.push_back({"As on an average hand: " + list_of(average) + ".",
                     kind == CalibrationKind::quick
                         ? "A full calibration measures them."
                         : "Take the poses that were skipped, or those that move them."});
  if (const SensorMask less = with_certainty(finished, Certainty::less_sure); less.bits != 0)
    found.push_back({"Less sure: " + list_of(less) + ".",
                     kind == CalibrationKind::quick ? "A full calibration is more exact."
                                                    : "Take the poses that move them once more."});
  return found;
}

std::size_t worst_reading(const FinishedCalibration& finished) noexcept {
  const auto& readings = finished.fit.readings;
  const auto worst =
      std::max_element(readings.begin(), readings.end(), [](const auto& one, const auto& other) {
        return one.misfit < other.misfit;
      });
  return static_cast<std::size_t>(worst - readings.begin());
}

double typical_residual_rad(const FinishedCalibration& finished) {
  std::vector<double> residuals;
  for (const Sensor sensor : finished.sensors)
    residuals.push_back(finished.fit.sensors[index_of(sensor)].residual_rad);
  if (residuals.empty()) return 0.0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return *middle;
}

std::string title_of(hand::PoseId pose) {
  std::string name(hand::pose_of(pose).name);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

} // namespace nendo::calibrate
