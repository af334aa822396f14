#pragma once
// Replays recorded samples with their original timing, for gloves and trackers.

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/device_spec.hpp>
#include <nendo/driver/reader_thread.hpp>
#include <nendo/driver/stream_stats.hpp>
#include <nendo/recording/chunk_file.hpp>
#include <nendo/recording/sample_record.hpp>

namespace nendo::recording {

struct ReplayOptions {
  double speed = 1.0;
  bool loops = false;
  bool holds = false; ///< after its last sample it is silent, and never says that it has ended
};
Error replay_error(const driver::DeviceSpec& spec, Errc code, const std::string& what);
/// Reads the options speed, loop and end. Error: usage.
Result<ReplayOptions> replay_options(const driver::DeviceSpec& spec);

/// Samples of one device, in their order.
template <class Sample>
class SampleSource {
public:
  SampleSource() = default;
  SampleSource(const SampleSource&) = delete;
  SampleSource& operator=(const SampleSource&) = delete;
  virtual ~SampleSource() = default;
  virtual std::optional<Sample> next() = 0;
};
/// Begins once more; null if the file has been taken away since.
template <class Sample>
using OpenSource = std::function<std::unique_ptr<SampleSource<Sample>>()>;

/// The samples of a recording that `sample_in(entry)` finds.
template <class Sample>
class RecordedSource final : public SampleSource<Sample> {
public:
  using SampleIn = std::function<std::optional<Sample>(const LogEntry& entry)>;
  RecordedSource(ChunkReader reader, SampleIn sample_in)
      : reader_(std::move(reader)), sample_in_(std::move(sample_in)) {}

  std::optional<Sample> next() override {
    for (;;) {
      while (const auto entry = entries_.next())
        if (auto sample = sample_in_(*entry)) return sample;
      const auto chunk = reader_.next();
      if (!chunk) return std::nullopt;
      entries_ =
          LogEntries(chunk->type == log_chunk ? chunk->payload : std::span<const std::byte>{});
    }
  }

private:
  ChunkReader reader_;
  SampleIn sample_in_;
  LogEntries entries_{{}};
};

/// The thread that replays. Asking thread, except `push`, which the reader thread calls.
template <class Sample>
class ReplayStream {
public:
  ReplayStream(const ReplayOptions& options, double rate_hz, OpenSource<Sample> open)
      : options_(options), rate_hz_(rate_hz), open_(std::move(open)) {}

  /// `push` returns false if a ring refused the sample. Error: failed.
  Result<void> start(const std::string& source, std::function<bool(const Sample&)> push) {
    ended_.store(false, std::memory_order_relaxed);
    return reader_.start(source, [this, push = std::move(push)](const std::stop_token& stop) {
      records_ = missed_ = ring_refused_ = 0;
      replay(stop, push);
    });
  }
  void stop() noexcept { reader_.stop(); }
  bool is_running() const noexcept { return reader_.is_running(); }
  bool has_ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  driver::StreamStats stats() const noexcept {
    driver::StreamStats stats;
    stats.records = records_.load(std::memory_order_relaxed);
    stats.missed = missed_.load(std::memory_order_relaxed);
    stats.ring_refused = ring_refused_.load(std::memory_order_relaxed);
    stats.counts_missed = true; // samples are numbered
    return stats;
  }

private:
  using Push = std::function<bool(const Sample&)>;

  void replay(const std::stop_token& stop, const Push& push) {
    HostTime begin = HostClock::now();
    do {
      const auto end = replay_once(stop, push, begin);
      if (!end) break; // it is to stop, or its file has been taken away
      begin = *end;
    } while (options_.loops);
    if (options_.holds || stop.stop_requested()) return;
    ended_.store(true, std::memory_order_release); // a reader that sees it also sees all samples
  }

  /// When the next pass begins; nothing if there is none.
  std::optional<HostTime> replay_once(const std::stop_token& stop, const Push& push,
                                      HostTime begin) {
    const auto source = open_();
    if (source == nullptr) return std::nullopt;
    auto sample = source->next();
    if (!sample) return std::nullopt;
    const HostTime first = sample->arrival;
    const std::uint64_t first_sequence = sample->sequence;
    const std::uint64_t sequence_base = next_sequence_;
    HostTime due = begin;
    for (; sample; sample = source->next()) {
      due = begin + scaled(sample->arrival - first);
      if (!reader_.wait_until(stop, due)) return std::nullopt;
      const std::uint64_t sequence = sequence_base + (sample->sequence - first_sequence);
      if (sequence > next_sequence_)
        missed_.fetch_add(sequence - next_sequence_, std::memory_order_relaxed);
      next_sequence_ = sequence + 1;
      deliver(*sample, sequence, begin + scaled(sample->measured - first), push);
    }
    // Not only `due`, which a hostile file's last sample may have before its first.
    return std::max(due, HostClock::now()) + period();
  }

  void deliver(Sample sample, std::uint64_t sequence, HostTime measured, const Push& push) {
    // A tracker's driver may know when a pose was measured, also without a clock.
    const bool keeps_age = sample.has_device_time || sample.measured != sample.arrival;
    sample.is_replayed = true;
    sample.recorded_arrival = sample.arrival;
    sample.recorded_measured = sample.measured;
    sample.sequence = sequence;
    sample.arrival = HostClock::now();
    sample.measured = keeps_age ? std::min(measured, sample.arrival) : sample.arrival;
    if (!push(sample)) ring_refused_.fetch_add(1, std::memory_order_relaxed);
    records_.fetch_add(1, std::memory_order_relaxed);
  }

  HostClock::duration scaled(HostClock::duration time) const noexcept {
    constexpr double max_s = 1e8; // three years: a hostile file's gap is no reason to overflow
    const double seconds = std::clamp(to_seconds(time) / options_.speed, -max_s, max_s);
    return from_seconds(seconds);
  }

  HostClock::duration period() const noexcept {
    constexpr double min_rate_hz = 1.0;
    constexpr double max_rate_hz = 1e4;
    return from_seconds(1.0 / std::clamp(rate_hz_, min_rate_hz, max_rate_hz));
  }

  const ReplayOptions options_;
  const double rate_hz_; ///< the rate of the replay
  const OpenSource<Sample> open_;
  std::uint64_t next_sequence_ = 0; ///< used by the reader thread only
  std::atomic<std::uint64_t> records_{0};
  std::atomic<std::uint64_t> missed_{0};
  std::atomic<std::uint64_t> ring_refused_{0};
  std::atomic<bool> ended_{false};
  driver::ReaderThread reader_; // last: joined before what it uses is gone
};

} // namespace nendo::recording
