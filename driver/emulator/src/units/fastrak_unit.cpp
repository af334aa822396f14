// Chosen where the manual's facts say nothing: P is answered at once, with the last solution of
// each station; a solution is dropped if the record before it is still on the line; the stylus
// belongs to station 1; receivers that are pulled out give nonsense with the letter k; an external
// synchronisation runs at the unit's own rate, and a video coil is never found; the adaptive
// filters are kept and not applied; the text of the built-in test.

#include "units/fastrak_unit.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "units/fastrak_records.hpp"

namespace nendo::emulator::fastrak {

namespace {

constexpr std::uint8_t restart_command = 0x19; // ^Y
constexpr std::uint8_t save_command = 0x0B;    // ^K
constexpr std::uint8_t resume_command = 0x11;  // ^Q
constexpr std::uint8_t pause_command = 0x13;   // ^S
constexpr std::size_t max_command = 160;
constexpr double noise_cm = 0.08;
constexpr double noise_deg = 0.15;
constexpr double video_coil = 2.0;

constexpr std::int64_t second_ns = 1'000'000'000;

} // namespace

FastrakUnit::FastrakUnit(const FastrakUnitOptions& options)
    : options_(options), saved_(factory_settings()), line_(options.baud), random_(options.seed) {
  assert(options.baud > 0 && options.restart_s >= 0.0);
  power_up();
}

Settings FastrakUnit::factory_settings() const {
  Settings settings;
  for (std::size_t k = 0; k < max_stations; ++k)
    settings.stations[k].on = options_.plugged[k];
  return settings;
}

void FastrakUnit::power_up() {
  settings_ = saved_;
  for (std::size_t k = 0; k < max_stations; ++k)
    settings_.stations[k].on = options_.plugged[k];
  streaming_ = false;
  waited_.reset();
  errors_.fill(' ');
}

void FastrakUnit::begin_restart(Time now) {
  line_.clear();
  command_.clear();
  streaming_ = false;
  restart_ends_ = now + from_seconds(options_.restart_s);
}

void FastrakUnit::receive(std::span<const std::byte> bytes, Time now) {
  advance(now);
  for (const std::byte byte : bytes) {
    if (restart_ends_) return; // it hears nothing
    hear(std::to_integer<Byte>(byte), now);
  }
}

void FastrakUnit::hear(Byte byte, Time now) {
  switch (byte) {
  case restart_command:
    begin_restart(now);
    return;
  case resume_command:
  case pause_command:
    line_.pause(byte == pause_command);
    return;
  default:
    break;
  }
  if (!command_.empty()) {
    hear_parameter(byte, now);
  } else if (takes_parameters(byte)) {
    command_ = static_cast<char>(byte);
  } else if (!act_at_once(byte, now)) {
    reply(error_answer(std::string_view(reinterpret_cast<const char*>(&byte), 1), Wrong::unknown),
          now);
  }
}

void FastrakUnit::hear_parameter(Byte byte, Time now) {
  if (byte == '\n') return;
  if (byte != '\r') {
    if (command_.size() <= max_command) command_ += static_cast<char>(byte);
    return;
  }
  const std::string command = std::exchange(command_, {});
  const std::string answer = command.size() > max_command
                                 ? error_answer(command, Wrong::too_long, max_command)
                                 : carry_out(command, settings_, receivers(now));
  if (waited_ && !settings_.stations[*waited_].on) waited_.reset();
  reply(answer, now);
}

/// Carries out a command without parameters. Returns false if there is no such command.
bool FastrakUnit::act_at_once(Byte letter, Time now) {
  switch (letter) {
  case 'P':
    poll(now);
    return true;
  case 'C':
    start_stream(now);
    return true;
  case 'c':
    streaming_ = false;
    return true;
  case 'F':
  case 'f':
    settings_.binary = letter == 'f';
    return true;
  case 'U':
  case 'u':
    settings_.centimetres = letter == 'u';
    return true;
  case 'S':
    send_status(now);
    return true;
  case 'T':
    test(now);
    return true;
  case 'W':
    settings_ = factory_settings();
    return true;
  case save_command:
    saved_ = settings_;
    if (saved_.synchronisation[0] == 1.0) saved_.synchronisation[0] = 0.0;
    return true;
  case '\r':
  case '\n':
  case ' ':
    return true;
  default:
    return false;
  }
}

void FastrakUnit::reply(std::string_view text, Time now) {
  if (text.empty()) return;
  unit::Message message(text.begin(), text.end());
  const std::size_t bytes = message.size();
  if (!line_.put(std::move(message), false, now)) counters_.bytes_refused += bytes;
}

void FastrakUnit::send_status(Time now) {
  constexpr unsigned all_off = 0x3F0;
  const unsigned flags = all_off | (settings_.binary ? 1U : 0U) |
                         (settings_.centimetres ? 2U : 0U) | (streaming_ ? 8U : 0U);
  unsigned map = 0;
  for (std::size_t k = 0; k < max_stations; ++k)
    map |= options_.plugged[k] ? 1U << k : 0U;
  const auto error = std::find_if(errors_.begin(), errors_.end(), [](char c) { return c != ' '; });
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "21S%03X%c   F3%X  %-6s%-32s\r\n", flags,
                error == errors_.end() ? ' ' : *error, map, "02.014", "FASTRAK emulated by Nendo");
  reply(text.data(), now);
}

