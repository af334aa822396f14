// Chosen where published facts say nothing: a command for a single unit does not end a stream, as
// VRPN expects, and any other does; a command that cannot be carried out is dropped and sets the
// error; units that are not configured or asleep send no record and set error 29; the status is 0;
// reference frame and alignments are heard and not applied; button bytes are 0. The quiet before
// and after the configuration is 0.6 s on paper; 0.4 s are enough here, because a host's clock and
// line are not exact.

#include "units/flock_unit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>

namespace nendo::emulator::flock {
namespace {

using namespace std::chrono_literals;
using unit::Byte;
using unit::Message;

constexpr auto quiet_time = 400ms;
constexpr auto reset_time = 600ms;
constexpr double usual_rate_hz = 103.3;
constexpr double min_rate_hz = 1.0;
constexpr double max_rate_hz = 144.0;
constexpr double inch_m = 0.0254;
constexpr double noise_in = 0.0018 / inch_m / 1.7320508; // in each axis
constexpr double noise_deg = 0.5 / 1.7320508;

constexpr Byte resume_command = 0x11; // XON
constexpr Byte pause_command = 0x13;  // XOFF
constexpr Byte to_unit = 0xF0;        // + address

enum UnitError : Byte {
  invalid_command = 6,
  no_answer = 13,
  transmitter_off = 29,
  slave_setup = 33
};

/// The bytes of a parameter that can be changed; 0: it cannot.
std::size_t changeable_bytes(Byte parameter) {
  switch (parameter) {
  case 3:
  case 4:
  case 7:
  case 22:
    return 2;
  case 35:
  case 50:
    return 1;
  default:
    return 0;
  }
}

/// The bytes of a command, as far as its first bytes show.
std::size_t command_bytes(const Message& begin) {
  switch (begin.front()) {
  case 'O':
  case 'M':
  case '0':
  case 'A':
    return 2;
  case 'P':
    return begin.size() < 2 ? 2 : 2 + changeable_bytes(begin[1]);
  case 'L':
    return 3;
  case 'r':
  case 'q':
    return 7;
  case 'H':
  case 'J':
    return 13;
  default:
    return 1;
  }
}

bool is_hemisphere(Byte axis, Byte sign) {
  return (axis == 0 || axis == 6 || axis == 12) && sign <= 1;
}

} // namespace

FlockUnit::FlockUnit(const FlockUnitOptions& options)
    : options_(options), line_(options.baud), random_(options.seed) {
  power_up();
}

void FlockUnit::power_up() {
  birds_ = {};
  units_ = 1;
  for (const unsigned address : options_.birds) {
    birds_[address].has_receiver = true;
    units_ = std::max<std::size_t>(units_, address);
  }
  command_.clear();
  addressed_ = 1;
  configured_ = asleep_ = group_ = false;
  configured_at_.reset();
  scale_ = {0, 0};
  filters_ = {0, 0};
  rate_ = unit::low_first(static_cast<std::uint32_t>(std::lround(usual_rate_hz * 256.0)), 2);
  error_ = error_address_ = 0;
  streams_ = 0;
}

void FlockUnit::inject(const Incident& incident, Time now) {
  if (incident.kind != Incident::Kind::power_cycle) return;
  advance(now);
  line_.clear();
  power_up();
  deaf_until_ = now + reset_time;
}

void FlockUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  for (const std::byte byte : bytes) {
    if (deaf_until_) return;
    hear(std::to_integer<Byte>(byte), now);
  }
}

void FlockUnit::hear(Byte byte, Time now) {
  if (command_.empty() && (byte == resume_command || byte == pause_command)) {
    line_.pause(byte == pause_command);
    return;
  }
  note_spoiled_quiet(now);
  if (command_.empty()) quiet_before_ = last_heard_ ? now - *last_heard_ : Time::max();
  if (command_.empty() && byte >= to_unit) {
    addressed_ = byte & 0x0FU;
    last_heard_ = now;
    return;
  }
  command_.push_back(byte);
  if (command_.size() >= command_bytes(command_)) {
    carry_out(now);
    command_.clear();
    addressed_ = 1;
  }
  last_heard_ = now;
}

