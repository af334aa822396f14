#include "stream/device_stream.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include <spdlog/spdlog.h>

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

constexpr auto start_budget = 1'900ms;
constexpr auto stop_budget = 400ms;
constexpr std::chrono::milliseconds read_timeout{
    100}; ///< also how soon the reader notices that it is to stop
constexpr auto min_silence = 1500ms;
constexpr auto retry_interval = 500ms;
/// Single ones are damage; so many in a row are another device, line rate or form of record.
constexpr std::uint64_t bad_in_a_row = 16;
constexpr auto rate_window = 1s;
constexpr double rate_tolerance = 0.05;

/// `bytes` is written first and read last: no reader sees it less than its parts.
constexpr std::array counts{&StreamCounters::bytes,           &StreamCounters::record_bytes,
                            &StreamCounters::discarded_bytes, &StreamCounters::records,
                            &StreamCounters::bad_records,     &StreamCounters::implausible,
                            &StreamCounters::missed,          &StreamCounters::too_fast,
                            &StreamCounters::unplugged,       &StreamCounters::clamped};
static_assert(counts.size() == std::tuple_size_v<decltype(SharedStats::counted)>);

} // namespace

void SharedStats::store(const StreamCounters& now, const StreamCounters& then) noexcept {
  for (std::size_t k = 0; k < counts.size(); ++k)
    counted[k].store(now.*counts[k] - then.*counts[k], std::memory_order_release);
}

StreamStats SharedStats::load() const noexcept {
  StreamStats stats;
  for (std::size_t k = counts.size(); k-- > 0;)
    stats.*counts[k] = counted[k].load(std::memory_order_acquire);
  stats.ring_refused = ring_refused;
  stats.silences = silences;
  stats.reopened = reopened;
  stats.rate_hz = rate_hz;
  stats.counts_missed = counts_missed;
  return stats;
}

DeviceStream::DeviceStream(std::string source, double rate_hz, OpenPort open_port,
                           std::unique_ptr<Transport> transport, StreamProtocol& protocol)
    : source_(std::move(source)), rate_hz_(rate_hz), open_port_(std::move(open_port)),
      transport_(std::move(transport)), protocol_(protocol) {}

Result<void> DeviceStream::begin() {
  if (reader_.is_running()) return Error{Errc::failed, source_ + " is streaming already"};
  if (!transport_) return Error{Errc::no_device, source_ + " went away; open it again"};
  const ReplyDeadline limit{HostClock::now() + start_budget, {}};
  if (auto ready = protocol_.start_stream(*transport_, source_, limit); !ready)
    return ready.error();
  at_start_ = protocol_.counters();
  store_counts();
  stats_.ring_refused = stats_.silences = stats_.reopened = 0;
  sequence_ = 0;
  bad_since_record_ = 0;
  outage_ = unanswered_ = caught_up_ = false;
  window_begin_ = HostClock::now();
  window_begins_with_ = 0;
  return reader_.start(source_, [this](const std::stop_token& token) { run(token); });
}

