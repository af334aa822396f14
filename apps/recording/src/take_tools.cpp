#include <nendo/recording/take_tools.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <nendo/recording/loop_replay.hpp>

#include "take_file.hpp"

namespace nendo::recording {
namespace {

/// Makes a recording from the entries of another one. The new file exists only if end() succeeded.
/// Error of all functions: failed.
class TakeCopy {
public:
  /// Creates the file, which must not exist yet.
  static Result<TakeCopy> create(const std::filesystem::path& path, const Setup& setup) {
    std::uint32_t chunks = 0;
    const auto bytes = setup_bytes(setup, chunks);
    auto file = TakeFile::create(path, bytes, chunks, TakeFile::Kind::copy);
    if (!file) return file.error();
    return TakeCopy(*std::move(file));
  }

  /// Appends an entry.
  Result<void> put(const Entry& entry) {
    if (const auto* puppet = std::get_if<PuppetChange>(&entry))
      if (auto written = put_puppet(*puppet); !written) return written;
    ByteWriter writer(payload_);
    put_entry(writer, entry);
    ++made_.entries;
    if (std::holds_alternative<RecordedSample>(entry)) ++ending_.samples;
    if (std::holds_alternative<flow::Request>(entry)) ++ending_.requests;
    if (std::holds_alternative<flow::LoggedTick>(entry)) ++ending_.ticks;
    return payload_.size() < chunk_bytes ? Result<void>() : flush();
  }
  /// Appends a shape after all entries so far.
  Result<void> put(const RecordedShape& shape) {
    ++made_.shapes;
    return append(shape_chunk, [&](ByteWriter& writer) { put_shape(writer, shape); });
  }
  /// Appends what the gloves have sent, if anybody has counted.
  Result<void> put(std::span<const driver::RecordCounts> sent) {
    if (sent.empty()) return {};
    return append(sent_chunk, [&](ByteWriter& writer) { put_sent(writer, sent); });
  }
  /// Writes the ending, whose time is `host`. All of it except the counts is taken from
  /// `of_original`, if given.
  Result<NewTake> end(HostTime host, const std::optional<Ending>& of_original = {}) {
    ending_.host = host;
    if (of_original) {
      ending_.lost = of_original->lost;
      ending_.shape = of_original->shape;
    }
    const auto written =
        append(ending_chunk, [this](ByteWriter& writer) { put_ending(writer, ending_); });
    if (!written) return written.error();
    if (const auto synced = file_.sync(); !synced) return synced.error();
    made_.bytes = file_.bytes();
    return made_;
  }

private:
  static constexpr std::size_t chunk_bytes = std::size_t{1} << 16;

  explicit TakeCopy(TakeFile file) : file_(std::move(file)) {}

  Result<void> flush() {
    if (payload_.empty()) return {};
    auto written = file_.append(log_chunk, payload_);
    payload_.clear();
    return written;
  }
  /// Appends a chunk that `fill` writes, after all entries so far.
  Result<void> append(ChunkType type, const auto& fill) {
    if (auto flushed = flush(); !flushed) return flushed;
    std::vector<std::byte> payload;
    ByteWriter writer(payload);
    fill(writer);
    return file_.append(type, payload);
  }

  /// Its text precedes it, once.
  Result<void> put_puppet(const PuppetChange& change) {
    if (!change.puppet || !puppets_.insert(change.number).second) return {};
    return append(puppet_version_chunk, [&](ByteWriter& writer) {
      put_puppet_version(writer, change.number, *change.puppet);
    });
  }

  TakeFile file_;
  std::set<std::uint32_t> puppets_; ///< in the file
  std::vector<std::byte> payload_;
  Ending ending_;
  NewTake made_;
};

/// Gives the entries of a recording in groups that belong together: all that a tick took, or one
/// sample where no loop ran.
class Groups {
public:
  explicit Groups(TakeReader& reader) : reader_(reader) {}

