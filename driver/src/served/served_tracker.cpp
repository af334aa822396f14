// The station of a tracker that `nendo serve` shares, see served_protocol.hpp.

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "drivers.hpp"
#include "served/served_dialogue.hpp"
#include "stream/stream_tracker.hpp"

namespace nendo::driver::served {
namespace {

class ServedTrackerProtocol final : public TrackerProtocol {
public:
  ServedTrackerProtocol(ServePlace place, std::uint16_t station)
      : dialogue_(std::move(place)), station_(station) {}

  Result<TrackerInfo> identify(Transport& transport, const std::string& source,
                               IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    if (auto asked = dialogue_.ask(transport, limit); !asked) return asked.error();
    auto line = device_of(dialogue_.trackers(), dialogue_.place().hand, source, "tracker");
    if (!line) return line.error();
    tracker_ = {WantedDevice::Kind::tracker, line->index};
    TrackerInfo info = std::move(line->info);
    info.rate_hz /= static_cast<double>(info.stations.size());
    info.stations = {station_};
    info.shared_source = info.source;
    info.shared_station = line->station;
    for (DeviceFact& fact : dialogue_.facts(info.source))
      info.facts.push_back(std::move(fact));
    info.facts.push_back({"server_station", std::to_string(line->station)});
    return info;
  }

  Result<void> start_stream(Transport& transport, const std::string& /*source*/,
                            const ReplyDeadline& limit) override {
    dialogue_.start(transport, tracker_, limit);
    return {};
  }
  void end_stream(Transport& transport, const ReplyDeadline& /*limit*/) noexcept override {
    dialogue_.end(transport);
  }

  // The reader of JSON throws for lack of memory alone. NOLINTNEXTLINE(bugprone-exception-escape)
  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    const auto take = [&](PoseSample pose) {
      pose.station = station_;
      sink.deliver(pose);
    };
    Parser& parser = dialogue_.parser();
    parser.set_arrival(arrival);
    parser.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return dialogue_.parser().counters(); }
  /// The server counts what it drops.
  bool counts_missed() const noexcept override { return true; }

private:
  ServedDialogue dialogue_;
  const std::uint16_t station_; ///< the number that poses have here
  WantedDevice tracker_;
};

} // namespace

Result<std::unique_ptr<Tracker>> open_served_tracker(const DeviceSpec& spec,
                                                     std::span<const std::uint16_t> stations) {
  auto place = parse_serve_place(spec);
  if (!place) return place.error();
  const auto server = place->server;
  return open_stream_tracker(
      spec.text, [server] { return server->connect(); },
      std::make_unique<ServedTrackerProtocol>(*std::move(place), stations.front()),
      HostClock::now() + open_budget);
}

} // namespace nendo::driver::served
