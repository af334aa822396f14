#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include <nendo/base/text.hpp>

#include "drivers.hpp"
#include "flock/flock_dialogue.hpp"
#include "flock/flock_parser.hpp"
#include "flock/flock_protocol.hpp"
#include "stream/line_times.hpp"
#include "stream/listen.hpp"
#include "stream/stream_tracker.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::flock {
namespace {

/// Longer than open_budget, because opening a port can reset the units, which takes 2 s.
constexpr std::chrono::milliseconds flock_budget{4700};

class FlockProtocol final : public TrackerProtocol {
public:
  explicit FlockProtocol(Options options)
      : options_(std::move(options)), baud_(options_.baud.value_or(bauds.front())) {}

  Result<TrackerInfo> identify(Transport& transport, const std::string& source,
                               IdentifyReason reason, const ReplyDeadline& limit) override {
    Dialogue dialogue(transport, limit);
    const auto identity = dialogue.identify(source, options_, baud_);
    parser_.count_discarded(dialogue.bytes_received());
    if (!identity) return identity.error();
    baud_ = identity->baud;
    step_m_ = identity->range_in * inch_m / full_scale;
    cycle_hz_ = identity->rate_hz;
    birds_ = identity->birds;
    if (reason == IdentifyReason::opening && identity->error != 0)
      spdlog::warn("device: {}: the tracker reports the error {}: {}", source, identity->error,
                   meaning_of_error(identity->error));
    return describe(*identity);
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& limit) override {
    Dialogue dialogue(transport, limit);
    dialogue.send({run_command}); // end_stream() made it sleep
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset();
    times_ = LineTimes(baud_, birds_.size() * record_bytes, cycle_hz_);
    dialogue.send({stream_command});
    return dialogue.is_gone() ? Result<void>(went_away(source)) : Result<void>();
  }

  void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept override {
    Dialogue dialogue(transport, limit);
    dialogue.stop_stream();
    dialogue.send({sleep_command});
    parser_.count_discarded(dialogue.bytes_received());
  }

  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    const std::uint64_t end = parser_.counters().bytes + chunk.size();
    const auto take = [&](const Record& record) {
      PoseSample sample;
      sample.station = record.station;
      for (std::size_t k = 0; k < 3; ++k)
        sample.position_m[k] = record.position[k] * step_m_;
      // The record turns the transmitter's axes to the receiver's; a pose is the inverse [V].
      const auto& q = record.quaternion;
      sample.turn_xyzw = {-q[1] / full_scale, -q[2] / full_scale, -q[3] / full_scale,
                          q[0] / full_scale};
      sample.measured = times_.in_order(
          times_.record_begin(arrival, later_than_cycle(record, end - parser_.counters().bytes)));
      sink.deliver(sample);
    };
    parser_.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  /// The birds measure at the same time, and their records follow each other. Returns how many
  /// bytes came after the last bird's record of this cycle, if `later` came after this one;
  /// modulo 2^64, as LineTimes adds the bytes of a cycle.
  std::uint64_t later_than_cycle(const Record& record, std::uint64_t later) const noexcept {
    const auto bird = std::find(birds_.begin(), birds_.end(), record.station);
    const auto next = bird == birds_.end() ? bird : bird + 1;
    return later - record_bytes * static_cast<std::uint64_t>(birds_.end() - next);
  }
  TrackerInfo describe(const Identity& identity) const {
    std::string birds;
    for (const std::uint16_t bird : identity.birds)
      birds += (birds.empty() ? "" : ", ") + std::to_string(bird);
    TrackerInfo info;
    info.model = "Ascension Flock of Birds, " + std::to_string(identity.birds.size()) +
                 (identity.birds.size() == 1 ? " bird" : " birds");
    info.stations = options_.stations;
    info.rate_hz = cycle_hz_ * static_cast<double>(birds_.size());
    info.stage_from_tracker_xyzw = stage_from_z_down_xyzw;
    info.facts = {{"identification", identity.model},
                  {"firmware", identity.firmware},
                  {"birds", birds},
                  {"range_m", decimal_text(identity.range_in * inch_m)},
                  {"rate_hz", decimal_text(identity.rate_hz)},
                  {"error", std::string(meaning_of_error(identity.error))},
                  {"baud", std::to_string(identity.baud)},
                  {"hemisphere", std::string(options_.hemisphere.name)}};
    return info;
  }

  const Options options_;
  int baud_; ///< the one that was answered, or the first to try
  double step_m_ = 0.0;
  double cycle_hz_ = 0.0; ///< records of each bird per second
  std::vector<std::uint16_t> birds_;
  Parser parser_;
  LineTimes times_;
};

Result<Hemisphere> hemisphere_option(const DeviceSpec& spec) {
  const auto name =
      word_option(spec, "hemisphere", {"forward", "aft", "right", "left", "lower", "upper"});
  if (!name) return name.error();
  return *std::find_if(hemispheres.begin(), hemispheres.end(),
                       [&](const Hemisphere& half) { return half.name == *name; });
}

} // namespace

Result<std::unique_ptr<Tracker>> open_flock(const DeviceSpec& spec,
                                            std::span<const std::uint16_t> stations) {
  if (const auto known = allow_options(spec, {"station", "baud", "hemisphere"}); !known)
    return known.error();
  Options options;
  options.stations.assign(stations.begin(), stations.end());
  if (std::any_of(stations.begin(), stations.end(),
                  [](std::uint16_t station) { return station > max_address; }))
    return Error{Errc::usage, spec.text + ": option station must be 1 to 14"};
  if (spec.options.count("baud") > 0) {
    const auto baud = number_option(spec, "baud", {115'200, 57'600, 38'400, 19'200, 9'600});
    if (!baud) return baud.error();
    options.baud = *baud;
  }
  const auto hemisphere = hemisphere_option(spec);
  if (!hemisphere) return hemisphere.error();
  options.hemisphere = *hemisphere;
  if (auto named = require_port(spec, "flock:/dev/ttyUSB2?station=1"); !named) return named.error();
  // RTS, which an opened port has high, holds the units in reset.
  const auto open_port = [open = follow_port(spec.target, options.baud.value_or(bauds.front()))] {
    auto transport = open();
    if (transport) (*transport)->set_rts(false);
    return transport;
  };
  return open_stream_tracker(spec.text, open_port, std::make_unique<FlockProtocol>(options),
                             HostClock::now() + flock_budget);
}

} // namespace nendo::driver::flock