void FastrakUnit::test(Time now) {
  std::string found;
  for (std::size_t k = 0; k < max_stations; ++k)
    if (errors_[k] != ' ') found += {' ', static_cast<char>('1' + k), errors_[k]};
  errors_.fill(' ');
  reply(found.empty() ? "2 T000 PASSED\r\n" : "2 T001 CLEARED" + found + "\r\n", now);
}

// The stations measured one after another, the last one just now.
void FastrakUnit::poll(Time now) {
  const auto active = static_cast<std::uint64_t>(
      std::count_if(settings_.stations.begin(), settings_.stations.end(),
                    [](const StationSettings& station) { return station.on; }));
  std::uint64_t cycle = last_cycle(now) + 1 - std::min(active, last_cycle(now) + 1);
  for (std::size_t k = 0; k < max_stations; ++k) {
    if (!settings_.stations[k].on) continue;
    unit::Message message = record(k, settings_.stations[k].reported(measured(k, ready(cycle++))));
    const std::size_t bytes = message.size();
    if (!line_.put(std::move(message), true, now)) counters_.bytes_refused += bytes;
  }
}

void FastrakUnit::start_stream(Time now) {
  if (streaming_) return;
  streaming_ = true;
  next_cycle_ = last_cycle(now) + 1;
  turn_ = 0;
  waited_.reset();
  last_sent_cm_.fill(std::nullopt);
}

void FastrakUnit::press(bool pressed, Time now) {
  button_ = pressed;
  if (!pressed || settings_.stations[0].button_output[0] == 0.0) return;
  if (streaming_) {
    streaming_ = false;
  } else {
    start_stream(now);
  }
}

void FastrakUnit::inject(const Incident& incident, Time now) {
  advance(now);
  switch (incident.kind) {
  case Incident::Kind::glove_out:
  case Incident::Kind::glove_in:
    receivers_out_ = incident.kind == Incident::Kind::glove_out;
    return;
  case Incident::Kind::power_cycle:
    begin_restart(now);
    return;
  case Incident::Kind::switch_on:
  case Incident::Kind::switch_off:
    press(incident.kind == Incident::Kind::switch_on, now);
    return;
  case Incident::Kind::tracker_error:
    for (std::size_t k = 0; k < max_stations; ++k)
      if (incident.station == k + 1 || (incident.station == 0 && options_.plugged[k]))
        errors_[k] = incident.letter;
    return;
  case Incident::Kind::sensor_stuck:
  case Incident::Kind::sensor_free:
    return;
  }
}

FastrakUnit::Time FastrakUnit::ready(std::uint64_t cycle) const noexcept {
  return origin_.value_or(Time{}) +
         Time(static_cast<std::int64_t>(cycle) * second_ns / static_cast<std::int64_t>(cycles_hz));
}

std::uint64_t FastrakUnit::last_cycle(Time now) const noexcept {
  const std::int64_t since_ns = (now - origin_.value_or(now)).count();
  auto cycle = static_cast<std::uint64_t>(since_ns / second_ns) * cycles_hz +
               static_cast<std::uint64_t>(since_ns % second_ns) * cycles_hz / second_ns;
  if (ready(cycle + 1) <= now) ++cycle; // ready() rounds down
  return cycle;
}

