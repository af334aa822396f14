#pragma once
// The questions to a Flock of Birds before its stream, and how it is set up.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "flock/flock_protocol.hpp"
#include "stream/stream_protocol.hpp"

namespace nendo::driver::flock {

struct Options {
  std::vector<std::uint16_t> stations; ///< addresses of birds
  std::optional<int> baud;             ///< nothing: those of bauds are tried
  Hemisphere hemisphere = hemispheres.front();
};

/// What a flock reported, and was set up as.
struct Identity {
  int baud = 0;
  std::vector<std::uint16_t> birds; ///< all units with a receiver, in the order of their records
  std::size_t units = 0;
  std::string model;                ///< that of the first unit, e.g. "6DFOB"
  std::string firmware;             ///< e.g. "3.67"
  double range_in = usual_range_in; ///< full scale of positions
  double rate_hz = 0.0;             ///< records of each bird per second; 0: not reported
  unsigned error = 0;
};

/// One dialogue: it counts what it receives. All functions end at the limit.
class Dialogue {
public:
  Dialogue(Transport& transport, const ReplyDeadline& limit) noexcept
      : transport_(transport), limit_(limit) {}

  /// Finds the flock, at one of the rates from `baud` on, and sets up its birds. Errors: no_device;
  /// usage, if the line is too slow for the birds.
  Result<Identity> identify(const std::string& source, const Options& options, int baud);
  void send(std::initializer_list<std::uint8_t> bytes) noexcept;
  /// Ends a stream. Returns false if bytes still come.
  bool stop_stream() noexcept;
  bool is_gone() const noexcept { return gone_; }
  std::uint64_t bytes_received() const noexcept { return received_; }

private:
  using Answer = std::vector<std::uint8_t>;

  bool find(const Options& options, Identity& identity);
  std::optional<Answer> ask_units();
  std::optional<Answer> examine(std::uint8_t parameter, std::size_t bytes);
  Result<void> start_units(const std::string& source, Identity& identity);
  void read_facts(Identity& identity);
  bool fall_quiet(HostClock::duration max_time) noexcept;
  void wait(HostClock::duration time) noexcept;
  Error stranger(const std::string& source, const Options& options) const;

  Transport& transport_;
  const ReplyDeadline limit_;
  Answer unit_states_; ///< the last answer to units_parameter
  std::uint64_t received_ = 0;
  int patience_ = 1; ///< factor of the times of waiting
  bool gone_ = false;
};

} // namespace nendo::driver::flock
