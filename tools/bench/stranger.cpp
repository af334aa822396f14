#include "bench/stranger.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <Eigen/LU>

#include <nendo/base/units.hpp>
#include <nendo/hand/calibration_poses.hpp>

#include "bench/stranger_hand.hpp"
#include "bench/stranger_kind.hpp"

namespace nendo::bench {
namespace stranger_parts {
namespace {

using hand::PoseId;
using hand::SensorAngles;

constexpr double rate_hz = 60.0;
constexpr double noise_counts = 0.35;

constexpr std::size_t slot(Sensor sensor) {
  return static_cast<std::size_t>(sensor);
}

struct Reads { ///< a sensor reads a part of another joint's angle
  Sensor of, by;
  double part;
};

std::mt19937_64 random_of(std::uint64_t seed) {
  return std::mt19937_64(seed * 2654435761U + 99);
}

class Stranger {
public:
  Stranger(std::uint64_t seed, const StrangerErrors& errors)
      : random_(random_of(seed)), errors_(errors), hand_(random_) {
    for (std::size_t n = 0; n < sensor_slots; ++n) {
      const StrangerJoint& joint = stranger_joints[n];
      if (joint.gain == 0.0) continue;
      const double range = joint.high - joint.low;
      low_[n] = from_degrees(joint.low + normal(0.0, StrangerSpread::low * range));
      high_[n] = from_degrees(joint.high + normal(0.0, StrangerSpread::high * range));
      habit_[n] = errors.scatter * from_degrees(normal(0.0, StrangerSpread::habit_deg));
    }
    draw_sensors();
  }

  JudgedWearer make(std::uint64_t seed, SensorMask sensors) {
    JudgedWearer wearer;
    wearer.name = "stranger " + std::to_string(seed);
    wearer.side = seed % 2 == 0 ? Side::left : Side::right;
    wearer.sensors = sensors_ = sensors;
    for (std::size_t n = 0; n < wearer.pads.size(); ++n)
      wearer.pads[n] = {hand_.pads()[n].depth, hand_.pads()[n].behind};
    now_ = relaxed();
    move_freely(30.0, [&](const SensorAngles& angles) {
      wearer.fresh.free_motion.push_back(read(angles));
    });
    wearer.fresh.takes = hold(hand::full_takes());
    slip(0.6);
    wearer.fresh.motion = move();
    slip(1.6); // off, and on again
    move_freely(10.0, [&](const SensorAngles& angles) {
      wearer.again.free_motion.push_back(read(angles));
    });
    wearer.again.takes = hold(hand::touch_up_poses());
    wearer.again.motion = move();
    return wearer;
  }

private:
  double normal(double mean, double deviation) {
    return std::normal_distribution<double>(mean, deviation)(random_);
  }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  void draw_sensors() {
    for (const StrangerRead& read : stranger_reads()) {
      const double part = normal(read.mean, read.spread);
      reads_.push_back({read.of, read.by, read.is_cross_talk ? errors_.cross_talk * part : part});
    }
    for (std::size_t n = 0; n < sensor_slots; ++n) {
      if (stranger_joints[n].gain == 0.0) continue;
      bow_[n] = errors_.curvature * uniform(-StrangerSpread::bow, StrangerSpread::bow) *
                (high_[n] - low_[n]);
      lag_[n] = errors_.hysteresis *
                from_degrees(uniform(StrangerSpread::min_lag_deg, StrangerSpread::max_lag_deg));
      creep_[n] = errors_.creep * uniform(0.0, 0.03);
      gain_[n] = 1e-3 * stranger_joints[n].gain * std::exp(normal(0.0, StrangerSpread::log_gain));
      // Users set a glove's gain such that no count is at the end of its range.
      const double widest = 1.35 * (high_[n] - low_[n]);
      gain_[n] = std::max(gain_[n], widest / 225.0);
      const double below = (std::max(0.0, -low_[n]) + 0.12 * (high_[n] - low_[n])) / gain_[n];
      const double above = 1.15 * high_[n] / gain_[n];
      offset_[n] =
          std::clamp(stranger_joints[n].offset + normal(0.0, StrangerSpread::offset_counts),
                     8.0 + below, 247.0 - above);
    }
  }

