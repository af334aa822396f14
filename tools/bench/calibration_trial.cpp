#include "bench/calibration_trial.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/pose_capture.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/hand/range_capture.hpp>
#include <nendo/hand/slip_adaptation.hpp>

#include "reference/wearers.hpp"

namespace nendo::bench {
namespace {

using hand::Calibration;
using hand::JointAngles;
using hand::PoseReading;

constexpr double rate_hz = 90.0;
constexpr double tremor_rad = 0.002;

HostTime at_time(double time_s) {
  return HostTime(from_seconds(1.0 + time_s));
}

/// The wearer holds each pose until it is captured, as in a guided calibration.
Result<std::vector<PoseReading>> hold_all(reference::Wearer& wearer, std::mt19937_64& random,
                                          TrialErrors& errors) {
  std::normal_distribution<double> tremor(0.0, tremor_rad);
  hand::PoseCapture capture;
  std::vector<PoseReading> readings;
  std::uint64_t n = 0;
  for (const hand::PoseId pose : hand::full_takes()) {
    const hand::SensorAngles asked = wearer.perform(pose);
    if (hand::pose_of(pose).touch) errors.touch_gap_m.push_back(wearer.gap_m(pose, asked));
    capture.begin_next();
    for (int turn = 0; turn < 500 && capture.state() != hand::CaptureState::held; ++turn) {
      hand::SensorAngles now = asked;
      for (double& angle : now)
        angle += tremor(random);
      GloveSample sample = wearer.read(now);
      sample.arrival = sample.measured = at_time(static_cast<double>(n++) / rate_hz);
      capture.push(sample);
    }
    if (capture.state() != hand::CaptureState::held)
      return Error{Errc::failed,
                   std::string(hand::pose_of(pose).name) + " was not captured within 5 s"};
    readings.push_back({pose, capture.held()});
  }
  return readings;
}

/// What half a minute of free motion shows: the ranges, to the fit and to min_max alike, and what
/// is learned from them as they come.
struct Watched {
  hand::CountRanges ranges;
  Calibration adaptive;
};

Watched watch(reference::Wearer& wearer, std::uint64_t seed) {
  const reference::FreeMotion motion(seed, wearer.ranges());
  hand::RangeCapture capture;
  hand::RangeAdaptation adaptation;
  for (int n = 0; n < 30 * rate_hz; ++n) {
    const double time_s = n / rate_hz;
    GloveSample sample = wearer.read(motion.angles_rad(time_s));
    sample.arrival = sample.measured = at_time(time_s);
    capture.push(sample);
    adaptation.push(sample);
  }
  return {capture.seen(), adaptation.calibration()};
}

/// What ten minutes of use make of the glove: each sensor slips slowly, by some counts in the end,
/// while joints move in parts of their ranges, other ones every minute.
struct Worn {
  hand::SensorAngles slips_counts{};
  Calibration followed;
};

GloveSample slipped(GloveSample sample, const hand::SensorAngles& slips_counts, double part) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const double count = std::round(sample.raw[slot].value + part * slips_counts[slot]);
    sample.raw[slot] = RawCount{static_cast<std::uint16_t>(std::clamp(count, 0.0, 255.0))};
  }
  return sample;
}

Worn wear(reference::Wearer& wearer, const Calibration& calibration,
          const hand::CountRanges& ranges, std::mt19937_64& random) {
  constexpr double slip_deviation_counts = 5.0;
  constexpr int minutes = 10;
  constexpr double max_unused = 0.1; // of a range, at either end
  Worn worn;
  std::normal_distribution<double> slip(0.0, slip_deviation_counts);
  for (double& counts : worn.slips_counts)
    counts = slip(random);
  hand::SlipAdaptation adaptation(calibration, {wearer.side(), ranges}, CountScale{});
  std::uniform_real_distribution<double> unused(0.0, max_unused);
  for (int minute = 0; minute < minutes; ++minute) {
    reference::Ranges used = wearer.ranges();
    for (auto& [low_rad, high_rad] : used) {
      const double span_rad = high_rad - low_rad;
      low_rad += unused(random) * span_rad;
      high_rad -= unused(random) * span_rad;
    }
    const reference::FreeMotion motion(random(), used);
    for (int n = 0; n < 60 * rate_hz; ++n) {
      const double time_s = n / rate_hz;
      const double part = (minute + time_s / 60.0) / minutes;
      GloveSample sample = slipped(wearer.read(motion.angles_rad(time_s)), worn.slips_counts, part);
      sample.arrival = sample.measured = at_time(60.0 * minute + time_s);
      adaptation.push(sample);
    }
  }
  worn.followed = adaptation.calibration();
  return worn;
}

