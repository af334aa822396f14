#include <nendo/recording/replay_driver.hpp>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <vector>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/glove_options.hpp>
#include <nendo/driver/reader_thread.hpp>
#include <nendo/recording/sample_record.hpp>

#include "sample_table.hpp"

namespace nendo::recording {
namespace {

struct Settings {
  double speed = 1.0;
  bool loops = false;
  bool holds = false; ///< after its last sample it is silent, and never says that it has ended
};

Error error_of(const driver::DeviceSpec& spec, Errc code, const std::string& what) {
  return Error{code, spec.text + ": " + what};
}

Result<Settings> settings_of(const driver::DeviceSpec& spec) {
  constexpr double min_speed = 0.01;
  constexpr double max_speed = 100.0;
  Settings settings;
  if (const auto option = spec.options.find("speed"); option != spec.options.end()) {
    const auto speed = to_number(option->second);
    if (!speed || !(*speed >= min_speed && *speed <= max_speed))
      return error_of(spec, Errc::usage, "speed must be a number from 0.01 to 100");
    settings.speed = *speed;
  }
  if (const auto option = spec.options.find("loop"); option != spec.options.end()) {
    if (option->second != "yes" && option->second != "no")
      return error_of(spec, Errc::usage, "loop is yes or no");
    settings.loops = option->second == "yes";
  }
  if (const auto option = spec.options.find("end"); option != spec.options.end()) {
    if (option->second != "stop" && option->second != "hold")
      return error_of(spec, Errc::usage, "end is stop or hold");
    if (settings.loops)
      return error_of(spec, Errc::usage, "with loop=yes there is no end; leave end= out");
    settings.holds = option->second == "hold";
  }
  return settings;
}

/// Samples of one glove, in their order.
class SampleSource {
public:
  SampleSource() = default;
  SampleSource(const SampleSource&) = delete;
  SampleSource& operator=(const SampleSource&) = delete;
  virtual ~SampleSource() = default;
  virtual std::optional<GloveSample> next() = 0;
};
/// Begins once more; null if the file has been taken away since.
using OpenSource = std::function<std::unique_ptr<SampleSource>()>;

class RecordedSamples final : public SampleSource {
public:
  RecordedSamples(ChunkReader reader, std::uint8_t glove)
      : reader_(std::move(reader)), glove_(glove) {}

  std::optional<GloveSample> next() override {
    for (;;) {
      while (const auto record = records_.next()) {
        const auto recorded = sample_of(*record);
        if (recorded && recorded->glove == glove_) return recorded->sample;
      }
      const auto chunk = reader_.next();
      if (!chunk) return std::nullopt;
      records_ =
          LogEntries(chunk->type == log_chunk ? chunk->payload : std::span<const std::byte>{});
    }
  }

private:
  ChunkReader reader_;
  std::uint8_t glove_;
  LogEntries records_{{}};
};

class TableSamples final : public SampleSource {
public:
  explicit TableSamples(std::shared_ptr<const std::vector<GloveSample>> samples)
      : samples_(std::move(samples)) {}

  std::optional<GloveSample> next() override {
    if (at_ == samples_->size()) return std::nullopt;
    return (*samples_)[at_++];
  }

private:
  std::shared_ptr<const std::vector<GloveSample>> samples_;
  std::size_t at_ = 0;
};

class ReplayedGlove final : public driver::Glove {
public:
  ReplayedGlove(const driver::DeviceSpec& spec, const Settings& settings, driver::GloveInfo info,
                OpenSource open)
      : settings_(settings), info_(std::move(info)), open_(std::move(open)) {
    info_.facts.push_back({"recorded_from", info_.source});
    info_.kind = driver::SourceKind::recorded;
    info_.recording = spec.target;
    info_.source = spec.text;
    info_.rate_hz *= settings.speed;
    info_.abilities = {.wrist_switch = info_.abilities.wrist_switch};
  }

  const driver::GloveInfo& info() const noexcept override { return info_; }