  CountRow read(const SensorAngles& angles) {
    SensorAngles pulled = angles;
    for (const Reads& r : reads_)
      pulled[slot(r.of)] += r.part * angles[slot(r.by)];
    CountRow row{};
    for (std::size_t n = 0; n < sensor_slots; ++n) {
      if (stranger_joints[n].gain == 0.0 || !sensors_.has(static_cast<Sensor>(n))) continue;
      const double part = (angles[n] - low_[n]) / (high_[n] - low_[n]);
      const double bent = pulled[n] + bow_[n] * 4.0 * part * (1.0 - part);
      lagging_[n] = std::clamp(lagging_[n], bent - lag_[n], bent + lag_[n]);
      crept_[n] += (lagging_[n] - crept_[n]) / (15.0 * rate_hz);
      const double felt = lagging_[n] + creep_[n] * crept_[n];
      const double count = offset_[n] + slipped_[n] + felt / gain_[n] + normal(0.0, noise_counts);
      row[n] = static_cast<std::uint16_t>(std::clamp(std::round(count), 1.0, 254.0));
    }
    return row;
  }

  void slip(double deviation_counts) {
    for (double& slipped : slipped_)
      slipped += errors_.slip * normal(0.0, deviation_counts);
  }

  SensorAngles relaxed() {
    SensorAngles angles{};
    for (std::size_t n = 0; n < sensor_slots; ++n)
      if (stranger_joints[n].gain != 0.0)
        angles[n] = clamped(
            n, from_degrees(normal(stranger_joints[n].relaxed, StrangerSpread::relaxed_deg)));
    return angles;
  }
  double clamped(std::size_t n, double angle) const { return std::clamp(angle, low_[n], high_[n]); }

  /// Continues smoothly from where the hand is, and shows each moment.
  template <class Show>
  void go(const SensorAngles& to, double seconds, Show&& show) {
    const SensorAngles from = now_;
    const int steps = std::max(1, static_cast<int>(seconds * rate_hz));
    for (int step = 1; step <= steps; ++step) {
      const double t = static_cast<double>(step) / steps, part = t * t * (3.0 - 2.0 * t);
      for (std::size_t n = 0; n < sensor_slots; ++n)
        now_[n] = from[n] + part * (to[n] - from[n]);
      show(now_);
    }
  }

  template <class Show>
  void move_freely(double seconds, Show&& show) {
    SensorAngles low{}, high{}; // as far as it goes this time
    for (std::size_t n = 0; n < sensor_slots; ++n) {
      const double short_rad = from_degrees(StrangerSpread::short_deg);
      low[n] = low_[n] + std::abs(normal(0.0, short_rad));
      high[n] = high_[n] - std::abs(normal(0.0, short_rad));
    }
    std::array<std::array<double, 4>, sensor_slots> waves{};
    for (auto& wave : waves)
      wave = {uniform(0.08, 0.2), uniform(0.3, 0.7), uniform(0.0, 6.28), uniform(0.0, 6.28)};
    const SensorAngles start = now_;
    const int steps = static_cast<int>(seconds * rate_hz);
    for (int step = 0; step < steps; ++step) {
      const double time = step / rate_hz, begin = std::min(1.0, time);
      for (std::size_t n = 0; n < sensor_slots; ++n) {
        const auto [slow, fast, a, b] = waves[n];
        const double swing = 0.62 * std::sin(2.0 * std::numbers::pi * slow * time + a) +
                             0.42 * std::sin(2.0 * std::numbers::pi * fast * time + b);
        const double to =
            std::clamp(low[n] + (0.5 + 0.5 * swing) * (high[n] - low[n]), low[n], high[n]);
        now_[n] = start[n] + begin * (to - start[n]);
      }
      show(now_);
    }
  }

