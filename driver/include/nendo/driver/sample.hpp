#pragma once
// What a glove delivers: raw counts for up to 24 named sensor slots, with the time of arrival.
// Counts only; angles begin in `hand`. This is the one header of `driver` that `hand` may include.

#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/base/event_count.hpp>
#include <nendo/base/side.hpp>
#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/units.hpp>

namespace nendo {

/// The CyberGlove's 24 sensor slots, in the order of its mask bits (vendor library and manual
/// agree). The abduction sensors beside the thumb's measure the angle between two neighbouring
/// fingers. The glove's documents call the little finger pinky; here it has the name that OpenXR
/// and anatomy give it.
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

/// Returns the sensor of that name. Also accepts older names, which have pinky in place of little.
constexpr std::optional<Sensor> sensor_named(std::string_view name) noexcept {
  constexpr std::string_view older = "pinky", newer = "little";
  const std::size_t at = name.find(older);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const std::string_view known = sensor_names[slot];
    if (known == name) return static_cast<Sensor>(slot);
    if (at != name.npos && known.find(newer) == at && known.substr(0, at) == name.substr(0, at) &&
        known.substr(at + newer.size()) == name.substr(at + older.size()))
      return static_cast<Sensor>(slot);
  }
  return std::nullopt;
}

constexpr std::size_t index_of(Sensor sensor) noexcept {
  return static_cast<std::size_t>(sensor);
}

/// Returns whether the sensor measures the gap between two neighbouring fingers.
constexpr bool is_gap(Sensor sensor) noexcept {
  return sensor == Sensor::index_middle_abduction || sensor == Sensor::middle_ring_abduction ||
         sensor == Sensor::ring_little_abduction;
}

/// A set of sensor slots; bit k is slot k, as in the glove's own masks.
struct SensorMask {
  std::uint32_t bits = 0;

  constexpr bool has(Sensor sensor) const noexcept {
    return ((bits >> static_cast<unsigned>(sensor)) & 1U) != 0;
  }
  constexpr void add(Sensor sensor) noexcept { bits |= 1U << static_cast<unsigned>(sensor); }
  friend constexpr bool operator==(SensorMask, SensorMask) = default;

  /// Visits the sensors in the order of their slots, as they were when the visit began.
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

/// What a glove's counts mean before anyone has calibrated it to a wearer.
struct CountScale {
  std::uint16_t most = 255; ///< the largest count
  /// True: 0 is the straight (closed) joint and `most` the fully bent (spread) one, as gloves
  /// report that calibrate themselves. False: the bare converter of a CyberGlove.
  bool whole_range = false;
  friend constexpr bool operator==(CountScale, CountScale) = default;
};

/// The switch at a CyberGlove's wrist, as far as the glove reports it.
enum class WristSwitch : std::uint8_t { unknown, off, on };

struct GloveSample {
  HostTime arrival{}; ///< when the record's last byte reached the host
  /// When the glove took it: its own time stamp on the host's clock, with the host's jitter removed
  /// by an estimate of offset and drift. Equals `arrival` unless has_device_time.
  HostTime measured{};
  /// The glove's own clock since its own zero, unwrapped; if has_device_time.
  std::chrono::nanoseconds device_time{};
  std::uint64_t sequence =
      0; ///< counts every record of this glove, also those that the ring refused
  std::array<RawCount, sensor_slots> raw{};
  SensorMask present; ///< which slots of `raw` were measured
  bool has_device_time = false;
  bool sampled_too_fast = false; ///< the glove says that it cannot keep its period (`es`)
  WristSwitch wrist_switch = WristSwitch::unknown;
  Side side = Side::right;
  bool is_replayed = false; ///< `arrival` and `measured` are of the replay
  /// What they were when the sample was recorded; if is_replayed.
  HostTime recorded_arrival{};
  HostTime recorded_measured{};

  /// Returns when it was measured, as exactly as it is known.
  constexpr HostTime time() const noexcept { return has_device_time ? measured : arrival; }
  constexpr RawCount operator[](Sensor sensor) const noexcept {
    return raw[static_cast<std::size_t>(sensor)];
  }
  /// What was measured, and that it was.
  constexpr void set(Sensor sensor, RawCount count) noexcept {
    raw[static_cast<std::size_t>(sensor)] = count;
    present.add(sensor);
  }
};

/// Carries samples from a glove's reader thread to the one thread that uses them. The ring notifies
/// an event count, if it has one, of every sample, for a user that sleeps until one comes.
class SampleRing {
public:
  /// Allocates once, `at_least` samples rounded up to a power of two. `event_count` may serve
  /// several rings; it must outlive them.
  explicit SampleRing(std::size_t at_least, EventCount* event_count = nullptr)
      : ring_(at_least), event_count_(event_count) {}

  /// Producer only, wait-free but for the system call that wakes a sleeper. False: the ring is
  /// full, the sample was refused and counted.
  bool try_push(const GloveSample& sample) noexcept {
    const bool taken = ring_.try_push(sample);
    if (event_count_ != nullptr) event_count_->notify();
    return taken;
  }

  // SpscRing's: for the consumer; size() and counters() are thread-safe.
  bool try_pop(GloveSample& sample) noexcept { return ring_.try_pop(sample); }
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    return ring_.drain(sink);
  }
  [[nodiscard]] std::size_t capacity() const noexcept { return ring_.capacity(); }
  [[nodiscard]] std::size_t size() const noexcept { return ring_.size(); }
  [[nodiscard]] RingCounters counters() const noexcept { return ring_.counters(); }

private:
  SpscRing<GloveSample> ring_;
  EventCount* const event_count_;
};

} // namespace nendo