  Result<void> start(SampleRing& ring) override {
    ended_.store(false, std::memory_order_relaxed);
    return reader_.start(info_.source, [this, &ring](const std::stop_token& stop) {
      records_ = missed_ = ring_refused_ = 0;
      replay(stop, ring);
    });
  }
  void stop() noexcept override { reader_.stop(); }

  driver::StreamStats stats() const noexcept override {
    driver::StreamStats stats;
    stats.records = records_.load(std::memory_order_relaxed);
    stats.missed = missed_.load(std::memory_order_relaxed);
    stats.ring_refused = ring_refused_.load(std::memory_order_relaxed);
    stats.counts_missed = true; // samples are numbered
    return stats;
  }

  bool has_ended() const noexcept override { return ended_.load(std::memory_order_acquire); }

  void set_feedback(const driver::Feedback& /*feedback*/) noexcept override {} // there is no glove

private:
  void replay(const std::stop_token& stop, SampleRing& ring) {
    HostTime begin = HostClock::now();
    do {
      const auto end = replay_once(stop, ring, begin);
      if (!end) break; // it is to stop, or its file has been taken away
      begin = *end;
    } while (settings_.loops);
    if (settings_.holds || stop.stop_requested()) return;
    ended_.store(true, std::memory_order_release); // a reader that sees it also sees all samples
  }

  /// When the next pass begins; nothing if there is none.
  std::optional<HostTime> replay_once(const std::stop_token& stop, SampleRing& ring,
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
      deliver(*sample, sequence, begin + scaled(sample->measured - first), ring);
    }
    // Not only `due`, which a hostile file's last sample may have before its first.
    return std::max(due, HostClock::now()) + period();
  }

  void deliver(GloveSample sample, std::uint64_t sequence, HostTime measured, SampleRing& ring) {
    sample.is_replayed = true;
    sample.recorded_arrival = sample.arrival;
    sample.recorded_measured = sample.measured;
    sample.sequence = sequence;
    sample.arrival = HostClock::now();
    sample.measured = sample.has_device_time ? std::min(measured, sample.arrival) : sample.arrival;
    if (!ring.try_push(sample)) ring_refused_.fetch_add(1, std::memory_order_relaxed);
    records_.fetch_add(1, std::memory_order_relaxed);
  }

  HostClock::duration scaled(HostClock::duration time) const noexcept {
    constexpr double max_s = 1e8; // three years: a hostile file's gap is no reason to overflow
    const double seconds = std::clamp(to_seconds(time) / settings_.speed, -max_s, max_s);
    return from_seconds(seconds);
  }

  HostClock::duration period() const noexcept {
    constexpr double min_rate_hz = 1.0;
    constexpr double max_rate_hz = 1e4;
    return from_seconds(1.0 / std::clamp(info_.rate_hz, min_rate_hz, max_rate_hz));
  }