/// Bytes that come too soon after the configuration spoil it.
void FlockUnit::note_spoiled_quiet(Time now) {
  if (!configured_at_) return;
  if (now - *configured_at_ < quiet_time) {
    configured_ = false;
    error_ = slave_setup;
  }
  configured_at_.reset();
}

void FlockUnit::carry_out(Time now) {
  const bool is_for_one = addressed_ != 1;
  if (addressed_ < 1 || addressed_ > units_) {
    error_ = no_answer;
    error_address_ = static_cast<Byte>(addressed_);
    return;
  }
  if (!is_for_one && command_.front() != '@') streams_ = 0;
  switch (command_.front()) {
  case 'B':
    send_records(now);
    return;
  case '@':
  case 'Q':
    return start_stream(1, now);
  case 'R':
    return start_stream(2, now);
  case 'S':
    return start_stream(8, now);
  case 'T':
    return start_stream(32, now);
  case 'F':
    asleep_ = false;
    return;
  case 'G':
    streams_ = 0;
    asleep_ = true;
    return;
  case 'O':
    return examine(command_[1], now);
  case 'P':
    return change(now);
  case '/':
    line_.clear();
    power_up();
    deaf_until_ = now + reset_time;
    return;
  case 'H':
  case 'J':
  case 'r':
  case 'q':
  case '0':
  case 'A':
    return;
  default:
    return carry_out_for(birds_[addressed_], now);
  }
}

void FlockUnit::carry_out_for(Bird& bird, Time now) {
  const Byte letter = command_.front();
  if (is_format(letter)) {
    bird.format = letter;
  } else if (letter == 'L' && is_hemisphere(command_[1], command_[2])) {
    bird.hemisphere = {command_[1], command_[2]};
  } else if (letter == 'M' && command_[1] <= 1) {
    bird.sends_buttons = command_[1] == 1;
  } else if (letter == 'N') {
    reply({0}, now);
  } else {
    error_ = invalid_command;
  }
}

Message FlockUnit::unit_states() const {
  Message states(max_units, 0);
  for (std::size_t address = 1; address <= units_; ++address) {
    unsigned state = 0x80;
    if (runs()) state |= 0x40U;
    if (birds_[address].has_receiver) state |= 0x20U;
    if (address == 1) state |= 0x01U;
    states[address - 1] = static_cast<Byte>(state);
  }
  return states;
}

void FlockUnit::examine(Byte parameter, Time now) {
  const auto text = [](std::string_view word) { return Message(word.begin(), word.end()); };
  const bool is_controller = options_.has_controller && addressed_ == 1;
  const auto& half = birds_[addressed_].hemisphere;
  switch (parameter) {
  case 0:
    return reply({0, 0}, now);
  case 1:
    return reply({3, 67}, now);
  case 2:
    return reply({25, 0}, now);
  case 3:
    return reply(scale_, now);
  case 4:
    return reply(filters_, now);
  case 7:
    return reply(rate_, now);
  case 10:
    return reply({std::exchange(error_, Byte{0})}, now);
  case 15:
    return reply(text(is_controller ? "6DERC     " : "6DFOB     "), now);
  case 16:
    return reply({error_, error_address_}, now);
  case 19:
    return reply({0}, now);
  case 22:
    return reply({half[0], half[1]}, now);
  case 35:
    return reply({static_cast<Byte>(group_ ? 1 : 0)}, now);
  case 36:
    return reply(unit_states(), now);
  default:
    error_ = invalid_command;
  }
}

void FlockUnit::change(Time now) {
  const Byte parameter = command_[1];
  const Message value(command_.begin() + 2, command_.end());
  const double word = value.empty() ? 0.0 : static_cast<double>(unit::from_low_first(value));
  const bool is_rate = word >= min_rate_hz * 256.0 && word <= max_rate_hz * 256.0;
  if (parameter == 3 && word <= 1.0) {
    scale_ = value;
  } else if (parameter == 4) {
    filters_ = value;
  } else if (parameter == 7 && is_rate) {
    rate_ = value;
  } else if (parameter == 22 && is_hemisphere(value[0], value[1])) {
    birds_[addressed_].hemisphere = {value[0], value[1]};
  } else if (parameter == 35 && word <= 1.0) {
    group_ = word == 1.0;
  } else if (parameter == 50) {
    configure(value.front(), now);
  } else {
    error_ = invalid_command;
  }
}

