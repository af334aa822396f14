// Recordings from anywhere: whole files, and payloads whose checksums fit, which bytes at random
// never do.

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_tools.hpp>

#include "laws.hpp"
#include "support/test_meshes.hpp"

using namespace nendo;
using namespace nendo::recording;

namespace {

/// A file of the payloads that the input is cut into: a byte for the type, two for the length.
std::vector<std::byte> framed(std::span<const std::byte> input) {
  constexpr std::array types{chunk_type("HEAD"), chunk_type("GLOV"), chunk_type("HAND"),
                             chunk_type("LOOP"), chunk_type("TAPE"), chunk_type("END "),
                             chunk_type("WHAT")};
  std::vector<std::byte> file;
  ByteWriter(file).bytes(file_header());
  ByteReader reader(input);
  for (std::uint32_t number = 0; reader.remaining() > 0; ++number) {
    const ChunkType type = types[reader.u8() % types.size()];
    append_chunk(file, type, number, reader.take(reader.u16_le()));
  }
  return file;
}

void replay(const Setup& setup, const std::vector<Entry>& entries) {
  constexpr int max_ticks = 20;
  static const deform::Mesh model = test::sphere(6, 8, 1.0);
  // Memory that a setup may ask for is not what is looked for here.
  const auto replayed = LoopReplay::make(setup, model);
  if (!replayed) return;
  int ticks = 0;
  int finer = 0; // models, each of which is four times as large as the one before
  for (const Entry& entry : entries) {
    const auto* const change = std::get_if<flow::ChangeModel>(&entry);
    if (change != nullptr && change->is_new() && ++finer > 3) continue;
    if ((*replayed)->feed(entry) && ++ticks == max_ticks) break;
  }
  require((*replayed)->loop().final_shape().allFinite());
}

void sum_up(std::span<const std::byte> file, const std::vector<Entry>& entries) {
  const auto summary = summarise(file, "fuzz");
  require(summary && summary->gloves.size() == summary->setup.gloves.size());
  std::uint64_t samples = 0;
  for (const auto& glove : summary->gloves)
    samples += glove.samples;
  require(samples == static_cast<std::uint64_t>(
                         std::count_if(entries.begin(), entries.end(), [](const Entry& entry) {
                           return std::holds_alternative<RecordedSample>(entry);
                         })));
}

void read(std::span<const std::byte> file) {
  auto reader = TakeReader::of(file, "fuzz");
  if (!reader) {
    require_one_line(reader.error(), "");
    return;
  }
  Setup setup = reader->setup();
  std::vector<Entry> entries;
  while (const auto entry = reader->next()) {
    entries.push_back(*entry);
    require(entries.size() <= 2 * file.size()); // nothing comes out of nothing
  }
  require(reader->chunks().good_end() <= file.size());
  sum_up(file, entries);
  if (setup.loop) {
    auto& deformer = setup.loop->options.sculptor.deformer;
    deformer.undo_bytes = std::min<std::size_t>(deformer.undo_bytes, 1 << 16);
    if (deformer.injective)
      deformer.injective->max_links = std::min(deformer.injective->max_links, 8);
    replay(setup, entries);
  }
  // What was read is written and read again to the same bytes.
  std::uint32_t chunks = 0;
  const auto bytes = setup_bytes(setup, chunks);
  const auto again = TakeReader::of(bytes, "again");
  require(static_cast<bool>(again) && again->unknown_entries() == 0);
  std::uint32_t chunks_again = 0;
  require(setup_bytes(again->setup(), chunks_again) == bytes);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data, size));
  if ((data[0] & 1U) != 0) {
    read(framed(bytes.subspan(1)));
  } else {
    read(bytes.subspan(1));
  }
  return 0;
}
