#include "units/cyberglove_unit.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

namespace nendo::emulator {

using namespace unit;

namespace {

using namespace std::chrono_literals;

// No source says how often a host may ask. A program that asks as fast as it can sees some 90
// records per second.
constexpr std::uint64_t max_polls_hz = 90;
// Nor how much the unit hears meanwhile.
constexpr std::size_t max_waiting = 64;

// 1 s = 115200 ticks = 1e9 ns, in lowest terms 9 ticks = 78125 ns.
constexpr std::uint64_t to_ticks(std::chrono::nanoseconds time) noexcept {
  return static_cast<std::uint64_t>(time.count()) * 9 / 78125;
}
// Rounded up: a record is never due before its tick.
constexpr std::chrono::nanoseconds to_time(std::uint64_t ticks) noexcept {
  return std::chrono::nanoseconds(static_cast<std::int64_t>((ticks * 78125 + 8) / 9));
}

PluggedGlove plugged_by(const UnitOptions& options) {
  const SensorMask usual = options.sensors == 18 ? sensors_18 : sensors_22;
  return {options.side, options.hardware_mask != 0 ? options.hardware_mask : usual.bits};
}

} // namespace

CyberGloveUnit::CyberGloveUnit(const UnitOptions& options)
    : options_(options), plugged_(plugged_by(options)), known_(*plugged_), next_(*plugged_),
      records_(options.motion, options.side, options.seed, options.stamp_bit7, options.pattern,
               options.capture),
      settings_(power_up()) {
  records_.play(options.played);
  assert(options.rate_hz >= 1.0 && options.rate_hz <= max_rate_hz);
  if (options.streaming) start_stream('S', Time{});
}

void CyberGloveUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  for (const std::byte byte : bytes)
    hear(std::to_integer<Byte>(byte), now);
}

void CyberGloveUnit::hear(Byte byte, Time now) {
  if (!poll_) {
    handle(byte, now);
  } else if (waiting_.size() < max_waiting) {
    waiting_.push_back(byte);
  }
}

void CyberGloveUnit::inject(const Incident& incident, Time now) {
  advance(now);
  switch (incident.kind) {
  case Incident::Kind::glove_out:
    plugged_.reset();
    break;
  case Incident::Kind::glove_in:
    if (incident.sensors != 0) {
      next_.mask = (incident.sensors == 18 ? sensors_18 : sensors_22).bits;
    }
    if (incident.side) next_.side = *incident.side;
    plugged_ = next_;
    records_.wear(next_.side);
    break;
  case Incident::Kind::power_cycle:
    stream_ = {};
    begin_restart(false, now);
    break;
  case Incident::Kind::sensor_stuck:
    records_.stick(incident.sensor, incident.count);
    break;
  case Incident::Kind::sensor_free:
    records_.release(incident.sensor);
    break;
  case Incident::Kind::switch_on:
  case Incident::Kind::switch_off:
    settings_.switch_on = incident.kind == Incident::Kind::switch_on;
    if (settings_.switch_drives_light) settings_.light = settings_.switch_on;
    break;
  case Incident::Kind::tracker_error:
    break;
  }
}

// Reads the plugged glove. From then on all of its values are sent.
void CyberGloveUnit::read_glove() noexcept {
  if (!plugged_ || (plugged_->mask == known_.mask && plugged_->side == known_.side)) return;
  known_ = *plugged_;
  settings_.values = static_cast<Byte>(known_.sensors());
}

// About 1.75 s until its answer (manual p. 45). But the maker's own library waits 0.25 s, and then
// reads the answer with time limits of 0.1 s a byte: so its units must have been quicker, and the
// usual time here is one with which it works.
void CyberGloveUnit::begin_restart(bool answers, Time now) {
  stream_ = {};
  command_ = 0;
  poll_.reset();
  waiting_.clear();
  restart_ends_ = now + from_seconds(options_.restart_s);
  restart_answers_ = answers;
}

void CyberGloveUnit::end_restart() {
  clock_origin_ = *restart_ends_;
  restart_ends_.reset();
  read_glove();
  settings_ = power_up();
  three_ = {};
  if (restart_answers_) reply({restart_byte, '\r', '\n', 0});
}

Settings CyberGloveUnit::power_up() const noexcept {
  return power_up_settings((options_.overrun ? 2.0 : 1.0) * options_.rate_hz, known_);
}

std::uint64_t CyberGloveUnit::own_ticks() const noexcept {
  return static_cast<std::uint64_t>(std::llround(static_cast<double>(tick_hz) / options_.rate_hz));
}