Calibration min_max_calibration(const hand::CountRanges& ranges) {
  Calibration calibration = hand::default_calibration({1, true});
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    auto& [gain, offset] = calibration.sensors[slot];
    const double span = std::max(ranges.high_counts[slot] - ranges.low_counts[slot], 1.0);
    gain /= span;
    offset = ranges.low_counts[slot] + offset * span;
  }
  return calibration;
}

void add_errors(const JointAngles& estimate, const JointAngles& truth,
                std::array<std::vector<float>, group_names.size()>& groups) {
  const auto add = [&](std::size_t group, double a, double b) {
    groups[group].push_back(static_cast<float>(to_degrees(std::abs(a - b))));
  };
  for (std::size_t f = 0; f < 4; ++f) {
    add(0, estimate.fingers[f].mcp_flexion_rad, truth.fingers[f].mcp_flexion_rad);
    add(1, estimate.fingers[f].pip_flexion_rad, truth.fingers[f].pip_flexion_rad);
    add(2, estimate.fingers[f].dip_flexion_rad, truth.fingers[f].dip_flexion_rad);
    // The middle finger's is straight by definition, here and there.
    if (f != 1) add(3, estimate.fingers[f].mcp_abduction_rad, truth.fingers[f].mcp_abduction_rad);
  }
  add(4, estimate.thumb_roll_rad, truth.thumb_roll_rad);
  add(5, estimate.thumb_abduction_rad, truth.thumb_abduction_rad);
  add(6, estimate.thumb_mcp_flexion_rad, truth.thumb_mcp_flexion_rad);
  add(6, estimate.thumb_ip_flexion_rad, truth.thumb_ip_flexion_rad);
  add(7, estimate.palm_arch_rad, truth.palm_arch_rad);
  add(8, estimate.wrist_pitch_rad, truth.wrist_pitch_rad);
  add(8, estimate.wrist_yaw_rad, truth.wrist_yaw_rad);
}

} // namespace

Result<void> try_wearer(std::uint64_t seed, TrialErrors& errors) {
  reference::Wearer wearer(seed);
  std::mt19937_64 random(seed);
  const auto readings = hold_all(wearer, random, errors);
  if (!readings) return readings.error();
  std::vector<PoseReading> two;
  for (const PoseReading& reading : *readings) {
    const auto quick = hand::quick_poses();
    const auto had = [&](const PoseReading& other) { return other.pose == reading.pose; };
    if (std::find(quick.begin(), quick.end(), reading.pose) != quick.end() &&
        std::none_of(two.begin(), two.end(), had))
      two.push_back(reading);
  }
  const Watched watched = watch(wearer, random());
  hand::FitOptions full_options; // without the size of the hand
  full_options.free_motion = watched.ranges;
  const auto begin = std::chrono::steady_clock::now();
  const auto full = hand::fit_calibration(*readings, wearer.side(), sensors_22, full_options);
  errors.fit_ms.push_back(1e3 * to_seconds(std::chrono::steady_clock::now() - begin));
  if (!full) return full.error();
  hand::FitOptions quick;
  quick.mode = hand::FitMode::quick;
  const auto two_pose = hand::fit_calibration(two, wearer.side(), sensors_22, quick);
  if (!two_pose) return two_pose.error();
  errors.condition.push_back(full->condition);

  const Worn worn = wear(wearer, full->calibration, watched.ranges, random);
  const std::array<Calibration, method_names.size()> calibrations{
      full->calibration, two_pose->calibration, min_max_calibration(watched.ranges),
      watched.adaptive,  wearer.truth(),        full->calibration,
      worn.followed};
  const reference::FreeMotion motion(random(), wearer.ranges());
  for (int n = 0; n < 300; ++n) {
    const double time_s = 0.2 * n;
    const hand::SensorAngles angles = motion.angles_rad(time_s);
    const GloveSample sample = wearer.read(angles);
    const GloveSample later = slipped(sample, worn.slips_counts, 1.0);
    for (std::size_t method = 0; method < calibrations.size(); ++method) {
      const bool has_slipped = method >= static_cast<std::size_t>(Method::slipped);
      add_errors(hand::joint_angles(has_slipped ? later : sample, calibrations[method]),
                 reference::joints_of(angles), errors.deg[method]);
    }
  }
  return {};
}

} // namespace nendo::bench