void DeviceStream::run(const std::stop_token& token) {
  for (;;) {
    switch (stream(token)) {
    case StreamEnd::stopped:
      if (transport_) protocol_.end_stream(*transport_, {HostClock::now() + stop_budget, {}});
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

/// Who did not answer is asked again soon; meanwhile it may have begun to stream by itself.
HostClock::duration DeviceStream::max_silence() const noexcept {
  if (unanswered_) return retry_interval;
  const HostClock::duration three_periods =
      rate_hz_ > 0.0 ? from_seconds(std::min(3.0 / rate_hz_, 60.0)) : HostClock::duration{};
  return std::max<HostClock::duration>({min_silence, three_periods, protocol_.max_pause()});
}

DeviceStream::StreamEnd DeviceStream::stream(const std::stop_token& token) {
  std::array<std::byte, 2048> buffer{}; // longer than a report or a datagram
  const HostClock::duration silence = max_silence();
  last_record_ = HostClock::now();
  while (!token.stop_requested()) {
    if (!transport_) return StreamEnd::gone;
    const HostTime asked = HostClock::now();
    const auto [status, count] =
        transport_->read_some(buffer, std::min(read_timeout, protocol_.max_wait()));
    arrival_ = HostClock::now();
    if (status == IoStatus::gone) return StreamEnd::gone;
    push(std::span(buffer).first(count), arrival_);
    protocol_.answer(*transport_);
    store_counts();
    if (!caught_up_) skip_backlog(arrival_ - asked);
    measure_rate(arrival_);
    if (protocol_.is_doubtful() || bad_since_record_ >= bad_in_a_row) return StreamEnd::doubtful;
    if (arrival_ - last_record_ > silence) return StreamEnd::silent;
    after_read(*transport_, token);
  }
  return StreamEnd::stopped;
}

void DeviceStream::count_sample(bool taken) noexcept {
  last_record_ = arrival_;
  if (!taken) ++stats_.ring_refused;
  bad_since_record_ = 0;
  if (std::exchange(outage_, false)) spdlog::warn("device: {} streams again", source_);
}

void DeviceStream::store_counts() noexcept {
  stats_.store(protocol_.counters(), at_start_);
  stats_.counts_missed = protocol_.counts_missed();
}

/// What had waited for begin() comes at once, and says nothing of the device's rate. So the first
/// window begins where a read had to wait.
void DeviceStream::skip_backlog(HostClock::duration waited) noexcept {
  constexpr auto min_wait = 500us;
  caught_up_ = waited >= min_wait;
  window_begin_ = arrival_;
  window_begins_with_ = sequence_;
}

/// Measures the delivered rate; one that differs from the set rate is reported once.
void DeviceStream::measure_rate(HostTime now) {
  if (now - window_begin_ < rate_window) return;
  const double rate_hz =
      static_cast<double>(sequence_ - window_begins_with_) / to_seconds(now - window_begin_);
  const bool steady = std::abs(rate_hz - stats_.rate_hz) < rate_tolerance * rate_hz;
  const bool wrong = std::abs(rate_hz - rate_hz_) > rate_tolerance * rate_hz_;
  if (rate_hz_ > 0.0 && steady && wrong && rate_reported_hz_ == 0.0) {
    rate_reported_hz_ = rate_hz;
    spdlog::warn("device: {} is set to {:.1f} records per second and delivers {:.1f}", source_,
                 rate_hz_, rate_hz);
  }
  stats_.rate_hz = rate_hz;
  window_begin_ = now;
  window_begins_with_ = sequence_;
}

/// The device fell silent, or sends nothing usable: it may have been switched off and on, or
/// swapped.
void DeviceStream::revive(const std::stop_token& token) {
  if (!std::exchange(outage_, true)) {
    ++stats_.silences;
    spdlog::warn("device: {} sent no good record for {:.1f} s; starting its stream again", source_,
                 to_seconds(HostClock::now() - last_record_));
  }
  const bool damaged = bad_since_record_ > 0;
  unanswered_ = !restart(token, damaged ? IdentifyReason::damaged : IdentifyReason::reviving);
}

void DeviceStream::reopen(const std::stop_token& token) {
  // At once: while the old handle is open, a device that is plugged in again gets another name.
  transport_.reset();
  if (!std::exchange(outage_, true)) {
    spdlog::warn("device: {} went away; looking for it every 0.5 s", source_);
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
bool DeviceStream::restart(const std::stop_token& token, IdentifyReason reason) {
  const ReplyDeadline limit{HostClock::now() + open_budget, token};
  Result<void> streams = identify(*transport_, reason, limit);
  if (streams) streams = protocol_.start_stream(*transport_, source_, limit);
  store_counts();
  // Each reason once, however often it is tried.
  const std::string why = streams ? std::string() : streams.error().message;
  if (why != std::exchange(complaint_, why) && !why.empty())
    spdlog::warn("device: {}; trying again", why);
  return bool(streams);
}

} // namespace nendo::driver
