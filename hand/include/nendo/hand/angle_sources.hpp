#pragma once
// The source of each angle of joint_angles(): a sensor, an estimate, or a constant. The angles
// themselves do not show it, and programs that record, calibrate or judge poses need it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::hand {

enum class AngleSource : std::uint8_t {
  measured,   ///< own sensors; abduction is relative to the middle finger
  from_mcp,   ///< a finger's PIP or the thumb's IP, estimated from the MCP
  from_pip,   ///< a finger's MCP or DIP, estimated from a PIP that may be an estimate
  from_ip,    ///< the thumb's MCP, estimated from the IP
  opposition, ///< the thumb's roll and abduction, estimated from its flexion
  from_gaps,  ///< a finger's abduction, estimated from some of the gaps
  zero,       ///< assumed: always 0
  // For sensors that are left out:
  from_neighbours, ///< estimated from the finger's other joints and from neighbours
  at_rest,         ///< constant: the angle of a hand at rest
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

/// Returns which angles are measured: bit k is that of the angle with index k.
constexpr std::uint32_t measured_bits(const AngleSources& sources) noexcept {
  std::uint32_t bits = 0;
  for (std::size_t at = 0; at < angle_count; ++at)
    if (sources[at] == AngleSource::measured) bits |= 1U << at;
  return bits;
}

/// Returns the source of each angle of joint_angles() for a glove with these sensors
/// (GloveInfo::sensors, or any sample's `present`), of which some may be `left_out`. The result
/// depends only on the arguments. Wait-free.
NENDO_API AngleSources angle_sources(SensorMask present, SensorMask left_out = {}) noexcept;

/// The expected errors of a calibrated glove's angles: one standard deviation of each, by
/// index_of(Angle), in radians; 0 for AngleSource::zero, whose error is unknown. Measured angles
/// are off by a few degrees, consistently. Estimated angles can be far off: an estimate of a DIP
/// angle uses the PIP angle, and cannot detect a hook.
using AngleDeviations = std::array<double, angle_count>;

/// Returns the expected errors of `angles`, made by joint_angles() for a calibrated glove with
/// these sensors, some of them perhaps `left_out`. Values of measured angles are median errors of
/// the tuning wearers (CALIBRATION-EVIDENCE.md) per group of joints, converted to deviations of a
/// normal distribution. The deviation of a DIP estimate depends on the PIP angle and is least at 40
/// to 65 degrees. The other values are assumed. Finite. Wait-free.
NENDO_API AngleDeviations angle_deviations(const JointAngles& angles, SensorMask present,
                                           SensorMask left_out = {}) noexcept;

} // namespace nendo::hand
