#include <algorithm>

#include <nendo/hand/joint_angles.hpp>

#include "finger_rules.hpp"

namespace nendo::hand {
namespace {

// Indices in finger_sensors.
constexpr std::size_t mcp_at = 0, pip_at = 1, dip_at = 2;
constexpr std::array<Sensor, 3> gap_sensors{
    Sensor::index_middle_abduction, Sensor::middle_ring_abduction, Sensor::ring_little_abduction};

/// The angles of a hand at rest, for joints without an estimate.
constexpr double resting_mcp = from_degrees(25), resting_pip = from_degrees(35);
constexpr double resting_thumb_mcp = from_degrees(15), resting_thumb_ip = from_degrees(20);
constexpr double opposed_at_rest = from_degrees(25);
constexpr double resting_gap = from_degrees(6), resting_arch = from_degrees(6);

/// A mean of estimates that are there.
class Mean {
public:
  void add(double value, double weight) noexcept {
    sum_ += weight * value;
    weight_ += weight;
  }
  double or_else(double otherwise) const noexcept {
    return weight_ > 0.0 ? sum_ / weight_ : otherwise;
  }

private:
  double sum_ = 0.0, weight_ = 0.0;
};

/// Fills in the angles of one sample.
class Filling {
public:
  Filling(const GloveSample& sample, const Calibration& calibration, SensorMask left_out) noexcept
      : calibration_(calibration), measured_{sample.present.bits & ~left_out.bits},
        missing_{sample.present.bits & left_out.bits} {
    for (const Sensor sensor : measured_) {
      const std::size_t slot = index_of(sensor);
      angles_[slot] = calibration.sensors[slot].angle_rad(sample.raw[slot]);
    }
  }

  SensorAngles filled() noexcept {
    // MCP joints first: the others follow from them as well.
    for (std::size_t f = 0; f < finger_sensors.size(); ++f)
      fill(finger_sensors[f][mcp_at], [&] { return mcp(f); });
    for (std::size_t f = 0; f < finger_sensors.size(); ++f)
      fill(finger_sensors[f][pip_at], [&] { return pip(f); });
    for (std::size_t f = 0; f < finger_sensors.size(); ++f)
      fill(finger_sensors[f][dip_at], [&] { return dip(f); });
    fill_thumb();
    couple();
    fill_gaps();
    fill(Sensor::palm_arch, [] { return resting_arch; });
    // The wrist is straight: its angles stay 0.
    return angles_;
  }

private:
  double& at(Sensor sensor) noexcept { return angles_[index_of(sensor)]; }
  bool is_measured(Sensor sensor) const noexcept { return measured_.has(sensor); }
  template <class Estimate>
  void fill(Sensor sensor, Estimate&& estimate) noexcept {
    if (missing_.has(sensor)) at(sensor) = estimate();
  }
  /// Adds the same joint of the fingers beside this one, if measured.
  void add_beside(Mean& mean, std::size_t f, std::size_t joint, double weight) noexcept {
    for (const std::size_t beside : {f - 1, f + 1})
      if (beside < finger_sensors.size() && is_measured(finger_sensors[beside][joint]))
        mean.add(at(finger_sensors[beside][joint]), weight);
  }

  double mcp(std::size_t f) noexcept {
    Mean mean;
    add_beside(mean, f, mcp_at, 1.0);
    if (is_measured(finger_sensors[f][pip_at]))
      mean.add(bent(at(finger_sensors[f][pip_at])) / pip_of_mcp, 0.7);
    return mean.or_else(resting_mcp);
  }
  double pip(std::size_t f) noexcept {
    Mean mean;
    add_beside(mean, f, pip_at, 0.7);
    if (is_measured(finger_sensors[f][dip_at]))
      mean.add(1.5 * bent(at(finger_sensors[f][dip_at])), 2.0);
    if (is_measured(finger_sensors[f][mcp_at]))
      mean.add(pip_of_mcp * bent(at(finger_sensors[f][mcp_at])), 0.4);
    return mean.or_else(resting_pip);
  }
  double dip(std::size_t f) noexcept {
    Mean mean;
    add_beside(mean, f, dip_at, 0.7);
    mean.add(estimated_dip(at(finger_sensors[f][pip_at])), 1.0);
    return mean.or_else(0.0);
  }

  void fill_thumb() noexcept {
    const bool mcp = is_measured(Sensor::thumb_mcp), ip = is_measured(Sensor::thumb_ip);
    fill(Sensor::thumb_mcp,
         [&] { return ip ? 0.7 * bent(at(Sensor::thumb_ip)) : resting_thumb_mcp; });
    fill(Sensor::thumb_ip,
         [&] { return mcp ? 0.9 * bent(at(Sensor::thumb_mcp)) : resting_thumb_ip; });
  }
  /// As Calibration::angles_rad() does, with what the estimated joints do to the others. Of thumb
  /// roll and abduction, one that is left out is taken to be as at rest.
  void couple() noexcept {
    const SensorAngles lines = angles_;
    const auto line = [&](Sensor sensor) { return lines[index_of(sensor)]; };
    fill(Sensor::thumb_roll, [] { return opposed_at_rest; });
    fill(Sensor::thumb_abduction, [] { return opposed_at_rest; });
    for (std::size_t k = 0; k < couplings.size(); ++k) {
      const auto [of, by] = couplings[k];
      if (!is_measured(of)) continue;
      // The line of a coupled sensor is its angle without what is mixed into it.
      const double by_rad = missing_.has(by) && by == Sensor::thumb_roll
                                ? opposed_at_rest - calibration_.coupling_gains[0] * line(of)
                            : missing_.has(by) && by == Sensor::thumb_abduction
                                ? opposed_at_rest - calibration_.coupling_gains[1] * line(of)
                                : line(by);
      at(of) += calibration_.coupling_gains[k] * by_rad;
    }
  }
  void fill_gaps() noexcept {
    Mean mean;
    for (const Sensor gap : gap_sensors)
      if (is_measured(gap)) mean.add(at(gap), 1.0);
    for (const Sensor gap : gap_sensors)
      fill(gap, [&] { return mean.or_else(resting_gap); });
  }

  const Calibration& calibration_;
  SensorMask measured_, missing_;
  SensorAngles angles_{};
};

} // namespace

SensorAngles filled_angles_rad(const GloveSample& sample, const Calibration& calibration,
                               SensorMask left_out) noexcept {
  if ((sample.present.bits & left_out.bits) == 0) return calibration.angles_rad(sample);
  return Filling(sample, calibration, left_out).filled();
}

} // namespace nendo::hand
