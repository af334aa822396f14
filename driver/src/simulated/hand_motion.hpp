#pragma once
// Motions of a simulated hand: joint angles as a pure function of motion, side, seed and time. They
// are plausible enough for development, demonstrations and tests, but have no dynamics and no
// contact.

#include <array>
#include <cstdint>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::driver {

enum class Motion : std::uint8_t {
  rest,   ///< the relaxed hand, with tremor only
  wave,   ///< wide flexion running from finger to finger
  pinch,  ///< the thumb meets each finger in turn
  grasp,  ///< the whole hand closes and opens
  sculpt, ///< pull far out by the wrist, press in, knead: cycles of about 8 s
  table,  ///< a flat hand on a table, while the elbow draws circles: the wrist's joints of the
          ///< tracker's motion `table` (wrist_motion.hpp), in step with it from the start on
  faces,  ///< hands that play a face: smile, frown, wonder, wink, pout, talk, laugh, 1.6 s each
};

/// Returns the motion that one of motion_names() (simulated_glove.hpp) names. Error: usage, naming
/// those there are.
NENDO_API Result<Motion> find_motion(std::string_view name);

/// The joint angles in radians, by sensor slot. Flexion is positive. Abduction is the angle between
/// neighbours, positive if they are apart. Slots that no glove has (index_abduction, unused) stay
/// 0.
using JointAngles = std::array<double, sensor_slots>;

struct JointRange {
  double min_rad;
  double max_rad;
};

/// Returns the range of the sensor's joint, which no motion leaves.
JointRange joint_range(Sensor sensor) noexcept;

/// Returns how far a joint is bent, from 0 (straight) to 1 (fully bent), as gloves report it that
/// calibrate themselves.
NENDO_API double part_of_range(const JointAngles& angles, Sensor sensor) noexcept;

/// The motion of one hand. It starts at time 0 in the relaxed pose and grows to its full size
/// within a second, except for `table`. Angles are continuously differentiable. Two hands of one
/// seed move alike, but not in step.
class NENDO_API HandMotion {
public:
  HandMotion(Motion motion, Side side, std::uint32_t seed) noexcept;

  /// Returns the angles at `time_s` >= 0 since the start. May be called from any thread.
  JointAngles at(double time_s) const noexcept;

  /// The properties that distinguish one hand from another. They are drawn from the seed.
  struct Character {
    double tempo = 1.0;                ///< how fast it goes through a motion's cycle
    double phase = 0.0;                ///< where in the cycle it starts, in cycles
    std::array<double, 4> amplitude{}; ///< per finger, about 1
    std::array<double, 4> lag{};       ///< per finger, in cycles
    /// Tremor is the sum of two sines a slot, which beat as real tremor does; in hertz and cycles.
    std::array<std::array<double, 2>, sensor_slots> tremor_hz{};
    std::array<std::array<double, 2>, sensor_slots> tremor_phase{};
  };

private:
  Motion motion_;
  Side side_;
  Character character_;
};

} // namespace nendo::driver