void FastrakUnit::advance(Time now) {
  if (!origin_) origin_ = now;
  for (auto due = next_due(); due && *due <= now; due = next_due())
    do_due(*due);
}

std::optional<EmulatedUnit::Time> FastrakUnit::next_due() const noexcept {
  if (restart_ends_) return restart_ends_;
  auto due = line_.next_due();
  if (streaming_) due = std::min(due.value_or(Time::max()), ready(next_cycle_));
  return due;
}

void FastrakUnit::do_due(Time now) {
  if (restart_ends_) {
    restart_ends_.reset();
    power_up();
    return;
  }
  while (const auto passed = line_.take(now)) {
    const auto bytes = std::as_bytes(std::span(passed->bytes));
    passed->is_record ? send_record(bytes) : send(bytes);
  }
  if (streaming_ && ready(next_cycle_) <= now) {
    ++next_cycle_;
    run_cycle(now);
  }
}

// The order of stations is kept: after a dropped solution, the unit waits for the next one of the
// same station.
void FastrakUnit::run_cycle(Time now) {
  std::array<std::size_t, max_stations> active{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < max_stations; ++k)
    if (settings_.stations[k].on) active[count++] = k;
  if (count == 0) return;
  const std::size_t station = active[turn_ % count];
  turn_ = (turn_ + 1) % count;
  if (settings_.synchronisation[0] == video_coil) errors_[station] = 'v';
  if (receivers_out_) errors_[station] = 'k';
  if (waited_ && *waited_ != station) return;
  if (line_.is_free(now)) {
    waited_.reset();
    send_solution(station, now);
  } else {
    waited_ = station;
  }
}

void FastrakUnit::send_solution(std::size_t station, Time now) {
  const StationSettings& settings = settings_.stations[station];
  const StationPose reported = settings.reported(measured(station, now));
  auto& last_cm = last_sent_cm_[station];
  if (last_cm) {
    const Vector3 moved = difference(reported.position_cm, *last_cm);
    if (dot(moved, moved) < settings.increment_cm[0] * settings.increment_cm[0]) return;
  }
  last_cm = reported.position_cm;
  line_.put(record(station, reported), true, now); // the line is free: it fits
}

StationPose FastrakUnit::measured(std::size_t station, Time ready) {
  if (receivers_out_) return nonsense();
  const Time since = std::max<Time>(ready - solution_delay - origin_.value_or(Time{}), Time{});
  const auto pose =
      driver::receiver_pose(options_.motion, static_cast<std::uint16_t>(station + 1), options_.seed,
                            std::chrono::duration<double>(since).count());
  StationPose result{scaled({pose.position_m[0], pose.position_m[1], pose.position_m[2]}, 100.0),
                     from_quaternion(pose.turn_xyzw)};
  if (!options_.noise) return result;
  std::normal_distribution<double> normal;
  const auto some = [&](double size) -> Vector3 {
    return {size * normal(random_), size * normal(random_), size * normal(random_)};
  };
  result.position_cm = sum(result.position_cm, some(noise_cm));
  result.attitude = product(result.attitude, from_euler_deg(some(noise_deg)));
  return result;
}

StationPose FastrakUnit::nonsense() {
  constexpr double reach_cm = 150.0;
  constexpr double half_turn_deg = 180.0;
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  const auto some = [&](double size) -> Vector3 {
    return {size * part(random_), size * part(random_), size * part(random_)};
  };
  const Vector3 position = some(reach_cm);
  return {position, from_euler_deg(some(half_turn_deg))};
}

Receivers FastrakUnit::receivers(Time now) {
  return {options_.plugged,
          [this, now](std::size_t station) { return measured(station, ready(last_cycle(now))); }};
}

unit::Message FastrakUnit::record(std::size_t station, const StationPose& reported) const {
  const RecordContent content{station, errors_[station], reported, station == 0 && button_};
  return data_record(content, settings_.stations[station].items, settings_.binary,
                     settings_.unit_cm());
}

} // namespace nendo::emulator::fastrak
