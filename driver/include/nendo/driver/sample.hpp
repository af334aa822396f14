#pragma once
// A sample of a glove: raw counts for up to 24 named sensor slots, with their times. `hand` turns
// them into angles. `hand` may include only this header of `driver` and pose_sample.hpp.

#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/base/notifying_ring.hpp>
#include <nendo/base/side.hpp>
#include <nendo/base/units.hpp>

namespace nendo {

/// The CyberGlove's 24 sensor slots, in the order of its mask bits (vendor library and manual
/// agree). All abduction sensors but the thumb's measure the angle between two neighbouring
/// fingers. The vendor's "pinky" is called little, as in OpenXR and anatomy.
enum class Sensor : std::uint8_t {
  thumb_roll,
  thumb_mcp,
  thumb_ip,
  thumb_abduction,
  index_mcp,
  index_pip,
  index_dip,
  index_abduction, ///< reserved by the protocol, built into no known glove
  middle_mcp,
  middle_pip,
  middle_dip,
  index_middle_abduction,
  ring_mcp,
  ring_pip,
  ring_dip,
  middle_ring_abduction,
  little_mcp,
  little_pip,
  little_dip,
  ring_little_abduction,
  palm_arch,
  wrist_pitch,
  wrist_yaw,
  unused, ///< slot 23
};

inline constexpr std::size_t sensor_slots = 24;

inline constexpr std::array<std::string_view, sensor_slots> sensor_names{
    "thumb_roll", "thumb_mcp",   "thumb_ip",   "thumb_abduction",
    "index_mcp",  "index_pip",   "index_dip",  "index_abduction",
    "middle_mcp", "middle_pip",  "middle_dip", "index_middle_abduction",
    "ring_mcp",   "ring_pip",    "ring_dip",   "middle_ring_abduction",
    "little_mcp", "little_pip",  "little_dip", "ring_little_abduction",
    "palm_arch",  "wrist_pitch", "wrist_yaw",  "unused",
};

constexpr std::string_view name_of(Sensor sensor) noexcept {
  return sensor_names[static_cast<std::size_t>(sensor)];
}

/// Returns the sensor of that name. Also accepts older names with pinky for little.
constexpr std::optional<Sensor> sensor_named(std::string_view name) noexcept {
  constexpr std::string_view older = "pinky", newer = "little";
  const std::size_t at = name.find(older);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const std::string_view known = sensor_names[slot];
    if (known == name) return static_cast<Sensor>(slot);
    if (at != std::string_view::npos && known.find(newer) == at &&
        known.substr(0, at) == name.substr(0, at) &&
        known.substr(at + newer.size()) == name.substr(at + older.size()))
      return static_cast<Sensor>(slot);
  }
  return std::nullopt;
}

constexpr std::size_t index_of(Sensor sensor) noexcept {
  return static_cast<std::size_t>(sensor);
}

/// MCP, PIP and DIP of index, middle, ring and little finger.
inline constexpr std::array<std::array<Sensor, 3>, 4> finger_sensors{{
    {Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip},
    {Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip},
    {Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip},
    {Sensor::little_mcp, Sensor::little_pip, Sensor::little_dip},
}};
/// The sensors of the gaps between neighbouring fingers, from the index finger on.
inline constexpr std::array<Sensor, 3> gap_sensors{
    Sensor::index_middle_abduction, Sensor::middle_ring_abduction, Sensor::ring_little_abduction};
constexpr bool is_gap(Sensor sensor) noexcept {
  return sensor == gap_sensors[0] || sensor == gap_sensors[1] || sensor == gap_sensors[2];
}

/// A set of sensor slots; bit k is slot k, as in the glove's own masks.
struct SensorMask {
  std::uint32_t bits = 0;

  constexpr bool has(Sensor sensor) const noexcept {
    return ((bits >> static_cast<unsigned>(sensor)) & 1U) != 0;
  }
  constexpr void add(Sensor sensor) noexcept { bits |= 1U << static_cast<unsigned>(sensor); }
  friend constexpr bool operator==(SensorMask, SensorMask) = default;

  /// Iterates over a copy of the mask, in the order of slots.
  class Iterator {
  public:
    constexpr explicit Iterator(std::uint32_t rest) noexcept : rest_(rest) {}
    constexpr Sensor operator*() const noexcept {
      return static_cast<Sensor>(std::countr_zero(rest_));
    }
    constexpr Iterator& operator++() noexcept {
      rest_ &= rest_ - 1;
      return *this;
    }
    friend constexpr bool operator==(Iterator, Iterator) = default;

  private:
    std::uint32_t rest_;
  };
  constexpr Iterator begin() const noexcept { return Iterator(bits & ((1U << sensor_slots) - 1U)); }
  constexpr Iterator end() const noexcept { return Iterator(0); }
};

template <class Sensors>
constexpr SensorMask mask_of(const Sensors& sensors) noexcept {
  SensorMask mask;
  for (const Sensor sensor : sensors)
    mask.add(sensor);
  return mask;
}

/// The masks of the two gloves that were sold: 22 sensors, and 18 (without the four DIP sensors).
inline constexpr SensorMask sensors_22{0x7FFF7F};
inline constexpr SensorMask sensors_18{0x7BBB3F};

/// The scale of a glove's counts before calibration to a wearer.
struct CountScale {
  std::uint16_t max_count = 255;
  /// True: 0 is a straight (closed) joint and `max_count` a fully bent (spread) one, as
  /// self-calibrating gloves report. False: counts of a CyberGlove's A/D converter.
  bool self_calibrated = false;
  friend constexpr bool operator==(CountScale, CountScale) = default;
};

/// The state of a CyberGlove's wrist switch, if reported.
enum class WristSwitch : std::uint8_t { unknown, off, on };

struct GloveSample {
  HostTime arrival{}; ///< when the record's last byte reached the host
  /// The time of measurement: the glove's time stamp, mapped to the host's clock without its jitter
  /// by an estimate of offset and drift. Equals `arrival` unless has_device_time.
  HostTime measured{};
  /// The glove's own clock, unwrapped, from its own zero; if has_device_time.
  std::chrono::nanoseconds device_time{};
  std::uint64_t sequence = 0; ///< number of the record; also counts records that the ring refused
  std::array<RawCount, sensor_slots> raw{};
  SensorMask present; ///< which slots of `raw` were measured
  bool has_device_time = false;
  bool sampled_too_fast = false; ///< the glove reports that it cannot keep its period (`es`)
  WristSwitch wrist_switch = WristSwitch::unknown;
  Side side = Side::right;
  bool is_replayed = false; ///< `arrival` and `measured` are times of the replay
  /// The original `arrival` and `measured`; if is_replayed.
  HostTime recorded_arrival{};
  HostTime recorded_measured{};

  /// Returns the best known time of measurement.
  constexpr HostTime time() const noexcept { return has_device_time ? measured : arrival; }
  constexpr RawCount operator[](Sensor sensor) const noexcept {
    return raw[static_cast<std::size_t>(sensor)];
  }
  /// Sets a count and marks the sensor as present.
  constexpr void set(Sensor sensor, RawCount count) noexcept {
    raw[static_cast<std::size_t>(sensor)] = count;
    present.add(sensor);
  }
};

/// Carries samples from a glove's reader thread to one consumer thread.
using SampleRing = NotifyingRing<GloveSample>;

} // namespace nendo
