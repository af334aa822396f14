#include "units/cyberglove_unit.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <string_view>

namespace nendo::emulator {

using namespace unit;

namespace {

using namespace std::chrono_literals;

constexpr Byte stop_byte = 0x03;
constexpr Byte reread_byte = 0x09;
constexpr Byte restart_byte = 0x12;
constexpr Byte three_prefix = '1';
constexpr auto restart_time = 1750ms; // "about 1.75 s", manual p. 45

// 1 s = 115200 ticks = 1e9 ns, in lowest terms 9 ticks = 78125 ns.
constexpr std::uint64_t to_ticks(std::chrono::nanoseconds time) noexcept {
  return static_cast<std::uint64_t>(time.count()) * 9 / 78125;
}
// Rounded up: a record is never due before its tick.
constexpr std::chrono::nanoseconds to_time(std::uint64_t ticks) noexcept {
  return std::chrono::nanoseconds(static_cast<std::int64_t>((ticks * 78125 + 8) / 9));
}

// A choice of ours, sources are silent: a command that stays incomplete is forgotten, so that a
// host that died in its middle (or a modem probe: the T of "AT" takes four bytes) does not swallow
// the next host's first bytes.
constexpr auto patience = 1s;

// The longest text form that makes sense, "ca" with two numbers a sensor, and some blanks.
constexpr std::size_t longest_text = 255;

PluggedGlove plugged_by(const UnitOptions& options) {
  const SensorMask usual = options.sensors == 18 ? sensors_18 : sensors_22;
  return {options.side, options.mask != 0 ? options.mask : usual.bits};
}

} // namespace

CyberGloveUnit::CyberGloveUnit(const UnitOptions& options)
    : options_(options), plugged_(plugged_by(options)), known_(*plugged_), next_(*plugged_),
      records_(options.motion, options.side, options.seed, options.stamp_bit7, options.pattern,
               options.capture),
      settings_(power_up_settings(options.rate_hz, known_)) {
  assert(options.rate_hz >= 1.0 && options.rate_hz <= most_rate_hz);
  if (options.streaming) start_stream('S', Time{});
}

void CyberGloveUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  for (const std::byte byte : bytes)
    handle(std::to_integer<Byte>(byte), now);
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
    command_ = 0;
    restart_ends_ = now + restart_time;
    restart_answers_ = false;
    break;
  case Incident::Kind::switch_on:
  case Incident::Kind::switch_off:
    settings_.switch_on = incident.kind == Incident::Kind::switch_on;
    if (settings_.switch_drives_light) settings_.light = settings_.switch_on;
    break;
  }
}

// While an external sync drives the records the unit still listens, or nobody could switch it off:
// a choice of ours. In a stream it is deaf to all but 0x03.
void CyberGloveUnit::handle(Byte byte, Time now) {
  if (restart_ends_) return; // the firmware is not up yet
  const bool synced = to_upper(stream_.header) == 'Y';
  if (stream_.header != 0 && !synced) {
    if (byte == stop_byte) stop();
    return;
  }
  if (command_ != 0 && now - command_since_ > patience) command_ = 0;
  if (command_ == 0) {
    begin(byte, now);
  } else if (command_ == '?') {
    command_ = 0;
    answer(byte);
  } else if (command_ == three_prefix) {
    collect_three(byte, now);
  } else if (is_lower(command_)) {
    collect_text(byte, now);
  } else {
    collect_binary(byte, now); // 0x03 included: it is a legal mask byte and a legal count
  }
}

void CyberGloveUnit::stop() {
  stream_ = {};
  settings_.binary_sync = settings_.text_sync = false;
  reply({stop_byte, 0});
}

void CyberGloveUnit::begin(Byte letter, Time now) {
  const bool three = options_.model == 3;
  switch (letter) {
  case stop_byte:
    stop();
    return;
  case reread_byte:
    read_glove();
    reply({letter, 0});
    return;
  case restart_byte:
    stream_ = {};
    restart_ends_ = now + restart_time;
    restart_answers_ = true;
    return;
  case 'G':
  case 'g':
    send_single(letter, now);
    return;
  case 'S':
  case 's':
    start_stream(letter, now);
    return;
  case ' ':
  case '\r':
  case '\n':
    return; // between text commands
  default:
    break;
  }
  if (letter == 0 && three) return; // one program ends its commands with NUL
  const bool known =
      letter == '?' || (letter == three_prefix && three) ||
      (to_upper(letter) == 'A' ? options_.touch : argument_bytes(to_upper(letter), {}, 0) != 0);
  if (!known) {
    reply({'e', '?', 0});
    return;
  }
  command_ = letter;
  command_since_ = now;
  argument_.clear();
}

void CyberGloveUnit::collect_binary(Byte byte, Time now) {
  argument_.push_back(byte);
  const auto wanted = argument_bytes(command_, argument_, known_.sensors());
  if (wanted && argument_.size() < *wanted) return;
  if (wanted) {
    set(command_, argument_, now);
  } else {
    reply({'e', 'n', 0});
  }
  command_ = 0;
}

void CyberGloveUnit::collect_text(Byte byte, Time now) {
  if (byte == stop_byte) {
    command_ = 0;
    reply({stop_byte, 0});
    return;
  }
  if (byte != '\r') {
    if (argument_.size() <= longest_text) argument_.push_back(byte);
    return;
  }
  const Byte letter = to_upper(command_);
  std::string_view text(reinterpret_cast<const char*>(argument_.data()), argument_.size());
  Message argument;
  if (letter == 'C' && !text.empty()) { // ca, co, cg
    argument.push_back(to_upper(argument_[0]));
    text.remove_prefix(1);
  }
  const Message numbers =
      argument_.size() > longest_text ? Message{} : read_numbers(text, number_width(letter));
  argument.insert(argument.end(), numbers.begin(), numbers.end());
  const auto wanted = argument_bytes(letter, argument, known_.sensors());
  // Text numbers are read high byte first, whatever the order of the binary form.
  if (!numbers.empty() && wanted == argument.size()) {
    set(command_, argument, now);
  } else {
    reply({'e', 'n', 0});
  }
  command_ = 0;
}