  Settings settings_;
  driver::GloveInfo info_;
  OpenSource open_;
  std::uint64_t next_sequence_ = 0; ///< used by the reader thread only
  std::atomic<std::uint64_t> records_{0};
  std::atomic<std::uint64_t> missed_{0};
  std::atomic<std::uint64_t> ring_refused_{0};
  std::atomic<bool> ended_{false};
  driver::ReaderThread reader_; // last: joined before what it uses is gone
};

std::vector<RecordedGlove> gloves_of(ChunkReader reader) {
  std::vector<RecordedGlove> gloves;
  while (const auto chunk = reader.next()) {
    if (chunk->type == log_chunk) break; // the gloves come before their samples
    if (chunk->type != glove_chunk) continue;
    if (auto glove = glove_of(chunk->payload)) gloves.push_back(*std::move(glove));
  }
  return gloves;
}

Result<RecordedGlove> choose(const driver::DeviceSpec& spec, std::vector<RecordedGlove> gloves,
                             std::optional<Side> asked, std::optional<Side> wanted) {
  if (gloves.empty())
    return error_of(spec, Errc::bad_input, "no glove was recorded, or its description is damaged");
  const std::optional<Side> side = asked ? asked : wanted;
  const auto found = std::ranges::find(
      gloves, side, [](const auto& glove) { return std::optional(glove.info.side); });
  if (found != gloves.end()) return std::move(*found);
  if (asked)
    return error_of(spec, Errc::no_device,
                    "no " + std::string(name_of(*asked)) +
                        "-hand glove was recorded; leave hand= out, or choose the other");
  if (!side && gloves.size() > 1)
    return error_of(spec, Errc::usage,
                    "several gloves were recorded; add ?hand=left or ?hand=right");
  return std::move(gloves.front());
}

Result<std::unique_ptr<driver::Glove>> open_recording(const driver::DeviceSpec& spec,
                                                      const Settings& settings,
                                                      std::optional<Side> asked,
                                                      std::optional<Side> side) {
  if (spec.options.contains("rate"))
    return error_of(spec, Errc::usage,
                    "rate is for tables (.csv, .tsv, .txt); a recording has its times");
  auto reader = ChunkReader::open(spec.target);
  if (!reader) return reader.error();
  auto glove = choose(spec, gloves_of(*std::move(reader)), asked, side);
  if (!glove) return glove.error();
  const OpenSource open = [path = spec.target,
                           number = glove->number]() -> std::unique_ptr<SampleSource> {
    auto again = ChunkReader::open(path);
    if (!again) return nullptr;
    return std::make_unique<RecordedSamples>(*std::move(again), number);
  };
  if (const auto source = open(); source == nullptr || !source->next())
    return error_of(spec, Errc::bad_input, "holds no sample of this glove");
  return std::unique_ptr<driver::Glove>(
      std::make_unique<ReplayedGlove>(spec, settings, std::move(glove->info), open));
}

bool is_table(const std::string& name) {
  const std::string ending = to_lower(std::filesystem::path(name).extension().string());
  return ending == ".csv" || ending == ".tsv" || ending == ".txt";
}

Result<std::unique_ptr<driver::Glove>> open_table(const driver::DeviceSpec& spec,
                                                  const Settings& settings, TableWishes wishes) {
  if (const auto option = spec.options.find("rate"); option != spec.options.end()) {
    const auto rate_hz = to_number(option->second);
    if (!rate_hz || !(*rate_hz >= 1.0 && *rate_hz <= 1e4))
      return error_of(spec, Errc::usage, "rate must be a number from 1 to 10000, rows per second");
    wishes.rate_hz = rate_hz;
  }
  auto table = read_sample_table(spec.target, wishes);
  if (!table) return table.error();
  const auto samples = std::make_shared<const std::vector<GloveSample>>(std::move(table->samples));
  return std::unique_ptr<driver::Glove>(
      std::make_unique<ReplayedGlove>(spec, settings, std::move(table->info), [samples] {
        return std::make_unique<TableSamples>(samples);
      }));
}

Result<std::unique_ptr<driver::Glove>> open_replay(const driver::DeviceSpec& spec,
                                                   std::optional<Side> side) {
  if (const auto fine = driver::allow_options(spec, {"hand", "speed", "loop", "end", "rate"});
      !fine)
    return fine.error();
  if (spec.target.empty())
    return error_of(spec, Errc::usage, "name the recording, e.g. replay:take1.nendo");
  const auto settings = settings_of(spec);
  if (!settings) return settings.error();
  const auto asked = driver::hand_option(spec);
  if (!asked) return asked.error();
  return is_table(spec.target) ? open_table(spec, *settings, {*asked, side, std::nullopt})
                               : open_recording(spec, *settings, *asked, side);
}

} // namespace

driver::GloveDriver replay_driver() noexcept {
  return {"replay", "replay:FILE[?hand=left|right&speed=X&loop=yes|end=hold&rate=HZ]",
          "a glove as `nendo record` or `nendo run --record` recorded it, or a table of counts "
          "(.csv, .tsv, .txt)",
          [](const driver::DeviceSpec& spec, std::optional<Side> side,
             const driver::GloveContext& /*context*/) { return open_replay(spec, side); }};
}

} // namespace nendo::recording
