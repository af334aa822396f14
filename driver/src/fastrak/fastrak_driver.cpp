#include "fastrak/fastrak_driver.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include "drivers.hpp"
#include "fastrak/fastrak_identity.hpp"
#include "fastrak/fastrak_parser.hpp"
#include "fastrak/fastrak_protocol.hpp"
#include "polhemus/pose_stream.hpp"
#include "stream/stream_tracker.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::fastrak {
namespace {

class FastrakProtocol final : public polhemus::PoseStream<Parser> {
public:
  explicit FastrakProtocol(Options options)
      : PoseStream(std::move(options), bauds.front(),
                   {record_bytes, records_per_second, solution_delay}) {
    parser_.expect(options_.stations);
  }

  Result<TrackerInfo> identify(Transport& transport, const std::string& source,
                               IdentifyReason reason, const ReplyDeadline& limit) override {
    TextDialogue dialogue(transport, limit);
    const auto identity = fastrak::identify(transport, dialogue, source, options_, baud_);
    parser_.count_discarded(dialogue.bytes_received());
    if (!identity) return identity.error();
    baud_ = identity->baud;
    facts_.records_per_second = identity->status.is_intersense ? 0.0 : records_per_second;
    source_ = source;
    if (reason == IdentifyReason::opening && !identity->refusals.empty())
      spdlog::warn("device: {}: the tracker refuses {}", source, identity->refusals);
    return describe(*identity);
  }

private:
  std::string_view meaning_of(char letter) const noexcept override {
    return meaning_of_error(letter);
  }
  TrackerInfo describe(const Identity& identity) const {
    const Status& status = identity.status;
    TrackerInfo info;
    info.model = (status.is_intersense ? "InterSense, as " : "Polhemus ") + std::string("FASTRAK");
    info.stations = options_.stations;
    info.rate_hz = facts_.records_per_second;
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
};

} // namespace

std::unique_ptr<TrackerProtocol> make_protocol(Options options) {
  return std::make_unique<FastrakProtocol>(std::move(options));
}

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
                             make_protocol(*std::move(options)), HostClock::now() + open_budget);
}

} // namespace nendo::driver::fastrak
