#include "stream/stream_glove.hpp"

#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include <spdlog/spdlog.h>

namespace nendo::driver {
namespace {

constexpr std::chrono::milliseconds feedback_budget{400};

class StreamGlove final : public Glove, private DeviceStream, private GloveProtocol::Sink {
public:
  StreamGlove(GloveInfo info, OpenPort open_port, std::unique_ptr<Transport> transport,
              std::unique_ptr<GloveProtocol> protocol)
      : DeviceStream(info.source, info.rate_hz, std::move(open_port), std::move(transport),
                     *protocol),
        info_(std::move(info)), protocol_(std::move(protocol)), side_(info_.side),
        sensors_(info_.sensors) {}
  ~StreamGlove() override { StreamGlove::stop(); }

  const GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& ring) override {
    if (!is_running()) ring_ = &ring;
    return begin();
  }
  void stop() noexcept override { end(); }
  StreamStats stats() const noexcept override { return stream_stats(); }
  void set_feedback(const Feedback& feedback) noexcept override {
    const std::lock_guard lock(feedback_mutex_);
    feedback_ = feedback;
    feedback_changed_ = true;
  }

private:
  void push(std::span<const std::byte> chunk, HostTime arrival) noexcept override {
    protocol_->push(chunk, arrival, *this);
  }
  void deliver(GloveSample& sample) noexcept override {
    stamp(sample);
    count_sample(ring_->try_push(sample));
  }
  void reject() noexcept override { count_bad(); }

  Result<void> identify(Transport& transport, IdentifyReason reason,
                        const ReplyDeadline& limit) override {
    const auto info = protocol_->identify(transport, info_.source, reason, limit);
    if (!info) return info.error();
    if (!(info->sensors == sensors_) || info->side != side_) {
      spdlog::warn("device: {} is another glove now: {} hand, {}", info_.source,
                   name_of(info->side), info->model);
      side_ = info->side;
      sensors_ = info->sensors;
    }
    const std::lock_guard lock(feedback_mutex_);
    feedback_changed_ = !(feedback_ == Feedback{});
    return {};
  }

  void after_read(Transport& transport, const std::stop_token& token) noexcept override {
    if (!feedback_changed_) return;
    Feedback feedback;
    {
      const std::lock_guard lock(feedback_mutex_);
      feedback_changed_ = false;
      feedback = feedback_;
    }
    protocol_->set_feedback(transport, feedback, {HostClock::now() + feedback_budget, token});
  }

  const GloveInfo info_;
  const std::unique_ptr<GloveProtocol> protocol_;
  std::mutex feedback_mutex_;
  Feedback feedback_; ///< guarded by feedback_mutex_
  std::atomic<bool> feedback_changed_{false};

  // Used by the reader thread only, while it runs.
  SampleRing* ring_ = nullptr;
  Side side_;
  SensorMask sensors_;
};

} // namespace

Result<std::unique_ptr<Glove>> open_stream_glove(const std::string& source, OpenPort open_port,
                                                 std::unique_ptr<GloveProtocol> protocol,
                                                 HostTime deadline) {
  return open_stream<Glove, StreamGlove>(source, std::move(open_port), std::move(protocol),
                                         deadline);
}

} // namespace nendo::driver
