#include "emulator/cyberglove_unit.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

namespace nendo::driver {

using namespace unit;

namespace {

using namespace std::chrono_literals;

constexpr Byte stop_byte = 0x03;
constexpr Byte reread_glove = 0x09;
constexpr Byte restart_byte = 0x12;
constexpr auto restart_time = 1750ms; // "about 1.75 s", manual p. 45

constexpr std::uint64_t tick_hz = 115200;
// 1 s = 115200 ticks = 1e9 ns, in lowest terms 9 ticks = 78125 ns.
constexpr std::uint64_t to_ticks(std::chrono::nanoseconds time) noexcept {
  return static_cast<std::uint64_t>(time.count()) * 9 / 78125;
}
constexpr std::chrono::nanoseconds to_time(std::uint64_t ticks) noexcept {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(ticks * 78125 / 9));
}

// The data sheet's rates for 18 sensors, with the digital filter and without. A host that asks for
// more gets these, and `es` in every record.
constexpr std::uint64_t fastest_filtered_hz = 112;
constexpr std::uint64_t fastest_unfiltered_hz = 150;

// A choice of ours, sources are silent: a command that stays incomplete is forgotten, so that a
// host that died in its middle (or a modem probe: the T of "AT" takes four bytes) does not swallow
// the next host's first bytes.
constexpr auto patience = 1s;

// The longest text form that makes sense, "t 65535 65535", with room for more blanks.
constexpr std::size_t longest_text = 31;

} // namespace

// On-off settings, and their place in the three bytes of the parameter flags.
struct CyberGloveUnit::Flag {
  Byte letter;
  unsigned parameter_bit;
  bool Settings::*value;
};
const std::array<CyberGloveUnit::Flag, 7> CyberGloveUnit::flags{
    {{'W', 1, &Settings::switch_on},
     {'L', 2, &Settings::light},
     {'U', 10, &Settings::status_byte},
     {'J', 11, &Settings::switch_drives_light},
     {'F', 12, &Settings::filter},
     {'D', 13, &Settings::time_stamp},
     {'Q', 16, &Settings::quantised}}};

CyberGloveUnit::CyberGloveUnit(const UnitOptions& options)
    : options_(options), hardware_mask_((options.sensors == 18 ? sensors_18 : sensors_22).bits),
      motion_(options.motion, options.side, options.seed), wearer_(options.seed),
      settings_(power_up_settings()) {
  assert(options.rate_hz >= 1.0 && options.rate_hz <= most_rate_hz);
}

CyberGloveUnit::Settings CyberGloveUnit::power_up_settings() const noexcept {
  Settings settings;
  settings.values = static_cast<Byte>(options_.sensors);
  const auto ticks = std::llround(static_cast<double>(tick_hz) / options_.rate_hz);
  settings.period_repeats = ticks > 0xFFFF ? 2 : 1;
  settings.period_ticks = static_cast<std::uint16_t>(ticks / settings.period_repeats);
  return settings;
}

void CyberGloveUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  for (const std::byte byte : bytes)
    obey(std::to_integer<Byte>(byte), now);
}

void CyberGloveUnit::obey(Byte byte, Time now) {
  if (restart_ends_) return; // the firmware is not up yet
  if (stream_header_ != 0) {
    if (byte != stop_byte) return;
    stream_header_ = 0;
    send({stop_byte, 0});
    return;
  }
  if (command_ != 0 && now - command_since_ > patience) command_ = 0;
  if (command_ == 0) {
    begin(byte, now);
  } else if (command_ == '?') {
    command_ = 0;
    answer(byte);
  } else if (is_lower(command_)) {
    collect_text(byte);
  } else {
    collect_binary(byte); // 0x03 included: it is a legal mask byte and a legal count
  }
}

