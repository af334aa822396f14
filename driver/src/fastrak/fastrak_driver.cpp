#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include "drivers.hpp"
#include "fastrak/fastrak_identity.hpp"
#include "fastrak/fastrak_parser.hpp"
#include "fastrak/fastrak_protocol.hpp"
#include "stream/line_times.hpp"
#include "stream/stream_tracker.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::fastrak {
namespace {

using namespace std::chrono_literals;

constexpr auto stop_quiet = 50ms;
constexpr auto max_stop = 250ms;

class FastrakProtocol final : public TrackerProtocol {
public:
  explicit FastrakProtocol(Options options)
      : options_(std::move(options)), baud_(options_.baud.value_or(bauds.front())) {
    parser_.expect(options_.stations);
  }

  Result<TrackerInfo> identify(Transport& transport, const std::string& source,
                               IdentifyReason reason, const ReplyDeadline& limit) override {
    TextDialogue dialogue(transport, limit);
    const auto identity = fastrak::identify(transport, dialogue, source, options_, baud_);
    parser_.count_discarded(dialogue.bytes_received());
    if (!identity) return identity.error();
    baud_ = identity->baud;
    is_fastrak_ = !identity->status.is_intersense;
    source_ = source;
    if (reason == IdentifyReason::opening && !identity->refusals.empty())
      spdlog::warn("device: {}: the tracker refuses {}", source, identity->refusals);
    return describe(*identity);
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& limit) override {
    TextDialogue dialogue(transport, limit);
    dialogue.send(binary_command);
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset();
    times_ = LineTimes(baud_, record_bytes, is_fastrak_ ? records_per_second : 0.0);
    dialogue.send(stream_command);
    return dialogue.is_gone() ? Result<void>(went_away(source)) : Result<void>();
  }

  void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept override {
    TextDialogue dialogue(transport, limit);
    dialogue.send(stop_command);
    dialogue.fall_quiet(stop_quiet, max_stop);
    dialogue.send(text_command);
    parser_.count_discarded(dialogue.bytes_received());
  }

  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    const std::uint64_t end = parser_.counters().bytes + chunk.size();
    const auto take = [&](const Record& record) {
      note_error(record);
      PoseSample sample;
      sample.station = record.station;
      sample.position_m = record.position_m;
      sample.turn_xyzw = record.turn_xyzw;
      sample.error = record.error;
      const HostTime begin = times_.record_begin(arrival, end - parser_.counters().bytes);
      sample.measured = times_.in_order(begin - solution_delay);
      sink.deliver(sample);
    };
    parser_.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  TrackerInfo describe(const Identity& identity) const {
    const Status& status = identity.status;
    TrackerInfo info;
    info.model = (status.is_intersense ? "InterSense, as " : "Polhemus ") + std::string("FASTRAK");
    info.stations = options_.stations;
    if (is_fastrak_) info.rate_hz = records_per_second;
    info.stage_from_tracker_xyzw = stage_from_z_down_xyzw;
    info.is_filtered = options_.is_filtered;
    info.facts = {{"firmware", status.firmware},
                  {"identification", status.identification},
                  {"stations_plugged_in", identity.plugged_in},
                  {"error", status.error.empty() ? "none" : status.error},
                  {"baud", std::to_string(identity.baud)},
                  {"filter", options_.is_filtered ? "on" : "off"}};
    if (!identity.refusals.empty()) info.facts.push_back({"refused_commands", identity.refusals});
    return info;
  }

  /// Each letter of a station once: it stays in all records after.
  void note_error(const Record& record) noexcept {
    if (record.error == std::exchange(errors_[record.station], record.error)) return;
    if (record.error == ' ') return;
    spdlog::warn("device: {}: station {} reports the error {}: {}", source_, record.station,
                 record.error, meaning_of_error(record.error));
  }

  const Options options_;
  std::string source_;
  int baud_; ///< the one that was answered, or the first to try
  bool is_fastrak_ = true;
  Parser parser_;
  LineTimes times_;
  std::array<char, max_stations + 1> errors_ = all_blank(); ///< the last letter of each station

  static std::array<char, max_stations + 1> all_blank() noexcept {
    std::array<char, max_stations + 1> blanks;
    blanks.fill(' ');
    return blanks;
  }
};

} // namespace

Result<std::unique_ptr<Tracker>> open_fastrak(const DeviceSpec& spec,
                                              std::span<const std::uint16_t> stations) {
  auto options = polhemus::options_of(spec, stations, {115'200, 57'600, 38'400, 19'200, 9'600});
  if (!options) return options.error();
  if (*std::max_element(stations.begin(), stations.end()) > max_stations)
    return Error{Errc::usage, spec.text + ": option station must be 1 to 4"};
  if (const auto why = options->baud ? too_slow(*options->baud) : std::nullopt)
    return Error{Errc::usage, spec.text + ": " + *why};
  const int baud = options->baud.value_or(bauds.front());
  return open_stream_tracker(spec.text, follow_port(spec.target, baud),
                             std::make_unique<FastrakProtocol>(*std::move(options)),
                             HostClock::now() + open_budget);
}

} // namespace nendo::driver::fastrak
