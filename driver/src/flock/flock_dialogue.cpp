#include "flock/flock_dialogue.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include <nendo/base/text.hpp>

#include "stream/listen.hpp"

namespace nendo::driver::flock {
namespace {

using namespace std::chrono_literals;

constexpr auto write_timeout = 100ms;
constexpr auto answer_time = 150ms; ///< short at first, because most attempts get no answer
constexpr auto quiet_time = 60ms;   ///< more than any gap within an answer
constexpr int known_patience = 3;
constexpr auto max_drain = 500ms; ///< max time for what a stream left in line and buffers
/// A unit that RTS had held in reset answers after 2 s [V].
constexpr auto max_search = 2700ms;
/// Before and after configure_parameter [A: 0.6 s].
constexpr auto configure_quiet = 800ms;
constexpr int max_configurations = 2; ///< bytes of noise in the quiet spoil one
constexpr double bits_per_byte = 10.0;

std::string list_of(const std::vector<std::uint16_t>& stations) {
  std::string list;
  for (const std::uint16_t station : stations)
    list += (list.empty() ? "" : ", ") + std::to_string(station);
  return list.empty() ? "none" : list;
}

bool is_running(std::uint8_t state) noexcept {
  return (state & accessible_bit) == 0 || (state & running_bit) != 0;
}

/// Attempts after which baud_of_attempt() has returned each rate.
constexpr std::size_t all_rates = 3 * (bauds.size() - 2);

/// Most attempts use the first rate and the usual one, since units may not hear during a reset.
int baud_of_attempt(std::size_t attempt, int first) noexcept {
  const int second = first == bauds[0] ? bauds[1] : bauds[0];
  if (attempt % 3 == 0) return first;
  if (attempt % 3 == 1) return second;
  std::array<int, bauds.size()> others{};
  const auto end = std::copy_if(bauds.begin(), bauds.end(), others.begin(),
                                [&](int baud) { return baud != first && baud != second; });
  return others[attempt / 3 % static_cast<std::size_t>(end - others.begin())];
}

unsigned word_of(const std::vector<std::uint8_t>& bytes) noexcept {
  return bytes[0] + 256U * bytes[1];
}

Result<void> check_line(const std::string& source, const Identity& identity) {
  const double needed =
      record_bytes * identity.rate_hz * static_cast<double>(identity.birds.size());
  const double carried = identity.baud / bits_per_byte;
  if (needed <= carried) return {};
  const auto whole = [](double value) { return std::to_string(std::lround(value)); };
  return Error{Errc::usage, source + ": " + std::to_string(identity.birds.size()) + " birds at " +
                                whole(identity.rate_hz) + " Hz need " + whole(needed) +
                                " bytes per second, and " + std::to_string(identity.baud) +
                                " baud carries " + whole(carried) +
                                "; set the switches at the back to 38400 baud or more"};
}

} // namespace

void Dialogue::send(std::initializer_list<std::uint8_t> bytes) noexcept {
  const auto status =
      transport_.write_all(std::as_bytes(std::span(bytes.begin(), bytes.size())), write_timeout);
  gone_ = gone_ || status == IoStatus::gone;
}

/// Throws bytes away until none came for quiet_time. Returns false if they never stopped.
bool Dialogue::fall_quiet(HostClock::duration max_time) noexcept {
  const HostTime until = HostClock::now() + max_time;
  while (HostClock::now() < until && !gone_) {
    const IoStatus heard =
        listen(transport_, limit_, patience_ * quiet_time, [&](std::span<const std::byte> chunk) {
          received_ += chunk.size();
          return true;
        });
    gone_ = gone_ || heard == IoStatus::gone;
    if (heard != IoStatus::done) return true;
  }
  return false;
}

void Dialogue::wait(HostClock::duration time) noexcept {
  const IoStatus heard =
      listen(transport_, limit_, std::chrono::ceil<std::chrono::milliseconds>(time),
             [&](std::span<const std::byte> chunk) {
               received_ += chunk.size();
               return false;
             });
  gone_ = gone_ || heard == IoStatus::gone;
}

bool Dialogue::stop_stream() noexcept {
  send({point_command});
  return fall_quiet(max_drain);
}

/// Returns the answer if it has exactly this length.
std::optional<Dialogue::Answer> Dialogue::examine(std::uint8_t parameter, std::size_t bytes) {
  Answer answer;
  send({examine_command, parameter});
  const IoStatus heard =
      listen(transport_, limit_, patience_ * answer_time, [&](std::span<const std::byte> chunk) {
        received_ += chunk.size();
        for (const std::byte byte : chunk)
          answer.push_back(std::to_integer<std::uint8_t>(byte));
        return answer.size() >= bytes;
      });
  gone_ = gone_ || heard == IoStatus::gone;
  if (answer.size() != bytes) return std::nullopt;
  return answer;
}

/// The mode of addressing determines the length of the answer, so it ends with silence.
std::optional<Dialogue::Answer> Dialogue::ask_units() {
  Answer answer;
  const auto take = [&](std::span<const std::byte> chunk) {
    received_ += chunk.size();
    for (const std::byte byte : chunk)
      answer.push_back(std::to_integer<std::uint8_t>(byte));
    return true;
  };
  send({examine_command, units_parameter});
  IoStatus heard = listen(transport_, limit_, patience_ * answer_time, take);
  while (heard == IoStatus::done && answer.size() <= units_bytes.back())
    heard = listen(transport_, limit_, patience_ * quiet_time, take);
  gone_ = gone_ || heard == IoStatus::gone;
  const bool fits =
      std::find(units_bytes.begin(), units_bytes.end(), answer.size()) != units_bytes.end();
  // The first unit is the one that answers.
  if (!fits || (answer.front() & accessible_bit) == 0) return std::nullopt;
  return answer;
}

bool Dialogue::find(const Options& options, Identity& identity) {
  const int first = identity.baud;
  const HostTime until = std::min(HostClock::now() + max_search, limit_.deadline);
  for (std::size_t attempt = 0; HostClock::now() < until; ++attempt) {
    if (gone_ || limit_.cancelled.stop_requested()) return false;
    patience_ = 1 + static_cast<int>(attempt / (options.baud ? 3 : all_rates));
    identity.baud = options.baud.value_or(baud_of_attempt(attempt, first));
    transport_.set_baud(identity.baud);
    if (!stop_stream()) continue;
    if (const auto units = ask_units()) {
      unit_states_ = *units;
      patience_ = known_patience;
      return true;
    }
  }
  return false;
}

Error Dialogue::stranger(const std::string& source, const Options& options) const {
  const std::string rates = options.baud ? std::to_string(*options.baud) : "any of its baud rates";
  if (received_ == 0)
    return {Errc::no_device, source + ": no answer at " + rates +
                                 "; is the tracker switched on, and at fly, is this its port, and "
                                 "is baud right?"};
  return {Errc::no_device, source + ": what is there does not answer like a Flock of Birds at " +
                               rates + "; is this its port, and is baud right?"};
}

/// Units that a sleep command had stopped run again after one byte; others must be configured.
Result<void> Dialogue::start_units(const std::string& source, Identity& identity) {
  const auto all_run = [&] {
    return std::all_of(unit_states_.begin(), unit_states_.end(), is_running);
  };
  const auto ask_again = [&] {
    if (const auto units = ask_units()) unit_states_ = *units;
  };
  for (std::size_t k = 0; k < unit_states_.size() && k < max_address; ++k) {
    if ((unit_states_[k] & accessible_bit) == 0) continue;
    identity.units = k + 1;
    if ((unit_states_[k] & receiver_bit) != 0)
      identity.birds.push_back(static_cast<std::uint16_t>(k + 1));
  }
  if (!all_run()) {
    send({run_command});
    ask_again();
  }
  for (int attempt = 0; attempt < max_configurations && !all_run(); ++attempt) {
    wait(configure_quiet);
    send({change_command, configure_parameter, static_cast<std::uint8_t>(identity.units)});
    wait(configure_quiet);
    ask_again();
    // Units that do not run may have refused point_command.
    const auto error = examine(error_parameter, 1);
    if (error && error->front() != not_initialised && error->front() != transmitter_off)
      identity.error = error->front();
  }
  if (gone_) return went_away(source);
  if (all_run()) return {};
  return Error{Errc::no_device,
               source + ": not all of the " + std::to_string(identity.units) +
                   " units run; are all switched to fly, and their addresses 1, 2, 3 ...?"};
}

void Dialogue::read_facts(Identity& identity) {
  const auto model = examine(model_parameter, 10);
  if (model)
    identity.model = std::string(trimmed(printable(std::string(model->begin(), model->end()))));
  if (const auto revision = examine(revision_parameter, 2))
    identity.firmware = std::to_string((*revision)[0]) + "." + std::to_string((*revision)[1]);
  const auto scale = examine(scale_parameter, 2);
  identity.range_in = scale && word_of(*scale) == 1 ? wide_range_in : usual_range_in;
  if (identity.model.starts_with(controller_model)) identity.range_in = controller_range_in;
  if (const auto rate = examine(rate_parameter, 2)) identity.rate_hz = word_of(*rate) / 256.0;
  if (const auto error = examine(error_parameter, 1); error && error->front() != 0)
    identity.error = error->front();
}

Result<Identity> Dialogue::identify(const std::string& source, const Options& options, int baud) {
  Identity identity;
  identity.baud = baud;
  if (!find(options, identity)) return gone_ ? went_away(source) : stranger(source, options);
  if (const auto started = start_units(source, identity); !started) return started.error();
  for (const std::uint16_t station : options.stations)
    if (std::find(identity.birds.begin(), identity.birds.end(), station) == identity.birds.end())
      return Error{Errc::no_device,
                   source + ": unit " + std::to_string(station) +
                       " has no receiver; units with one: " + list_of(identity.birds)};
  send({change_command, group_parameter, 1});
  for (const std::uint16_t bird : identity.birds) {
    const auto to_bird = static_cast<std::uint8_t>(to_unit_command + bird);
    send({to_bird, position_quaternion_command});
    send({to_bird, hemisphere_command, options.hemisphere.axis, options.hemisphere.sign});
  }
  read_facts(identity);
  if (gone_) return went_away(source);
  if (const auto carried = check_line(source, identity); !carried) return carried.error();
  return identity;
}

} // namespace nendo::driver::flock