  struct Group {
    std::vector<Entry> entries;
    std::optional<HostTime> time; ///< nothing if no tick has taken the entries
  };
  std::optional<Group> next() {
    Group group;
    while (auto entry = reader_.next()) {
      const auto* tick = std::get_if<flow::LoggedTick>(&*entry);
      const auto* sample = std::get_if<RecordedSample>(&*entry);
      const bool has_loop = reader_.setup().loop.has_value();
      if (tick != nullptr) group.time = tick->woke;
      if (sample != nullptr && !has_loop) group.time = sample->sample.arrival;
      group.entries.push_back(*std::move(entry));
      // A file may have no tick for long. It must not fill the memory.
      if (group.time || group.entries.size() >= max_entries) return group;
    }
    if (group.entries.empty()) return std::nullopt;
    return group;
  }

private:
  static constexpr std::size_t max_entries = std::size_t{1} << 16;
  TakeReader& reader_;
};

Error bad_input(const std::filesystem::path& from, const std::string& what) {
  return Error{Errc::bad_input, from.string() + ": " + what};
}

Result<std::uint64_t> append_all(TakeFile& file, ChunkReader& reader, Chunk chunk) {
  std::vector<std::byte> gap;
  ByteWriter writer(gap);
  put_entry(writer, Gap{});
  std::uint64_t chunks = 0;
  std::uint64_t damages = 0;
  for (std::optional<Chunk> next = chunk; next; next = reader.next()) {
    // A gap must not be among the chunks of the setup, which come before the first input log.
    const bool here = next->type == log_chunk || next->type == ending_chunk;
    if (here && std::exchange(damages, reader.damage_count()) != reader.damage_count()) {
      if (const auto written = file.append(log_chunk, gap); !written) return written.error();
    }
    if (const auto written = file.append(next->type, next->payload); !written)
      return written.error();
    ++chunks;
  }
  return chunks;
}

/// Returns the number of ticks from one shape to the next.
std::uint64_t stride(double loop_hz, double wanted_hz) {
  return static_cast<std::uint64_t>(std::max(1.0, std::round(loop_hz / wanted_hz)));
}

} // namespace

Result<NewTake> repair_take(const std::filesystem::path& from, const std::filesystem::path& to) {
  auto reader = ChunkReader::open_damaged(from);
  if (!reader) return reader.error();
  const auto first = reader->next();
  if (!first) return bad_input(from, "nothing in it is whole; there is nothing to save");
  auto file = TakeFile::create(to, file_header(), 0, TakeFile::Kind::copy);
  if (!file) return file.error();
  const auto chunks = append_all(*file, *reader, *first);
  if (!chunks) return chunks.error();
  if (const auto synced = file->sync(); !synced) return synced.error();
  return NewTake{.bytes = file->bytes(), .chunks = *chunks, .damages = reader->damage_count()};
}

Result<NewTake> cut_take(const std::filesystem::path& from, const std::filesystem::path& to,
                         HostClock::duration begin, HostClock::duration end) {
  auto reader = TakeReader::open(from);
  if (!reader) return reader.error();
  Setup setup = reader->setup();
  const HostTime first = setup.begun_host + begin;
  const HostTime last = setup.begun_host + end;
  Groups groups(*reader);
  std::uint64_t left_out = 0;
  std::optional<Entry> settings, puppet; // the last that are left out
  std::map<std::uint8_t, Entry> layers;  // the latest, by input
  auto group = groups.next();
  for (; group && (!group->time || *group->time < first); group = groups.next()) {
    left_out += group->entries.size();
    for (const Entry& entry : group->entries) {
      if (std::holds_alternative<flow::LoopSettings>(entry)) settings = entry;
      if (std::holds_alternative<PuppetChange>(entry)) puppet = entry;
      if (const auto* layer = std::get_if<flow::SetLayer>(&entry)) layers[layer->input] = entry;
    }
  }
  if (!group || *group->time >= last)
    return bad_input(from, "nothing happened in that part of it; `nendo recording info` shows how "
                           "long it is");
  if (left_out > 0) {
    setup.begun += std::chrono::duration_cast<std::chrono::nanoseconds>(begin);
    setup.begun_host = first;
  }
  auto copy = TakeCopy::create(to, setup);
  if (!copy) return copy.error();
  if (left_out > 0) {
    if (const auto put = copy->put(Gap{left_out}); !put) return put.error();
    for (const auto& in_force : {settings, puppet})
      if (in_force)
        if (const auto put = copy->put(*in_force); !put) return put.error();
    for (const auto& [input, layer] : layers)
      if (const auto put = copy->put(layer); !put) return put.error();
  }
  HostTime ended = first;
  for (; group && group->time && *group->time < last; group = groups.next()) {
    for (const Entry& entry : group->entries) {
      if (const auto put = copy->put(entry); !put) return put.error();
    }
    ended = *group->time;
  }
  return copy->end(ended);
}

Result<NewTake> add_shapes(const std::filesystem::path& from, const std::filesystem::path& to,
                           const deform::Mesh& model, double rate_hz) {
  if (static_cast<std::size_t>(model.vertices.cols()) > max_recorded_vertices)
    return bad_input(from, "a shape in a recording has at most " +
                               std::to_string(max_recorded_vertices) + " vertices");
  auto reader = TakeReader::open(from);
  if (!reader) return reader.error();
  auto replay = LoopReplay::make(reader->setup(), model);
  if (!replay) return Error{replay.error().code, from.string() + ": " + replay.error().message};
  flow::DeformLoop& loop = (*replay)->loop();
  auto copy = TakeCopy::create(to, reader->setup());
  if (!copy) return copy.error();
  const std::uint64_t every = stride(reader->setup().loop->options.rate_hz, rate_hz);
  HostTime ended = reader->setup().begun_host;
  deform::Points vertices;
  while (const auto entry = reader->next()) {
    if (const auto put = copy->put(*entry); !put) return put.error();
    if (!(*replay)->feed(*entry)) continue;
    ended = std::get<flow::LoggedTick>(*entry).woke;
    if ((loop.stats().ticks - 1) % every != 0 || !loop.frames().update()) continue;
    const flow::Frame& frame = loop.frames().front();
    loop.changes().layout(frame.model).unpack(frame.shape, vertices);
    if (const auto put = copy->put(shape_of(frame.tick, vertices)); !put) return put.error();
  }
  if (const auto put = copy->put(reader->sent()); !put) return put.error();
  return copy->end(reader->ending() ? reader->ending()->host : ended, reader->ending());
}

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
  void operator()(const RecordedPose&) { ++summary_.poses; }
  void operator()(const flow::Recentre&) {}
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
  std::uint64_t marks_due_ = 0; ///< marks of the next tick
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
         std::ranges::all_of(gloves, [](const auto& glove) { return glove.out_of_order == 0; });
}

Result<TakeSummary> summarise(const std::filesystem::path& path) {
  return summary_of(TakeReader::open(path));
}

Result<TakeSummary> summarise(std::span<const std::byte> bytes, std::string_view name) {
  return summary_of(TakeReader::of(bytes, name));
}

} // namespace nendo::recording
