#include "stream/stream_tracker.hpp"

#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

namespace nendo::driver {
namespace {

class StreamTracker final : public Tracker, private DeviceStream, private TrackerProtocol::Sink {
public:
  StreamTracker(TrackerInfo info, OpenPort open_port, std::unique_ptr<Transport> transport,
                std::unique_ptr<TrackerProtocol> protocol)
      : DeviceStream(info.source, info.rate_hz, std::move(open_port), std::move(transport),
                     *protocol),
        info_(std::move(info)), protocol_(std::move(protocol)), model_(info_.model) {}
  ~StreamTracker() override { StreamTracker::stop(); }

  const TrackerInfo& info() const noexcept override { return info_; }
  Result<void> start(std::span<const StationRing> rings) override {
    if (!is_running()) rings_.assign(rings.begin(), rings.end());
    return begin();
  }
  void stop() noexcept override { end(); }
  StreamStats stats() const noexcept override { return stream_stats(); }

private:
  void push(std::span<const std::byte> chunk, HostTime arrival) noexcept override {
    protocol_->push(chunk, arrival, *this);
  }
  void deliver(PoseSample& sample) noexcept override {
    stamp(sample);
    bool taken = true;
    for (const StationRing& station : rings_)
      if (station.station == sample.station) taken = station.ring->try_push(sample) && taken;
    count_sample(taken);
  }
  void reject() noexcept override { count_bad(); }

  Result<void> identify(Transport& transport, IdentifyReason reason,
                        const ReplyDeadline& limit) override {
    const auto info = protocol_->identify(transport, info_.source, reason, limit);
    if (!info) return info.error();
    if (info->model != std::exchange(model_, info->model))
      spdlog::warn("device: {} is another tracker now: {}", info_.source, info->model);
    return {};
  }

  const TrackerInfo info_;
  const std::unique_ptr<TrackerProtocol> protocol_;

  // Used by the reader thread only, while it runs.
  std::vector<StationRing> rings_;
  std::string model_;
};

} // namespace

Result<std::unique_ptr<Tracker>> open_stream_tracker(const std::string& source, OpenPort open_port,
                                                     std::unique_ptr<TrackerProtocol> protocol,
                                                     HostTime deadline) {
  return open_stream<Tracker, StreamTracker>(source, std::move(open_port), std::move(protocol),
                                             deadline);
}

} // namespace nendo::driver
