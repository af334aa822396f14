#include "stream/stream_glove.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <stop_token>
#include <utility>

#include <spdlog/spdlog.h>

#include <nendo/driver/reader_thread.hpp>

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

constexpr auto start_budget = 1'900ms;
constexpr auto stop_budget = 400ms;
constexpr auto feedback_budget = 400ms;
constexpr auto read_timeout = 100ms; ///< also how soon the reader notices that it is to stop
constexpr auto min_silence = 1500ms;
constexpr auto retry_interval = 500ms;
/// Single ones are damage; so many in a row are another glove, line rate or form of record.
constexpr std::uint64_t bad_in_a_row = 16;
constexpr auto rate_window = 1s;
constexpr double rate_tolerance = 0.05;

/// `bytes` is written first and read last: no reader sees it less than its parts.
constexpr std::array counts{&StreamCounters::bytes,           &StreamCounters::record_bytes,
                            &StreamCounters::discarded_bytes, &StreamCounters::records,
                            &StreamCounters::bad_records,     &StreamCounters::implausible,
                            &StreamCounters::missed,          &StreamCounters::too_fast,
                            &StreamCounters::unplugged,       &StreamCounters::clamped};

/// GloveStats, written by the reader thread and read by any.
struct SharedStats {
  std::array<std::atomic<std::uint64_t>, counts.size()> counted{};
  std::atomic<std::uint64_t> ring_refused{0}, silences{0}, reopened{0};
  std::atomic<double> rate_hz{0.0};
  std::atomic<bool> counts_missed{false};

  /// `now` and `then` are the protocol's counters, which outlive a stop() and another start().
  void store(const StreamCounters& now, const StreamCounters& then) noexcept {
    for (std::size_t k = 0; k < counts.size(); ++k)
      counted[k].store(now.*counts[k] - then.*counts[k], std::memory_order_release);
  }
  GloveStats load() const noexcept {
    GloveStats stats;
    for (std::size_t k = counts.size(); k-- > 0;)
      stats.*counts[k] = counted[k].load(std::memory_order_acquire);
    stats.ring_refused = ring_refused;
    stats.silences = silences;
    stats.reopened = reopened;
    stats.rate_hz = rate_hz;
    stats.counts_missed = counts_missed;
    return stats;
  }
};

class StreamGlove final : public Glove, private SampleSink {
public:
  StreamGlove(GloveInfo info, OpenPort open_port, std::unique_ptr<Transport> transport,
              std::unique_ptr<GloveProtocol> protocol)
      : info_(std::move(info)), open_port_(std::move(open_port)), transport_(std::move(transport)),
        protocol_(std::move(protocol)), side_(info_.side), sensors_(info_.sensors) {}
  ~StreamGlove() override { StreamGlove::stop(); }

  const GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& ring) override {
    if (reader_.is_running()) return Error{Errc::failed, info_.source + " is streaming already"};
    if (!transport_) return Error{Errc::no_device, info_.source + " went away; open it again"};
    const ReplyDeadline limit{HostClock::now() + start_budget, {}};
    if (auto ready = protocol_->start_stream(*transport_, info_.source, limit); !ready)
      return ready.error();
    at_start_ = protocol_->counters();
    store_counts();
    stats_.ring_refused = stats_.silences = stats_.reopened = 0;
    ring_ = &ring;
    sequence_ = 0;
    bad_since_record_ = 0;
    outage_ = unanswered_ = caught_up_ = false;
    window_begin_ = HostClock::now();
    window_begins_with_ = 0;
    return reader_.start(info_.source, [this](const std::stop_token& token) { run(token); });
  }

  void stop() noexcept override { reader_.stop(); }

  GloveStats stats() const noexcept override { return stats_.load(); }
  void set_feedback(const Feedback& feedback) noexcept override {
    const std::lock_guard lock(feedback_mutex_);
    feedback_ = feedback;
    feedback_changed_ = true;
  }

