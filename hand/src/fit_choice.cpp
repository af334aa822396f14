#include "fit_choice.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "fit_priors.hpp"

namespace nendo::hand {
namespace {

constexpr std::size_t folds = 4;
// Two fits that predict about equally well are told apart by chance; then the full one has more
// behind it.
constexpr double clearly_better = 0.85;
constexpr std::size_t min_held_out = 3;

/// The joints of a hand that are alike, by slot. Gaps and the thumb's roll and abduction are all
/// one, for couplings tie them together.
enum class Alike : std::size_t { mcp, pip, dip, thumb_flexion, coupled, palm, wrist, none };
constexpr std::size_t groups = static_cast<std::size_t>(Alike::none);

Alike alike_of(std::size_t slot) noexcept {
  switch (static_cast<Sensor>(slot)) {
  case Sensor::thumb_mcp:
  case Sensor::thumb_ip:
    return Alike::thumb_flexion;
  case Sensor::thumb_roll:
  case Sensor::thumb_abduction:
    return Alike::coupled;
  case Sensor::palm_arch:
    return Alike::palm;
  case Sensor::wrist_pitch:
  case Sensor::wrist_yaw:
    return Alike::wrist;
  case Sensor::index_abduction:
  case Sensor::unused:
    return Alike::none;
  default:
    break;
  }
  constexpr std::array of_finger{Alike::mcp, Alike::pip, Alike::dip, Alike::coupled};
  return of_finger[slot % 4];
}

struct Cost {
  double full = 0.0, quick = 0.0;
  std::size_t angles = 0;
};

std::vector<PoseReading> two_of(std::span<const PoseReading> readings) {
  std::vector<PoseReading> two;
  for (const PoseId id : quick_poses())
    two.push_back(*std::find_if(readings.begin(), readings.end(),
                                [&](const PoseReading& reading) { return reading.pose == id; }));
  return two;
}

double angle_rad(const Calibration& calibration, const HeldPose& held, std::size_t slot) {
  const auto own = [&](std::size_t of) {
    const auto [gain, offset] = calibration.sensors[of];
    return held.present.has(static_cast<Sensor>(of)) ? gain * (held.mean_counts[of] - offset) : 0.0;
  };
  double angle = own(slot);
  for (std::size_t k = 0; k < couplings.size(); ++k)
    if (couplings[k].of == static_cast<Sensor>(slot))
      angle += calibration.coupling_gains[k] * own(static_cast<std::size_t>(couplings[k].by));
  return angle;
}

} // namespace

void choose_by_held_out_poses(CalibrationFit& fit, std::span<const PoseReading> readings, Side side,
                              SensorMask sensors, const FitOptions& options,
                              const Solution& solution) {
  const std::vector<PoseReading> two = two_of(readings);
  FitOptions quick_options = options;
  quick_options.mode = FitMode::quick;
  const auto quick = fit_calibration(two, side, sensors, quick_options);
  if (!quick) return;
  std::array<Cost, groups> costs{};
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<PoseReading> kept = two, held_out;
    std::array<std::size_t, pose_count> takes{};
    for (const PoseReading& reading : readings) {
      const bool is_quick = reading.pose == PoseId::flat || reading.pose == PoseId::fist;
      // Poses that follow each other, and takes of one pose, are alike: they go to different folds,
      // whatever the order of the readings.
      const auto pose = static_cast<std::size_t>(reading.pose);
      const std::size_t into = (pose + takes[pose]++) % folds;
      if (!is_quick) (into == fold ? held_out : kept).push_back(reading);
    }
    const FitProblem problem(kept, side, sensors, options);
    Unknowns at = solution.at;
    refine(problem, solution.free, at);
    const Calibration full = problem.calibration(at);
    for (const PoseReading& reading : held_out) {
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        const AssumedAngle& assumed = pose_of(reading.pose).assumed[slot];
        const Alike group = alike_of(slot);
        const auto sensor = static_cast<Sensor>(slot);
        if (!assumed.known() || group == Alike::none || !sensors.has(sensor) ||
            options.stiff.has(sensor))
          continue;
        const auto cost_of = [&](const Calibration& calibration) {
          const double off = angle_rad(calibration, reading.held, slot) - assumed.angle_rad;
          const double residual = robust(off / assumed.deviation_rad).residual;
          return residual * residual;
        };
        Cost& cost = costs[static_cast<std::size_t>(group)];
        cost.full += cost_of(full);
        cost.quick += cost_of(quick->calibration);
        ++cost.angles;
      }
    }
  }
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Alike group = alike_of(slot);
    if (group == Alike::none || !sensors.has(static_cast<Sensor>(slot))) continue;
    const Cost& cost = costs[static_cast<std::size_t>(group)];
    if (cost.angles < min_held_out || cost.quick >= clearly_better * cost.full) continue;
    fit.uses_quick_fit.add(static_cast<Sensor>(slot));
    fit.calibration.sensors[slot] = quick->calibration.sensors[slot];
    for (std::size_t k = 0; k < couplings.size(); ++k)
      if (couplings[k].of == static_cast<Sensor>(slot))
        fit.calibration.coupling_gains[k] = quick->calibration.coupling_gains[k];
  }
}

} // namespace nendo::hand