void FlockUnit::configure(Byte units, Time now) {
  configured_ = units == units_ && quiet_before_ >= quiet_time;
  if (units != units_) {
    error_ = no_answer;
    error_address_ = static_cast<Byte>(units_ + 1);
  } else if (!configured_) {
    error_ = slave_setup;
  }
  asleep_ = false;
  configured_at_ = now;
}

void FlockUnit::reply(Message message, Time now) {
  const std::size_t bytes = message.size();
  if (!line_.put(std::move(message), false, now)) counters_.bytes_refused += bytes;
}

double FlockUnit::range_in() const noexcept {
  if (options_.has_controller) return 144.0;
  return scale_.front() == 1 ? 72.0 : 36.0;
}

FlockUnit::Time FlockUnit::period() const noexcept {
  return Time(std::llround(256e9 / unit::from_low_first(rate_)));
}

void FlockUnit::start_stream(unsigned every, Time now) {
  if (!runs()) {
    error_ = transmitter_off;
    return;
  }
  streams_ = addressed_;
  every_ = every;
  next_cycle_ = now + every_ * period();
}

void FlockUnit::send_records(Time now) {
  if (!runs()) {
    error_ = transmitter_off;
    return;
  }
  const std::size_t only = streams_ != 0 ? streams_ : addressed_;
  for (std::size_t address = 1; address <= units_; ++address) {
    if (!birds_[address].has_receiver || (!group_ && address != only)) continue;
    Message message = record(address, now);
    const std::size_t bytes = message.size();
    if (!line_.put(std::move(message), true, now)) counters_.bytes_refused += bytes;
  }
}

Message FlockUnit::record(std::size_t address, Time now) {
  const Bird& bird = birds_[address];
  Message message = record_values(bird.format, measured(bird, address, now), range_in());
  if (bird.sends_buttons) message.push_back(0);
  if (group_) message.push_back(static_cast<Byte>(address));
  return message;
}

ReceiverInches FlockUnit::measured(const Bird& bird, std::size_t address, Time now) {
  const double time_s = std::chrono::duration<double>(now - origin_.value_or(now)).count();
  const auto pose = driver::receiver_pose(options_.motion, static_cast<std::uint16_t>(address),
                                          options_.seed, time_s);
  ReceiverInches result{scaled(pose.position_m, 1.0 / inch_m), from_quaternion(pose.turn_xyzw)};
  if (options_.noise) {
    std::normal_distribution<double> normal;
    const auto some = [&](double size) -> Vector3 {
      return {size * normal(random_), size * normal(random_), size * normal(random_)};
    };
    result.position_in = sum(result.position_in, some(noise_in));
    result.attitude = product(result.attitude, from_euler_deg(some(noise_deg)));
  }
  // The field is the same at p and -p: the unit reports the one in its half of space.
  const double along = result.position_in[bird.hemisphere[0] / 6U];
  const bool is_other_half = bird.hemisphere[1] == 0 ? along < 0.0 : along > 0.0;
  if (is_other_half) result.position_in = scaled(result.position_in, -1.0);
  return result;
}

std::optional<EmulatedUnit::Time> FlockUnit::next_due() const noexcept {
  if (deaf_until_) return deaf_until_;
  auto due = line_.next_due();
  if (streams_ != 0) due = std::min(due.value_or(Time::max()), next_cycle_);
  return due;
}

void FlockUnit::advance(Time now) {
  if (!origin_) origin_ = now;
  for (auto due = next_due(); due && *due <= now; due = next_due()) {
    if (deaf_until_) {
      deaf_until_.reset();
      continue;
    }
    while (const auto passed = line_.take(*due)) {
      const auto bytes = std::as_bytes(std::span(passed->bytes));
      passed->is_record ? send_record(bytes) : send(bytes);
    }
    if (streams_ != 0 && next_cycle_ <= *due) {
      send_records(next_cycle_);
      next_cycle_ += every_ * period();
    }
  }
}

} // namespace nendo::emulator::flock
