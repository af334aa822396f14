#include <nendo/hand/stuck_watch.hpp>

#include <algorithm>
#include <utility>

namespace nendo::hand {
namespace {

constexpr std::array<Sensor, 4> thumb_sensors{Sensor::thumb_roll, Sensor::thumb_mcp,
                                              Sensor::thumb_ip, Sensor::thumb_abduction};

/// This number of changed samples in a row shows that a stuck sensor moves again: bits that turn
/// over on the line do not come so often.
constexpr std::uint8_t samples_back = 5;

} // namespace

StuckWatch::StuckWatch(CountScale scale, SensorMask stuck) noexcept
    : scale_(scale), first_stuck_(stuck) {}

void StuckWatch::reset(const GloveSample& sample) noexcept {
  watched_ = {};
  stuck_ = {std::exchange(first_stuck_, {}).bits & sample.present.bits};
  number_ = 0;
  side_ = sample.side;
  present_ = sample.present;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    watched_[slot].low = watched_[slot].high = sample.raw[slot].value;
    watched_[slot].changed_at = sample.time();
  }
}

void StuckWatch::watch(std::size_t slot, const GloveSample& sample) noexcept {
  Watched& sensor = watched_[slot];
  const std::uint16_t count = sample.raw[slot].value;
  const auto name = static_cast<Sensor>(slot);
  const std::uint16_t low = std::min(sensor.low, count), high = std::max(sensor.high, count);
  if (is_still(low, high, scale_)) {
    sensor.low = low;
    sensor.high = high;
    sensor.away = 0;
    return;
  }
  if (stuck_.has(name) && ++sensor.away < samples_back) return;
  stuck_.bits &= ~(1U << slot);
  sensor.away = 0;
  sensor.low = sensor.high = count;
  sensor.changed = number_;
  sensor.changed_at = sample.time();
}

bool StuckWatch::has_swung(std::size_t slot, std::uint64_t since,
                           std::size_t times) const noexcept {
  const auto& ended = watched_[slot].ended;
  return present_.has(static_cast<Sensor>(slot)) && !stuck_.has(static_cast<Sensor>(slot)) &&
         static_cast<std::size_t>(std::count_if(
             ended.begin(), ended.end(), [&](std::uint64_t at) { return at > since; })) >= times;
}

/// Returns how many of the sensors, but for `of` itself, have swung so often since that one
/// changed.
template <class Sensors>
int StuckWatch::swung(const Sensors& sensors, std::size_t of, std::size_t times) const noexcept {
  return static_cast<int>(std::count_if(sensors.begin(), sensors.end(), [&](Sensor sensor) {
    return index_of(sensor) != of && has_swung(index_of(sensor), watched_[of].changed, times);
  }));
}

/// A finger's flexion sensor is stuck if the other joints of the finger move; where only one of
/// them does, and it may be bent alone, the same joints of other fingers must.
bool StuckWatch::shown_by_finger(std::size_t slot) const noexcept {
  const std::size_t finger = slot / 4 - 1, joint = slot % 4;
  int usable = 0;
  for (const Sensor sensor : finger_sensors[finger])
    if (index_of(sensor) != slot && present_.has(sensor) && !stuck_.has(sensor)) ++usable;
  std::array<Sensor, 4> alike{};
  for (std::size_t f = 0; f < alike.size(); ++f)
    alike[f] = finger_sensors[f][joint];
  const int moved = swung(finger_sensors[finger], slot, 3);
  if (moved >= 2 || (usable == 1 && moved == 1 && swung(alike, slot, 3) >= 1)) return true;
  if (swung(finger_sensors[finger], slot, 6) >= 1 && swung(alike, slot, 4) >= 2) return true;
  return usable == 0 && shown_by_hand(slot, kept_swings, 80);
}

bool StuckWatch::shown_by_thumb(std::size_t slot) const noexcept {
  const int moved = swung(thumb_sensors, slot, 3);
  return moved >= 2 || (moved == 1 && shown_by_hand(slot, 4, 50));
}

/// Returns whether so many per cent of all other sensors have swung so often.
bool StuckWatch::shown_by_hand(std::size_t slot, std::size_t times, int part) const noexcept {
  int others = 0, moved = 0;
  for (const Sensor sensor : SensorMask{present_.bits & ~stuck_.bits}) {
    const std::size_t other = index_of(sensor);
    if (other == slot) continue;
    ++others;
    if (has_swung(other, watched_[slot].changed, times)) ++moved;
  }
  return moved >= 4 && 100 * moved >= part * others;
}

bool StuckWatch::is_shown(std::size_t slot, const GloveSample& sample) const noexcept {
  const auto sensor = static_cast<Sensor>(slot);
  const Watched& still = watched_[slot];
  if (!present_.has(sensor) || stuck_.has(sensor) ||
      seconds_between(still.changed_at, sample.time()) < min_still_s)
    return false;
  if (rests_at_end(still.low, still.high, scale_)) return false;
  constexpr std::size_t often = 6;
  switch (sensor) {
  case Sensor::thumb_roll:
  case Sensor::thumb_mcp:
  case Sensor::thumb_ip:
  case Sensor::thumb_abduction:
    return shown_by_thumb(slot);
  case Sensor::index_abduction: // no glove has these
  case Sensor::unused:
    return false;
  case Sensor::index_middle_abduction:
  case Sensor::middle_ring_abduction:
  case Sensor::ring_little_abduction: {
    const std::size_t finger = slot / 4 - 1;
    return swung(std::array{finger_sensors[finger - 1][0], finger_sensors[finger][0]}, slot, 4) ==
               2 &&
           shown_by_hand(slot, 4, 40);
  }
  case Sensor::palm_arch:
  case Sensor::wrist_pitch:
  case Sensor::wrist_yaw:
    return shown_by_hand(slot, often, 50);
  default:
    return shown_by_finger(slot);
  }
}

void StuckWatch::push(const GloveSample& sample) noexcept {
  if (number_ == 0 || sample.side != side_ || sample.present != present_) reset(sample);
  ++number_;
  const double min_swing = min_swing_counts * scale_.max_count / 255.0;
  bool any = false;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!present_.has(static_cast<Sensor>(slot))) continue;
    watch(slot, sample);
    Watched& sensor = watched_[slot];
    if (!sensor.swings.push(sample.raw[slot].value, min_swing)) continue;
    sensor.ended[sensor.next] = number_;
    sensor.next = (sensor.next + 1) % kept_swings;
    any = true;
  }
  if (!any) return; // only a swing can show anything new
  SensorMask found;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (is_shown(slot, sample)) found.add(static_cast<Sensor>(slot));
  stuck_.bits |= found.bits;
}

} // namespace nendo::hand
