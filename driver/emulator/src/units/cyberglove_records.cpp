#include "units/cyberglove_unit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace nendo::emulator::unit {
namespace {

// The count of a slot without a sensor. No source gives it; chosen: a floating input.
constexpr Byte open_input = 255;

void append_errors(Message& record, bool unplugged, bool too_fast) {
  if (unplugged) append(record, "eg");
  if (too_fast) append(record, "es");
}

} // namespace

RecordMaker::RecordMaker(driver::Motion motion, Side side, std::uint32_t seed, bool stamp_bit7,
                         bool pattern, std::vector<Message> capture)
    : motion_(motion), seed_(seed), hand_(motion, side, seed), wearer_(seed),
      stamp_bit7_(stamp_bit7), pattern_(pattern), capture_(std::move(capture)) {}

void RecordMaker::wear(Side side) {
  hand_ = driver::HandMotion(motion_, side, seed_);
}

unsigned RecordMaker::patterned(std::size_t slot) const noexcept {
  return static_cast<unsigned>(1 + (record_number_ + 29 * slot) % 255);
}

driver::JointAngles RecordMaker::angles(EmulatedUnit::Time now) {
  if (!motion_origin_) motion_origin_ = now; // what the first host sees is the same every time
  const double time_s = std::chrono::duration<double>(now - *motion_origin_).count();
  return played_ ? played_(time_s) : hand_.at(time_s);
}

void RecordMaker::stick(Sensor sensor, std::optional<std::uint16_t> count) noexcept {
  stuck_.add(sensor);
  auto& at = stuck_at_[static_cast<std::size_t>(sensor)];
  at.reset();
  // The end of 8 bits is the end of 12.
  if (count) at = *count == 255 ? 4095U : 16U * *count;
}

void RecordMaker::release(Sensor sensor) noexcept {
  stuck_.bits &= ~(1U << static_cast<unsigned>(sensor));
}

/// Returns what the sensor of that slot shows of a count, both in 16ths.
unsigned RecordMaker::held(std::size_t slot, unsigned sixteenths) noexcept {
  if (!stuck_.has(static_cast<Sensor>(slot))) return sixteenths;
  if (!stuck_at_[slot]) stuck_at_[slot] = sixteenths;
  return *stuck_at_[slot];
}

// Bit k of the first byte says that byte k was 0 and is sent as 1. The manual has bit 7 always set;
// one author who owned a glove never saw it, and the vendor's library refuses a first byte of 0.
// Without `stamp_bit7_` it is therefore set where the byte would otherwise be 0, and only there.
Message RecordMaker::time_stamp(std::uint64_t ticks) const {
  Message stamp = low_first(static_cast<std::uint32_t>(ticks), 4);
  Byte replaced = stamp_bit7_ ? 0x80 : 0;
  for (unsigned k = 0; k < 4; ++k) {
    if (stamp[k] != 0) continue;
    stamp[k] = 1;
    replaced = static_cast<Byte>(replaced | (1U << k));
  }
  stamp.insert(stamp.begin(), replaced == 0 ? Byte{0x80} : replaced);
  return stamp;
}

// Returns the part of a record between its header and its end. No byte is 0, so that NUL marks the
// end and nothing else.
Message RecordMaker::fields(const RecordFrame& frame, const Settings& settings,
                            const PluggedGlove& known, const std::optional<PluggedGlove>& plugged) {
  auto raw = wearer_.counts(angles(frame.now));
  for (std::size_t slot = 0; pattern_ && slot < sensor_slots; ++slot)
    raw[slot].value = static_cast<std::uint16_t>(patterned(slot));
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    raw[slot].value = static_cast<std::uint16_t>(held(slot, 16U * raw[slot].value) / 16U);
  ++record_number_;
  const std::uint32_t enabled = known.mask & settings.mask;
  const std::uint32_t connected = plugged ? plugged->mask : 0;
  Message fields;
  for (std::size_t slot = 0; slot < sensor_slots && fields.size() < settings.values; ++slot) {
    if (((enabled >> slot) & 1U) == 0) continue;
    const bool wired = ((connected >> slot) & 1U) != 0;
    // Slot 7 is in some old masks; what is built in there is always 0 and goes as 1.
    const Byte count = wired ? static_cast<Byte>(std::max<int>(raw[slot].value, 1)) : open_input;
    fields.push_back(settings.quantised ? settings.quantise(slot, count) : count);
  }
  if (settings.time_stamp) {
    const Message stamp = time_stamp(frame.ticks);
    fields.insert(fields.end(), stamp.begin(), stamp.end());
  }
  if (settings.status_byte) fields.push_back(frame.status);
  return fields;
}

Message RecordMaker::record(const RecordFrame& frame, const Settings& settings,
                            const PluggedGlove& known, const std::optional<PluggedGlove>& plugged) {
  Message record;
  if (!capture_.empty()) {
    record = capture_[next_captured_];
    next_captured_ = (next_captured_ + 1) % capture_.size();
    record.front() = frame.header;
    record.pop_back();
  } else {
    const Message data = fields(frame, settings, known, plugged);
    record.push_back(frame.header);
    if (is_lower(frame.header)) {
      for (const Byte field : data)
        append(record, " " + std::to_string(field));
      append(record, "\r\n");
    } else {
      record.insert(record.end(), data.begin(), data.end());
    }
  }
  append_errors(record, !plugged, frame.too_fast);
  record.push_back(0);
  return record;
}

Message RecordMaker::fine_record(const RecordFrame& frame,
                                 const std::optional<PluggedGlove>& plugged) {
  const std::uint64_t seconds = frame.ticks / tick_hz;
  const std::uint64_t parts = frame.ticks % tick_hz * 30 * frame.subframes / tick_hz;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%02u:%02u:%02u:%02u:%uS",
                static_cast<unsigned>(seconds / 3600 % 24),
                static_cast<unsigned>(seconds / 60 % 60), static_cast<unsigned>(seconds % 60),
                static_cast<unsigned>(parts / frame.subframes + 1),
                static_cast<unsigned>(parts % frame.subframes + frame.first_subframe));
  Message record;
  append(record, text.data());
  const driver::JointAngles pose = angles(frame.now);
  const std::uint32_t connected = plugged ? plugged->mask : 0;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (!sensors_22.has(sensor)) continue;
    const driver::NominalSensor nominal = driver::nominal_sensor(sensor);
    const double count =
        16.0 * (pattern_ ? patterned(slot) : nominal.offset_counts + pose[slot] / nominal.gain_rad);
    // 0 is how a sensor says that it has failed.
    const auto value =
        ((connected >> slot) & 1U) == 0
            ? 0U
            : held(slot, static_cast<unsigned>(std::clamp(std::lround(count), 1L, 4095L)));
    record.push_back(static_cast<Byte>(value >> 8U));
    record.push_back(static_cast<Byte>(value));
  }
  ++record_number_;
  append(record, "\r\n");
  record.push_back(0);
  return record;
}

} // namespace nendo::emulator::unit