// The data sheet's rates of the first model for 18 sensors, with the digital filter and without;
// what the others were seen to do. A host that asks for more gets these, and `es` in every record.
std::uint64_t CyberGloveUnit::min_ticks() const noexcept {
  if (options_.overrun) return own_ticks();
  const std::uint64_t first_hz = settings_.filter ? 112 : 150;
  return tick_hz / (options_.model == 1 ? first_hz : options_.model == 2 ? 90 : 120);
}

void CyberGloveUnit::start_stream(Byte header, Time now) {
  const std::uint64_t asked = std::uint64_t{settings_.period_ticks} * settings_.period_repeats;
  const std::uint64_t least = std::min(own_ticks(), min_ticks());
  // A product of 0 asks for "as fast as possible".
  stream_ = {header, now, std::max(asked, least), 1, asked != 0 && asked < least};
}

void CyberGloveUnit::start_three(Time now) {
  if (three_.usb) stream_ = {three_prefix, now, three_.period_ticks(), 1, false};
}

// External sync: each pulse gives a record. Sources say no more; chosen: the pulses come at the
// rate that the emulator was given, whatever T says. False: that is too fast.
bool CyberGloveUnit::start_sync(Time now) {
  const Byte header = settings_.binary_sync ? Byte{'Y'} : settings_.text_sync ? Byte{'y'} : Byte{0};
  if (header == stream_.header) return true;
  if (header != 0 && own_ticks() < min_ticks()) return false;
  stream_ = {};
  if (header != 0) stream_ = {header, now, own_ticks(), 1, false};
  return true;
}

CyberGloveUnit::Time CyberGloveUnit::due(std::uint64_t record) const noexcept {
  return stream_.start + to_time(record * stream_.period_ticks);
}

void CyberGloveUnit::advance(Time now) {
  answer_polls(now);
  if (restart_ends_ && now >= *restart_ends_) end_restart();
  advance_stream(now);
}

void CyberGloveUnit::answer_polls(Time now) {
  while (poll_ && poll_->due <= now) {
    const auto [header, due] = *poll_;
    advance_stream(due); // an external sync's
    poll_.reset();
    send_single(header, due);
    while (!poll_ && !waiting_.empty()) {
      const Byte byte = waiting_.front();
      waiting_.pop_front();
      handle(byte, due);
    }
  }
}

void CyberGloveUnit::advance_stream(Time now) {
  while (stream_.header != 0 && due(stream_.next) <= now) {
    const std::uint64_t refused_before = counters_.bytes_refused;
    send_next();
    const std::uint64_t refused = counters_.bytes_refused - refused_before;
    if (refused == 0) continue;
    // The output is full: account for all others that are due without making them, however long ago
    // that began.
    const std::uint64_t last = to_ticks(now - stream_.start) / stream_.period_ticks;
    if (last < stream_.next) continue;
    counters_.bytes_refused += refused * (last - stream_.next + 1);
    stream_.next = last + 1;
  }
}

std::optional<CyberGloveUnit::Time> CyberGloveUnit::next_due() const noexcept {
  if (restart_ends_) return restart_ends_;
  std::optional<Time> next;
  if (poll_) next = poll_->due;
  if (stream_.header != 0) next = std::min(next.value_or(Time::max()), due(stream_.next));
  return next;
}

bool CyberGloveUnit::send_next() {
  const RecordFrame frame{stream_.header,
                          due(stream_.next),
                          to_ticks(stream_.start - clock_origin_) +
                              stream_.next * stream_.period_ticks,
                          static_cast<Byte>(parameters()),
                          stream_.too_fast,
                          three_.frames,
                          options_.hires_terminated ? 1U : 0U};
  ++stream_.next;
  const Message record = stream_.header == three_prefix
                             ? records_.fine_record(frame, plugged_)
                             : records_.record(frame, settings_, known_, plugged_);
  return send_record(std::as_bytes(std::span(record)));
}

void CyberGloveUnit::poll(Byte header, Time now) {
  const Time soonest =
      last_single_ ? *last_single_ + to_time(std::min(own_ticks(), tick_hz / max_polls_hz)) : now;
  if (soonest <= now) {
    send_single(header, now);
  } else {
    poll_ = Poll{header, soonest};
  }
}

void CyberGloveUnit::send_single(Byte header, Time now) {
  last_single_ = now;
  const RecordFrame frame{header, now, to_ticks(now - clock_origin_),
                          static_cast<Byte>(parameters()), false};
  const Message record = records_.record(frame, settings_, known_, plugged_);
  send_record(std::as_bytes(std::span(record)));
}

void CyberGloveUnit::reply(const Message& message) {
  send(std::as_bytes(std::span(message)));
}

} // namespace nendo::emulator