void CyberGloveUnit::begin(Byte letter, Time now) {
  switch (letter) {
  case stop_byte:
  case reread_glove:
    send({letter, 0});
    return;
  case restart_byte:
    restart_ends_ = now + restart_time;
    return;
  case 'G':
  case 'g':
    send_record(letter, now, false);
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
  if (letter != '?' && arguments_of(letter).numbers == 0) {
    send({'e', '?', 0});
    return;
  }
  command_ = letter;
  command_since_ = now;
  argument_.clear();
}

void CyberGloveUnit::collect_binary(Byte byte) {
  argument_.push_back(byte);
  const Arguments wanted = arguments_of(command_);
  if (argument_.size() < wanted.numbers * wanted.width) return;
  set(command_, argument_);
  send({command_, 0});
  command_ = 0;
}

void CyberGloveUnit::collect_text(Byte byte) {
  if (byte == stop_byte) {
    command_ = 0;
    send({stop_byte, 0});
    return;
  }
  if (byte != '\r') {
    if (argument_.size() <= longest_text) argument_.push_back(byte);
    return;
  }
  const Byte letter = to_upper(command_);
  const Arguments wanted = arguments_of(command_);
  const Message numbers = argument_.size() > longest_text
                              ? Message{}
                              : read_numbers(argument_, wanted.numbers, wanted.width);
  if (numbers.empty()) {
    send({'e', 'n', 0});
  } else {
    set(letter, numbers);
    send({command_, 0});
  }
  command_ = 0;
}

void CyberGloveUnit::set(Byte letter, const Message& argument) {
  switch (letter) {
  case 'B':
    settings_.baud = argument[0] & 0x37;
    return; // a pseudo-terminal has no speed
  case 'M':
    settings_.mask = from_low_first(argument);
    return;
  case 'N':
    settings_.values = argument[0];
    return;
  case 'P': {
    const std::uint32_t bits = from_low_first(argument);
    for (const Flag& flag : flags)
      settings_.*flag.value = ((bits >> flag.parameter_bit) & 1U) != 0;
    return;
  }
  case 'T':
    // High byte first: the order of two authors who had the manual, and of the unit's processor.
    // One driver sends the low byte first; careful hosts use the text form.
    settings_.period_ticks = high_first(argument[0], argument[1]);
    settings_.period_repeats = high_first(argument[2], argument[3]);
    return;
  default:
    break;
  }
  for (const Flag& flag : flags) {
    if (flag.letter == letter) settings_.*flag.value = argument[0] != 0;
  }
  if (letter == 'W' && settings_.switch_drives_light) settings_.light = settings_.switch_on;
}

std::uint32_t CyberGloveUnit::parameters() const noexcept {
  constexpr std::uint32_t plugged_in = 1U << 0U;
  constexpr std::uint32_t always = 1U << 7U;
  constexpr std::uint32_t right_hand = 1U << 14U;
  constexpr std::uint32_t valid = 1U << 15U;
  std::uint32_t bits =
      plugged_in | always | valid | (options_.side == Side::right ? right_hand : 0);
  for (const Flag& flag : flags) {
    if (settings_.*flag.value) bits |= 1U << flag.parameter_bit;
  }
  return bits;
}

void CyberGloveUnit::answer(Byte letter) {
  const auto data = lookup(letter);
  if (!data) {
    send({'e', '?', 0});
    return;
  }
  Message message{'?', letter};
  message.insert(message.end(), data->begin(), data->end());
  message.push_back(0);
  send(message);
}

std::optional<Message> CyberGloveUnit::lookup(Byte letter) const {
  const bool right = options_.side == Side::right;
  const std::string sensors = std::to_string(options_.sensors);
  Message text;
  switch (letter) {
  case 'B':
    return Message{settings_.baud};
  case 'G':
    return Message{3}; // initialised and connected
  case 'K':
    return low_first(hardware_mask_, 3);
  case 'M':
    return low_first(settings_.mask, 3);
  case 'N':
    return Message{settings_.values};
  case 'P':
    return low_first(parameters(), 3);
  case 'R':
    return Message{static_cast<Byte>(right ? 1 : 0)};
  case 'S':
    return Message{static_cast<Byte>(options_.sensors)};
  case 'T':
    return Message{static_cast<Byte>(settings_.period_ticks >> 8U),
                   static_cast<Byte>(settings_.period_ticks),
                   static_cast<Byte>(settings_.period_repeats >> 8U),
                   static_cast<Byte>(settings_.period_repeats)};
  case 'V':
    return Message{2, 0, 1, 0}; // zeros on purpose: hosts must count bytes, not look for NUL
  case 'v':
    append(text, " 2.1\r\n");
    return text;
  case 'i':
    // A right glove's text begins with CG: one known host tells the hands apart by that.
    append(text, " \r\n" + std::string(right ? "CG" : "LG") + sensors + " CyberGlove, " + sensors +
                     " sensors, " + std::string(name_of(options_.side)) +
                     " hand\r\nemulated by Nendo\r\n");
    return text;
  default:
    break;
  }
  for (const Flag& flag : flags) {
    if (flag.letter == letter) return Message{static_cast<Byte>(settings_.*flag.value ? 1 : 0)};
  }
  return std::nullopt;
}

std::uint64_t CyberGloveUnit::requested_ticks() const noexcept {
  return std::uint64_t{settings_.period_ticks} * settings_.period_repeats;
}

std::uint64_t CyberGloveUnit::least_ticks() const noexcept {
  const auto own =
      static_cast<std::uint64_t>(std::llround(static_cast<double>(tick_hz) / options_.rate_hz));
  return std::min(own, tick_hz / (settings_.filter ? fastest_filtered_hz : fastest_unfiltered_hz));
}

void CyberGloveUnit::start_stream(Byte header, Time now) {
  stream_header_ = header;
  // A product of 0 asks for "as fast as possible".
  period_ = to_time(std::max(requested_ticks(), least_ticks()));
  next_record_ = now + period_;
}

void CyberGloveUnit::advance(Time now) {
  if (restart_ends_ && now >= *restart_ends_) {
    clock_origin_ = *restart_ends_;
    restart_ends_.reset();
    settings_ = power_up_settings();
    send({restart_byte, '\r', '\n', 0});
  }
  if (stream_header_ == 0) return;
  const bool too_fast = requested_ticks() != 0 && requested_ticks() < least_ticks();
  for (; next_record_ <= now; next_record_ += period_) {
    const std::uint64_t refused_before = counters_.bytes_refused;
    send_record(stream_header_, next_record_, too_fast);
    const std::uint64_t refused = counters_.bytes_refused - refused_before;
    if (refused == 0) continue;
    // The output is full: account for all others that are due without making them, however long ago
    // that began.
    const auto others = (now - next_record_) / period_;
    counters_.bytes_refused += refused * static_cast<std::uint64_t>(others);
    next_record_ += others * period_;
  }
}

std::optional<CyberGloveUnit::Time> CyberGloveUnit::next_due() const noexcept {
  if (restart_ends_) return restart_ends_;
  if (stream_header_ != 0) return next_record_;
  return std::nullopt;
}

// What a record holds between its header and its end. No byte is 0, so that NUL marks the end and
// nothing else.
CyberGloveUnit::Message CyberGloveUnit::fields(Time now) {
  if (!motion_origin_) motion_origin_ = now; // what the first host sees is the same every time
  const auto raw =
      wearer_.counts(motion_.at(std::chrono::duration<double>(now - *motion_origin_).count()));
  Message fields;
  const std::uint32_t enabled = hardware_mask_ & settings_.mask;
  for (std::size_t k = 0; k < sensor_slots && fields.size() < settings_.values; ++k) {
    if (((enabled >> k) & 1U) != 0) fields.push_back(static_cast<Byte>(raw[k].value));
  }
  if (settings_.time_stamp) {
    // Bit k of the first byte: byte k was 0 and goes as 1. Bit 7 is always set, as the manual has
    // it; without it the first byte itself would often be 0.
    Message stamp = low_first(static_cast<std::uint32_t>(to_ticks(now - clock_origin_)), 4);
    Byte replaced = 0x80;
    for (unsigned k = 0; k < 4; ++k) {
      if (stamp[k] != 0) continue;
      stamp[k] = 1;
      replaced = static_cast<Byte>(replaced | (1U << k));
    }
    fields.push_back(replaced);
    fields.insert(fields.end(), stamp.begin(), stamp.end());
  }
  if (settings_.status_byte) fields.push_back(static_cast<Byte>(parameters()));
  return fields;
}

void CyberGloveUnit::send_record(Byte header, Time now, bool too_fast) {
  const Message data = fields(now);
  Message record{header};
  if (is_lower(header)) {
    for (const Byte field : data)
      append(record, " " + std::to_string(field));
    append(record, "\r\n");
  } else {
    record.insert(record.end(), data.begin(), data.end());
  }
  if (too_fast) append(record, "es");
  record.push_back(0);
  if (send(record)) ++counters_.records;
}

bool CyberGloveUnit::send(const Message& message) {
  return EmulatedUnit::send(std::as_bytes(std::span(message)));
}

} // namespace nendo::driver