  Eigen::Vector3d apart(std::size_t digit, const SensorAngles& angles) const {
    return hand_.pad(0, angles) -
           (digit == 0 ? hand_.palm_at_little_finger(angles) : hand_.pad(digit, angles));
  }
  /// How far apart they stay; the angles go the shortest way from where they are.
  double touch(std::size_t digit, const Eigen::Vector3d& slip_m, SensorAngles& angles) const {
    const auto chosen = touching_slots(digit);
    Eigen::Matrix<double, 3, Eigen::Dynamic> slopes(3, static_cast<Eigen::Index>(chosen.size()));
    for (int turn = 0; turn < 60; ++turn) {
      const Eigen::Vector3d off = apart(digit, angles) - slip_m;
      if (off.norm() < 1e-5) break;
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        SensorAngles moved = angles;
        const double by = angles[chosen[k]] + 1e-5 > high_[chosen[k]] ? -1e-5 : 1e-5;
        moved[chosen[k]] += by;
        slopes.col(static_cast<Eigen::Index>(k)) = (apart(digit, moved) - slip_m - off) / by;
      }
      const Eigen::Matrix3d square = slopes * slopes.transpose();
      const Eigen::VectorXd step =
          -0.5 * slopes.transpose() * (square + 2e-6 * Eigen::Matrix3d::Identity()).inverse() * off;
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        const double by = std::clamp(step[static_cast<Eigen::Index>(k)], -0.2, 0.2);
        angles[chosen[k]] = clamped(chosen[k], angles[chosen[k]] + by);
      }
    }
    return (apart(digit, angles) - slip_m).norm();
  }
  bool make_touch(std::size_t digit, double slip_deviation_m, SensorAngles& angles) {
    const Eigen::Vector3d slip_m{normal(0.0, slip_deviation_m), normal(0.0, slip_deviation_m),
                                 normal(0.0, slip_deviation_m)};
    SensorAngles best = angles;
    double least = 1.0;
    for (int attempt = 0; attempt < 12 && least > 0.0008; ++attempt) {
      SensorAngles tried = angles;
      const auto chosen = touching_slots(digit);
      for (std::size_t k = 0; k < chosen.size(); ++k)
        tried[chosen[k]] =
            clamped(chosen[k],
                    from_degrees(normal(stranger_touch_deg[digit][k], StrangerSpread::touch_deg)));
      const double left = touch(digit, slip_m, tried);
      if (left < least) {
        least = left;
        best = tried;
      }
    }
    angles = best;
    return least < 0.0015;
  }

  SensorAngles perform(PoseId id) {
    const hand::CalibrationPose& pose = hand::pose_of(id);
    SensorAngles angles = relaxed();
    for (std::size_t n = 0; n < sensor_slots; ++n) {
      if (!pose.assumed[n].known()) continue;
      const double asked = pose.assumed[n].angle_rad;
      const double habit = std::abs(asked) > from_degrees(8) ? habit_[n] : 0.0;
      // Fingers that lie side by side hold each other.
      const bool side_by_side = is_gap(static_cast<Sensor>(n)) && asked < from_degrees(5);
      const double off =
          errors_.scatter * from_degrees(normal(0.0, side_by_side ? StrangerSpread::side_by_side_deg
                                                                  : StrangerSpread::scatter_deg));
      angles[n] = std::clamp(asked + habit + off, low_[n] - 0.03, high_[n] + 0.03);
    }
    const bool flat_finger = id == PoseId::pinch_index_flat;
    if (pose.touch) {
      make_touch(touching_digit(pose.touch->with), pose.touch->deviation_m > 0.003 ? 0.003 : 0.001,
                 angles);
      if (flat_finger) { // from the ring to flat pads, as far as the hand allows
        angles[slot(Sensor::index_pip)] = clamped(5, from_degrees(18 + normal(0.0, 6.0)));
        angles[slot(Sensor::index_dip)] = clamped(6, from_degrees(5 + normal(0.0, 4.0)));
        angles[slot(Sensor::index_mcp)] = from_degrees(62);
        touch(1, Eigen::Vector3d::Zero(), angles);
      }
    }
    return angles;
  }

  std::vector<hand::PoseReading> hold(std::span<const PoseId> ids) {
    std::vector<hand::PoseReading> readings;
    for (const PoseId id : ids) {
      go(perform(id), 1.5, [&](const SensorAngles& angles) { read(angles); });
      hand::PoseReading reading{id, {}};
      reading.held.present = sensors_;
      const SensorAngles held = now_;
      constexpr int samples = 60;
      for (int n = 0; n < samples; ++n) {
        SensorAngles trembling = held;
        for (double& angle : trembling)
          angle += normal(0.0, 0.002);
        const CountRow row = read(trembling);
        for (std::size_t k = 0; k < sensor_slots; ++k)
          reading.held.mean_counts[k] += row[k] / static_cast<double>(samples);
      }
      readings.push_back(reading);
    }
    return readings;
  }

