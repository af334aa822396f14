#include <algorithm>
#include <optional>
#include <utility>

#include <nendo/recording/take_tools.hpp>

namespace nendo::recording {
namespace {

class Counter {
public:
  explicit Counter(TakeSummary& summary) : summary_(summary) {
    summary.gloves.resize(summary.setup.gloves.size());
    next_sequence_.resize(summary.gloves.size());
  }

  void operator()(const RecordedSample& recorded) {
    GloveSummary& glove = summary_.gloves[recorded.glove];
    const GloveSample& sample = recorded.sample;
    auto& expected = next_sequence_[recorded.glove];
    if (glove.samples == 0) {
      glove.first = sample.arrival;
    } else {
      if (sample.sequence > expected) glove.lost += sample.sequence - expected;
      if (sample.sequence < expected) ++glove.out_of_order;
      glove.longest_pause = std::max(glove.longest_pause, sample.arrival - glove.last);
    }
    ++glove.samples;
    expected = sample.sequence + 1;
    glove.last = sample.arrival;
    summary_.last = std::max(summary_.last, sample.arrival);
  }
  void operator()(flow::Request request) { ++summary_.requests[static_cast<std::size_t>(request)]; }
  void operator()(const flow::WristMove&) { ++summary_.wrist_moves; }
  void operator()(const flow::LoopSettings& settings) {
    // The recorder repeats them.
    if (std::exchange(settings_, settings) != settings) ++summary_.settings_changes;
  }
  void operator()(const flow::HoldStill&) {}
  void operator()(const flow::ChangeModel&) { ++summary_.model_changes; }
  void operator()(const flow::SetClutch&) {}
  void operator()(const flow::SetRole&) {}
  void operator()(const flow::SetSymmetry&) {}
  void operator()(const flow::DrawWire&) {}
  void operator()(const flow::SetLayer& layer) {
    if (layer.input < summary_.gloves.size()) ++summary_.gloves[layer.input].punches;
  }
  void operator()(const PuppetChange& change) {
    // The recorder repeats them.
    if (std::exchange(puppet_, change.number) != change.number) ++summary_.puppet_changes;
  }
  void operator()(const flow::Mark&) { ++marks_due_; }
  void operator()(const flow::LoggedTick& tick) {
    for (; marks_due_ > 0; --marks_due_)
      summary_.marks.push_back(tick.woke - summary_.setup.begun_host);
    if (summary_.ticks > 0) {
      if (tick.number < next_tick_) ++summary_.ticks_out_of_order;
      if (tick.number > next_tick_ && !after_gap_) summary_.missed += tick.number - next_tick_;
    }
    ++summary_.ticks;
    next_tick_ = tick.number + 1;
    after_gap_ = false;
    summary_.last = std::max(summary_.last, tick.woke);
  }
  void operator()(const Gap& gap) {
    ++summary_.gaps;
    summary_.missing += gap.entries;
    after_gap_ = true;
  }

private:
  TakeSummary& summary_;
  std::vector<std::uint64_t> next_sequence_;
  std::optional<flow::LoopSettings> settings_;
  std::optional<std::uint32_t> puppet_;
  std::uint64_t next_tick_ = 0;
  std::uint64_t marks_due_ = 0; ///< of the next tick
  bool after_gap_ = false;      ///< what is not in the recording was not missed by the loop
};

bool agree(const TakeSummary& summary) {
  if (!summary.ending || summary.gaps > 0) return true;
  std::uint64_t samples = 0;
  for (const auto& glove : summary.gloves)
    samples += glove.samples;
  std::uint64_t requests = 0;
  for (const std::uint64_t count : summary.requests)
    requests += count;
  return samples == summary.ending->samples && requests == summary.ending->requests &&
         summary.ticks == summary.ending->ticks;
}

Result<TakeSummary> summary_of(Result<TakeReader> reader) {
  if (!reader) return reader.error();
  TakeSummary summary;
  summary.setup = reader->setup();
  Counter counter(summary);
  while (const auto entry = reader->next())
    std::visit(counter, *entry);
  summary.ending = reader->ending();
  for (std::size_t at = 0; at < summary.gloves.size() && at < reader->sent().size(); ++at)
    summary.gloves[at].sent = reader->sent()[at];
  summary.bytes = reader->chunks().size();
  summary.good_end = reader->chunks().good_end();
  summary.damage_count = reader->chunks().damage_count();
  summary.damages = reader->chunks().damages();
  summary.unknown_entries = reader->unknown_entries();
  summary.shapes = reader->shapes();
  summary.counts_agree = agree(summary);
  return summary;
}

} // namespace

double GloveSummary::rate_hz() const noexcept {
  const double seconds = to_seconds(last - first);
  return samples < 2 || seconds <= 0.0 ? 0.0 : static_cast<double>(samples - 1) / seconds;
}

HostClock::duration TakeSummary::duration() const noexcept {
  const HostTime end = ending ? ending->host : last;
  return std::max(end - setup.begun_host, HostClock::duration::zero());
}

bool TakeSummary::is_whole() const noexcept {
  return damage_count == 0 && unknown_entries == 0 && counts_agree && ticks_out_of_order == 0 &&
         std::all_of(gloves.begin(), gloves.end(),
                     [](const auto& glove) { return glove.out_of_order == 0; });
}

Result<TakeSummary> summarise(const std::filesystem::path& path) {
  return summary_of(TakeReader::open(path));
}

Result<TakeSummary> summarise(std::span<const std::byte> bytes, std::string_view name) {
  return summary_of(TakeReader::of(bytes, name));
}

} // namespace nendo::recording