private:
  enum class StreamEnd { stopped, silent, doubtful, gone };

  void run(const std::stop_token& token) {
    for (;;) {
      switch (stream(token)) {
      case StreamEnd::stopped:
        if (transport_) protocol_->end_stream(*transport_, {HostClock::now() + stop_budget, {}});
        store_counts();
        return;
      case StreamEnd::silent:
        revive(token);
        break;
      case StreamEnd::doubtful:
        outage_ = true;
        unanswered_ = !restart(token, IdentifyReason::damaged);
        bad_since_record_ = 0;
        break;
      case StreamEnd::gone:
        reopen(token);
        break;
      }
    }
  }

  StreamEnd stream(const std::stop_token& token) {
    std::array<std::byte, 1024> buffer{};
    const HostClock::duration three_periods =
        info_.rate_hz > 0.0 ? from_seconds(std::min(3.0 / info_.rate_hz, 60.0))
                            : HostClock::duration{};
    // Who did not answer is asked again soon; meanwhile it may have begun to stream by itself.
    const auto max_silence =
        unanswered_
            ? HostClock::duration(retry_interval)
            : std::max<HostClock::duration>({min_silence, three_periods, protocol_->max_pause()});
    last_record_ = HostClock::now();
    while (!token.stop_requested()) {
      if (!transport_) return StreamEnd::gone;
      const HostTime asked = HostClock::now();
      const auto [status, count] = transport_->read_some(buffer, read_timeout);
      arrival_ = HostClock::now();
      if (status == IoStatus::gone) return StreamEnd::gone;
      protocol_->push(std::span(buffer).first(count), arrival_, *this);
      protocol_->answer(*transport_);
      store_counts();
      if (!caught_up_) skip_backlog(arrival_ - asked);
      measure_rate(arrival_);
      if (protocol_->is_doubtful() || bad_since_record_ >= bad_in_a_row) return StreamEnd::doubtful;
      if (arrival_ - last_record_ > max_silence) return StreamEnd::silent;
      if (feedback_changed_) show_feedback(token);
    }
    return StreamEnd::stopped;
  }

  void deliver(GloveSample& sample) noexcept override {
    sample.arrival = arrival_;
    if (!sample.has_device_time) sample.measured = arrival_;
    sample.sequence = sequence_++;
    last_record_ = arrival_;
    if (!ring_->try_push(sample)) ++stats_.ring_refused;
    bad_since_record_ = 0;
    if (std::exchange(outage_, false)) spdlog::warn("device: {} streams again", info_.source);
  }

  void reject() noexcept override { ++bad_since_record_; }
  void store_counts() noexcept {
    stats_.store(protocol_->counters(), at_start_);
    stats_.counts_missed = protocol_->counts_missed();
  }

  void show_feedback(const std::stop_token& token) noexcept {
    Feedback feedback;
    {
      const std::lock_guard lock(feedback_mutex_);
      feedback_changed_ = false;
      feedback = feedback_;
    }
    protocol_->set_feedback(*transport_, feedback, {HostClock::now() + feedback_budget, token});
  }

  /// What had waited for start() comes at once, and says nothing of the glove's rate. So the first
  /// window begins where a read had to wait.
  void skip_backlog(HostClock::duration waited) noexcept {
    constexpr auto min_wait = 500us;
    caught_up_ = waited >= min_wait;
    window_begin_ = arrival_;
    window_begins_with_ = sequence_;
  }

  /// Measures the delivered rate; one that differs from the set rate is reported once.
  void measure_rate(HostTime now) {
    if (now - window_begin_ < rate_window) return;
    const double rate_hz =
        static_cast<double>(sequence_ - window_begins_with_) / to_seconds(now - window_begin_);
    const bool steady = std::abs(rate_hz - stats_.rate_hz) < rate_tolerance * rate_hz;
    const bool wrong = std::abs(rate_hz - info_.rate_hz) > rate_tolerance * info_.rate_hz;
    if (info_.rate_hz > 0.0 && steady && wrong && rate_reported_hz_ == 0.0) {
      rate_reported_hz_ = rate_hz;
      spdlog::warn("device: {} is set to {:.1f} records per second and delivers {:.1f}",
                   info_.source, info_.rate_hz, rate_hz);
    }
    stats_.rate_hz = rate_hz;
    window_begin_ = now;
    window_begins_with_ = sequence_;
  }

  /// The glove fell silent, or sends nothing usable: it may have been switched off and on, or
  /// swapped.
  void revive(const std::stop_token& token) {
    if (!std::exchange(outage_, true)) {
      ++stats_.silences;
      spdlog::warn("device: {} sent no good record for {:.1f} s; starting its stream again",
                   info_.source, to_seconds(HostClock::now() - last_record_));
    }
    const bool damaged = bad_since_record_ > 0;
    unanswered_ = !restart(token, damaged ? IdentifyReason::damaged : IdentifyReason::reviving);
  }

  void reopen(const std::stop_token& token) {
    // At once: while the old handle is open, a device that is plugged in again gets another name.
    transport_.reset();
    if (!std::exchange(outage_, true)) {
      spdlog::warn("device: {} went away; looking for it every 0.5 s", info_.source);
    }
    while (reader_.wait_until(token, HostClock::now() + retry_interval)) {
      auto transport = open_port_();
      if (!transport) continue;
      transport_ = *std::move(transport);
      if (restart(token, IdentifyReason::reviving)) {
        ++stats_.reopened;
        unanswered_ = false;
        return;
      }
      transport_.reset();
    }
  }

  /// Asks again who is there, sets it up as before and starts the stream.
  bool restart(const std::stop_token& token, IdentifyReason reason) {
    const ReplyDeadline limit{HostClock::now() + open_budget, token};
    const auto info = protocol_->identify(*transport_, info_.source, reason, limit);
    Result<void> streams = info ? Result<void>() : info.error();
    if (info) {
      if (!(info->sensors == sensors_) || info->side != side_) {
        spdlog::warn("device: {} is another glove now: {} hand, {}", info_.source,
                     name_of(info->side), info->model);
        side_ = info->side;
        sensors_ = info->sensors;
      }
      streams = protocol_->start_stream(*transport_, info_.source, limit);
      const std::lock_guard lock(feedback_mutex_);
      feedback_changed_ = !(feedback_ == Feedback{});
    }
    store_counts();
    // Each reason once, however often it is tried.
    const std::string why = streams ? std::string() : streams.error().message;
    if (why != std::exchange(complaint_, why) && !why.empty())
      spdlog::warn("device: {}; trying again", why);
    return bool(streams);
  }

  const GloveInfo info_;
  const OpenPort open_port_;
  SharedStats stats_;
  std::mutex feedback_mutex_;
  Feedback feedback_; ///< guarded by feedback_mutex_
  std::atomic<bool> feedback_changed_{false};

  // Used by the reader thread only, while it runs.
  std::unique_ptr<Transport> transport_; ///< null while the device is away
  const std::unique_ptr<GloveProtocol> protocol_;
  std::string complaint_; ///< the last reported reason why it does not come back
  StreamCounters at_start_;
  SampleRing* ring_ = nullptr;
  Side side_;
  SensorMask sensors_;
  HostTime arrival_{};
  HostTime last_record_{};
  HostTime window_begin_{};
  std::uint64_t window_begins_with_ = 0; ///< the first sample of the window
  std::uint64_t sequence_ = 0;
  std::uint64_t bad_since_record_ = 0; ///< bad ones since the last good one
  double rate_reported_hz_ = 0.0;
  bool caught_up_ = false;  ///< what had waited for start() has been read
  bool outage_ = false;     ///< no record since the stream broke off
  bool unanswered_ = false; ///< the last question who is there had no good answer

  ReaderThread reader_; // last: joined before what it uses is gone
};

} // namespace

Result<std::unique_ptr<Glove>> open_stream_glove(const std::string& source, OpenPort open_port,
                                                 std::unique_ptr<GloveProtocol> protocol,
                                                 HostTime deadline) {
  auto transport = open_port();
  if (!transport) return transport.error();
  (*transport)->discard_input();
  auto info = protocol->identify(**transport, source, IdentifyReason::opening, {deadline, {}});
  if (!info) return info.error();
  info->source = source;
  return std::unique_ptr<Glove>(std::make_unique<StreamGlove>(
      *std::move(info), std::move(open_port), *std::move(transport), std::move(protocol)));
}

} // namespace nendo::driver