  static std::array<double, hand::angle_count> degrees_of(const SensorAngles& angles) {
    std::array<double, hand::angle_count> deg{};
    const auto at = [&](Sensor sensor) { return to_degrees(angles[slot(sensor)]); };
    deg[0] = at(Sensor::thumb_roll);
    deg[1] = at(Sensor::thumb_abduction);
    deg[2] = at(Sensor::thumb_mcp);
    deg[3] = at(Sensor::thumb_ip);
    const double middle_ring = at(Sensor::middle_ring_abduction);
    const double sideways[4] = {at(Sensor::index_middle_abduction), 0.0, -middle_ring,
                                -middle_ring - at(Sensor::ring_little_abduction)};
    for (std::size_t f = 0; f < 4; ++f) {
      const std::size_t first = slot(Sensor::index_mcp) + 4 * f;
      deg[4 + 4 * f] = to_degrees(angles[first]);
      deg[5 + 4 * f] = sideways[f];
      deg[6 + 4 * f] = to_degrees(angles[first + 1]);
      deg[7 + 4 * f] = to_degrees(angles[first + 2]);
    }
    deg[20] = at(Sensor::palm_arch);
    deg[21] = at(Sensor::wrist_pitch);
    deg[22] = at(Sensor::wrist_yaw);
    return deg;
  }

  /// A minute of grasps, pinches and free motion, of which ten moments a second are kept.
  std::vector<JudgedMoment> move() {
    std::vector<JudgedMoment> moments;
    int turn = 0, touching = 0;
    const auto show = [&](const SensorAngles& angles) {
      const CountRow counts = read(angles);
      if (turn++ % 6 == 0) moments.push_back({counts, degrees_of(angles), touching});
    };
    for (int n = 0; n < 8; ++n) { // grasps
      SensorAngles grasp = relaxed();
      const double closed = uniform(0.3, 0.95);
      for (std::size_t k = slot(Sensor::index_mcp); k < slot(Sensor::palm_arch); ++k)
        if (stranger_joints[k].gain != 0.0 && k % 4 != 3)
          grasp[k] = clamped(k, high_[k] * (closed + normal(0.0, 0.08)));
      grasp[0] = clamped(0, from_degrees(normal(50, 12)));
      grasp[3] = clamped(3, from_degrees(normal(35, 8)));
      grasp[1] = clamped(1, high_[1] * closed * uniform(0.4, 0.9));
      grasp[2] = clamped(2, high_[2] * closed * uniform(0.4, 0.9));
      grasp[slot(Sensor::wrist_pitch)] = from_degrees(normal(-15, 15));
      go(grasp, 1.0, show);
      go(grasp, 0.4, show);
      go(relaxed(), 0.8, show);
    }
    for (int n = 0; n < 10; ++n) {
      SensorAngles pinch = relaxed();
      pinch[slot(Sensor::wrist_pitch)] = from_degrees(normal(-10, 15));
      const std::size_t digit = 1 + static_cast<std::size_t>(n) % 4;
      const bool there = make_touch(digit, 0.0007, pinch);
      go(pinch, 0.9, show);
      touching = there ? static_cast<int>(digit) : 0;
      go(pinch, 0.6, show);
      touching = 0;
    }
    move_freely(25.0, show);
    return moments;
  }

  std::mt19937_64 random_;
  StrangerErrors errors_;
  StrangerHand hand_;
  SensorMask sensors_ = sensors_22;
  SensorAngles now_{};
  std::array<double, sensor_slots> low_{}, high_{}, habit_{}, bow_{}, lag_{}, creep_{}, gain_{},
      offset_{}, slipped_{}, lagging_{}, crept_{};
  std::vector<Reads> reads_;
};

} // namespace
} // namespace stranger_parts

JudgedWearer make_stranger(std::uint64_t seed, SensorMask sensors, const StrangerErrors& errors) {
  return stranger_parts::Stranger(seed, errors).make(seed, sensors);
}

StrangerHand hand_of_stranger(std::uint64_t seed) {
  std::mt19937_64 random = stranger_parts::random_of(seed);
  return StrangerHand(random);
}

} // namespace nendo::bench