void CyberGloveUnit::collect_three(Byte byte, Time now) {
  argument_.push_back(byte);
  const auto wanted = three_bytes(argument_);
  if (wanted && argument_.size() < *wanted) return;
  command_ = 0;
  if (!wanted) {
    reply({'e', '?', 0});
  } else if (!unit::apply(three_, argument_)) {
    reply({'e', 'n', 0});
  } else {
    Message echo{three_prefix};
    echo.insert(echo.end(), argument_.begin(), argument_.end());
    echo.push_back(0);
    reply(echo);
    if (argument_[0] == 'S') start_three(now);
  }
}

void CyberGloveUnit::set(Byte letter, const Message& argument, Time now) {
  const bool text = is_lower(letter);
  const Settings before = settings_;
  if (!unit::apply(settings_, letter == 'y' ? letter : to_upper(letter), argument,
                   text ? WordOrder::high_first : options_.period_order, known_)) {
    reply({'e', 'n', 0});
    return;
  }
  if (!start_sync(now)) {
    settings_ = before;
    reply({'e', 'y', 0});
    return;
  }
  Message echo{letter};
  if (to_upper(letter) == 'C') {
    echo.push_back(argument[0]); // has its second letter anyway
  } else if (options_.reply_bytes == 3) {
    echo.push_back('\r'); // the vendor's library skips a byte here, whatever it is
  }
  echo.push_back(0);
  reply(echo);
}

// Reads the plugged glove. From then on all of its values are sent.
void CyberGloveUnit::read_glove() noexcept {
  if (!plugged_ || (plugged_->mask == known_.mask && plugged_->side == known_.side)) return;
  known_ = *plugged_;
  settings_.values = static_cast<Byte>(known_.sensors());
}

void CyberGloveUnit::end_restart() {
  clock_origin_ = *restart_ends_;
  restart_ends_.reset();
  read_glove();
  settings_ = power_up_settings(options_.rate_hz, known_);
  three_ = {};
  if (restart_answers_) reply({restart_byte, '\r', '\n', 0});
}

std::uint64_t CyberGloveUnit::own_ticks() const noexcept {
  return static_cast<std::uint64_t>(std::llround(static_cast<double>(tick_hz) / options_.rate_hz));
}

// The data sheet's rates of the first model for 18 sensors, with the digital filter and without;
// what the others were seen to do. A host that asks for more gets these, and `es` in every record.
std::uint64_t CyberGloveUnit::least_ticks() const noexcept {
  const std::uint64_t first_hz = settings_.filter ? 112 : 150;
  return tick_hz / (options_.model == 1 ? first_hz : options_.model == 2 ? 90 : 120);
}

void CyberGloveUnit::start_stream(Byte header, Time now) {
  const std::uint64_t asked = std::uint64_t{settings_.period_ticks} * settings_.period_repeats;
  const std::uint64_t least = std::min(own_ticks(), least_ticks());
  // A product of 0 asks for "as fast as possible".
  stream_ = {header, now, std::max(asked, least), 1, asked != 0 && asked < least};
}

void CyberGloveUnit::start_three(Time now) {
  if (three_.usb) stream_ = {three_prefix, now, three_.period_ticks(), 1, false};
}

// External sync: each pulse gives a record. Sources tell no more; chosen: the pulses come at the
// rate that the emulator was given, whatever T says. False: that is too fast.
bool CyberGloveUnit::start_sync(Time now) {
  const Byte header = settings_.binary_sync ? Byte{'Y'} : settings_.text_sync ? Byte{'y'} : Byte{0};
  if (header == stream_.header) return true;
  if (header != 0 && own_ticks() < least_ticks()) return false;
  stream_ = {};
  if (header != 0) stream_ = {header, now, own_ticks(), 1, false};
  return true;
}

CyberGloveUnit::Time CyberGloveUnit::due(std::uint64_t record) const noexcept {
  return stream_.start + to_time(record * stream_.period_ticks);
}

void CyberGloveUnit::advance(Time now) {
  if (restart_ends_ && now >= *restart_ends_) end_restart();
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
  if (stream_.header != 0) return due(stream_.next);
  return std::nullopt;
}

bool CyberGloveUnit::send_next() {
  const RecordFrame frame{stream_.header,
                          due(stream_.next),
                          to_ticks(stream_.start - clock_origin_) +
                              stream_.next * stream_.period_ticks,
                          static_cast<Byte>(parameters()),
                          stream_.too_fast,
                          three_.frames};
  ++stream_.next;
  const Message record = stream_.header == three_prefix
                             ? records_.fine_record(frame, plugged_)
                             : records_.record(frame, settings_, known_, plugged_);
  return send_record(std::as_bytes(std::span(record)));
}

void CyberGloveUnit::send_single(Byte header, Time now) {
  const RecordFrame frame{header, now, to_ticks(now - clock_origin_),
                          static_cast<Byte>(parameters()), false};
  const Message record = records_.record(frame, settings_, known_, plugged_);
  send_record(std::as_bytes(std::span(record)));
}

void CyberGloveUnit::reply(const Message& message) {
  send(std::as_bytes(std::span(message)));
}

} // namespace nendo::emulator
