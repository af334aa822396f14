#pragma once
// Names where each angle of joint_angles() comes from: a sensor, a rule, or nothing at all. The
// angles themselves do not show it, and programs that record, calibrate or judge poses must be able
// to distinguish these.

#include <array>
#include <cstdint>
#include <string_view>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::hand {

enum class AngleSource : std::uint8_t {
  measured,   ///< sensors of its own; spreading is counted from the middle finger's own direction
  from_mcp,   ///< estimated: a finger's PIP, the thumb's IP
  from_pip,   ///< estimated: a finger's MCP or DIP. The PIP may itself be an estimate
  from_ip,    ///< estimated: the thumb's MCP
  opposition, ///< estimated: the thumb's roll and abduction, from its flexion
  from_gaps,  ///< estimated: a finger's direction, from gaps between fingers that are not enough
  zero,       ///< assumed: always 0
  // For sensors that are left out:
  from_neighbours, ///< estimated: from the finger's other joints, and from the fingers beside
  at_rest,         ///< estimated: always as of a hand at rest
};

inline constexpr std::size_t angle_source_count = 9;

constexpr std::string_view name_of(AngleSource source) noexcept {
  constexpr std::array<std::string_view, angle_source_count> names{
      "measured",  "from_mcp", "from_pip",        "from_ip", "opposition",
      "from_gaps", "zero",     "from_neighbours", "at_rest"};
  return names[static_cast<std::size_t>(source)];
}

constexpr bool is_estimated(AngleSource source) noexcept {
  return source != AngleSource::measured && source != AngleSource::zero;
}

/// The source of each angle, by index_of(Angle).
using AngleSources = std::array<AngleSource, angle_count>;

/// Returns where joint_angles() takes each angle from, for samples of a glove that has these
/// sensors: GloveInfo::sensors, or any sample's `present`, of which some may be `left_out`. The
/// result is constant for a glove and what is left out of it. Wait-free.
NENDO_API AngleSources angle_sources(SensorMask present, SensorMask left_out = {}) noexcept;

// How far off the angles of a calibrated glove are likely to be, so that users of a pose know
// how accurate it is. What is measured is off by a few degrees, always alike. What is estimated can
// be far off: an estimate of a DIP joint knows how far the PIP joint bends, and not whether the
// finger makes a hook.
/// One standard deviation of each angle, by index_of(Angle), in radians; 0 where nothing is known,
/// because the angle is only assumed.
using AngleDeviations = std::array<double, angle_count>;

/// Returns what to expect of `angles`, which joint_angles() has made of a calibrated glove that has
/// these sensors, some of them perhaps `left_out`. The figures are those of strangers for tuning
/// (CALIBRATION-EVIDENCE.md): the median error of each group, as that of a normal distribution; a
/// DIP joint's by how far its PIP joint bends, least at 40 to 65 degrees; of other estimates by
/// those of the joint that they rest on, and assumed. Finite. Wait-free.
NENDO_API AngleDeviations angle_deviations(const JointAngles& angles, SensorMask present,
                                           SensorMask left_out = {}) noexcept;

} // namespace nendo::hand
