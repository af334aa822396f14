#include <nendo/recording/take_tools.hpp>

#include <utility>

#include "take_copy.hpp"

namespace nendo::recording {
namespace {

/// Entries that belong together: all that a tick took, or one sample where no loop ran.
class Groups {
public:
  explicit Groups(TakeReader& reader) : reader_(reader) {}

  struct Group {
    std::vector<Entry> entries;
    std::optional<HostTime> time; ///< nothing: of a rest that no tick has taken
  };
  std::optional<Group> next() {
    Group group;
    while (auto entry = reader_.next()) {
      const auto* tick = std::get_if<flow::LoggedTick>(&*entry);
      const auto* sample = std::get_if<driver::RecordedSample>(&*entry);
      const bool has_loop = reader_.setup().loop.has_value();
      if (tick != nullptr) group.time = tick->woke;
      if (sample != nullptr && !has_loop) group.time = sample->sample.arrival;
      group.entries.push_back(*std::move(entry));
      // A file that has no tick for long is no reason to hold all of it.
      if (group.time || group.entries.size() >= most_entries) return group;
    }
    if (group.entries.empty()) return std::nullopt;
    return group;
  }

private:
  static constexpr std::size_t most_entries = std::size_t{1} << 16;
  TakeReader& reader_;
};

Error nothing(const std::filesystem::path& from, const std::string& what) {
  return Error{Errc::bad_input, from.string() + ": " + what};
}

Result<std::uint64_t> append_all(TakeFile& file, driver::ChunkReader& reader, driver::Chunk chunk) {
  std::vector<std::byte> gap;
  ByteWriter writer(gap);
  put_entry(writer, Gap{});
  std::uint64_t chunks = 0;
  std::uint64_t damages = 0;
  for (std::optional<driver::Chunk> next = chunk; next; next = reader.next()) {
    // Not among the chunks of the setup, which stand before the first input log.
    const bool here = next->type == driver::tape_chunk || next->type == ending_chunk;
    if (here && std::exchange(damages, reader.damage_count()) != reader.damage_count()) {
      if (const auto written = file.append(driver::tape_chunk, gap); !written)
        return written.error();
    }
    if (const auto written = file.append(next->type, next->payload); !written)
      return written.error();
    ++chunks;
  }
  return chunks;
}

} // namespace

Result<NewTake> repair_take(const std::filesystem::path& from, const std::filesystem::path& to) {
  auto reader = driver::ChunkReader::open_damaged(from);
  if (!reader) return reader.error();
  const auto first = reader->next();
  if (!first) return nothing(from, "nothing in it is whole; there is nothing to save");
  auto file = TakeFile::create(to, driver::file_header(), 0, TakeFile::Kind::copy);
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
  auto group = groups.next();
  for (; group && (!group->time || *group->time < first); group = groups.next())
    left_out += group->entries.size();
  if (!group || *group->time >= last)
    return nothing(from, "nothing happened in that part of it; `nendo recording info` tells how "
                         "long it is");
  if (left_out > 0) {
    setup.begun += std::chrono::duration_cast<std::chrono::nanoseconds>(begin);
    setup.begun_host = first;
  }
  auto copy = TakeCopy::create(to, setup);
  if (!copy) return copy.error();
  if (left_out > 0) {
    if (const auto put = copy->put(Gap{left_out}); !put) return put.error();
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

} // namespace nendo::recording
