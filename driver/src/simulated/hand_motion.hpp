#pragma once
// Motions of a simulated hand: joint angles as a pure function of motion, side, seed and time.
// Plausible enough to develop, demonstrate and test with, and no more: no dynamics, no contact.

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
  sculpt, ///< press in, knead, pull out: cycles of about 8 s
};

/// By one of motion_names() (simulated_glove.hpp). Error: usage, naming those there are.
Result<Motion> find_motion(std::string_view name);

/// Radians, one a sensor slot. Flexion is positive, abduction is the angle between neighbours
/// (positive = apart). Slots that no glove has (index_abduction, unused) stay 0.
using JointAngles = std::array<double, sensor_slots>;

struct JointRange {
  double least_rad;
  double most_rad;
};

/// The range that a motion never leaves.
JointRange joint_range(Sensor sensor) noexcept;

/// How far through its range a joint is: 0 straight to 1 fully bent, as gloves report that
/// calibrate themselves.
double part_of_range(const JointAngles& angles, Sensor sensor) noexcept;

/// One hand's motion. Every motion starts at time 0 in the relaxed pose and grows to its full size
/// within a second; angles are continuously differentiable. Two hands of one seed move alike but
/// not in lock-step.
class HandMotion {
public:
  HandMotion(Motion motion, Side side, std::uint32_t seed) noexcept;

  /// `time_s` since the start, at least 0. Any thread, no state.
  JointAngles at(double time_s) const noexcept;

  /// The properties that distinguish one hand from another. They are drawn from the seed.
  struct Character {
    double tempo = 1.0;                ///< how fast it goes through a motion's cycle
    double phase = 0.0;                ///< where in the cycle it starts, in cycles
    std::array<double, 4> amplitude{}; ///< of each finger, about 1
    std::array<double, 4> lag{};       ///< of each finger, in cycles
    /// Two sines a slot, in hertz and cycles: their beat is what makes tremor look like tremor.
    std::array<std::array<double, 2>, sensor_slots> tremor_hz{};
    std::array<std::array<double, 2>, sensor_slots> tremor_phase{};
  };

private:
  Motion motion_;
  Character character_;
};

} // namespace nendo::driver
