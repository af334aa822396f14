#include <nendo/recording/setup.hpp>

#include <algorithm>
#include <bit>
#include <utility>

#include <nendo/base/crc32c.hpp>
#include <nendo/recording/sample_record.hpp>

#include "setup_parts.hpp"

namespace nendo::recording {

ShapeSum sum_of(const deform::Points& vertices) noexcept {
  static_assert(std::endian::native == std::endian::little);
  const std::span coordinates(vertices.data(), static_cast<std::size_t>(vertices.size()));
  return {static_cast<std::uint64_t>(vertices.cols()), crc32c(std::as_bytes(coordinates))};
}

Setup begin_setup(std::string program) {
  Setup setup;
  setup.begun = std::chrono::system_clock::now();
  setup.begun_host = HostClock::now();
  setup.program = std::move(program);
  return setup;
}

void continue_from(const flow::LoopState& state, const deform::BlockLayout& layout, Setup& setup) {
  for (std::size_t at = 0; at < setup.hands.size(); ++at) {
    flow::HandInput& hand = setup.hands[at];
    hand.first = state.inputs[at].latest;
    hand.wearer.learned = state.inputs[at].learned;
    hand.wearer.stuck = state.inputs[at].stuck;
    hand.layer = state.inputs[at].layer;
    hand.filter = state.sculptor.settings.filter;
  }
  LoopSetup& loop = *setup.loop;
  loop.placement = state.placement;
  loop.options.sculptor = state.sculptor.options;
  loop.options.held = state.held;
  loop.options.rig_state = state.rig;
  loop.options.rig = state.puppet;
  loop.puppet = state.puppet ? RecordedPuppet{state.puppet->puppet().text, state.puppet->starts()}
                             : RecordedPuppet{};
  loop.origins.insert(loop.origins.end(), state.origins.begin(), state.origins.end());
  loop.options.settings = state.sculptor.settings;
  const auto blocks = std::as_bytes(std::span(state.shape.data(), state.shape.block_count()));
  const deform::BlockShape original = layout.pack();
  const auto unchanged = std::as_bytes(std::span(original.data(), original.block_count()));
  loop.rest.clear();
  if (!std::equal(blocks.begin(), blocks.end(), unchanged.begin(), unchanged.end()))
    loop.rest.assign(state.shape.data(), state.shape.data() + state.shape.block_count());
}

Result<std::shared_ptr<const puppet::Rig>> rig_of(const RecordedPuppet& recorded,
                                                  const deform::Mesh& model) {
  auto read = puppet::parse_puppet(recorded.text, "the recorded puppet");
  if (!read) return read.error();
  if (const auto fits = puppet::check_fits(*read, model); !fits) return fits.error();
  if (static_cast<std::size_t>(recorded.starts.cols()) != read->points.size())
    return Error{Errc::bad_input, "the recorded puppet has other points than its text"};
  return std::make_shared<const puppet::Rig>(*std::move(read), recorded.starts);
}

std::vector<std::byte> setup_bytes(const Setup& setup, std::uint32_t& chunks) {
  std::vector<std::byte> bytes;
  std::vector<std::byte> payload;
  ByteWriter(bytes).bytes(file_header());
  chunks = 0;
  const auto append = [&](ChunkType type, auto&& fill) {
    payload.clear();
    fill(ByteWriter(payload));
    append_chunk(bytes, type, chunks++, payload);
  };
  append(head_chunk, [&](ByteWriter writer) { put_head(writer, setup); });
  for (std::size_t at = 0; at < setup.gloves.size(); ++at) {
    append(glove_chunk, [&](ByteWriter writer) {
      put_glove(writer, {static_cast<std::uint8_t>(at), setup.gloves[at]});
    });
  }
  for (std::size_t at = 0; at < setup.hands.size(); ++at) {
    append(hand_chunk, [&](ByteWriter writer) {
      put_hand(writer, static_cast<std::uint8_t>(at), setup.hands[at]);
    });
  }
  if (!setup.loop) return bytes;
  append(loop_chunk, [&](ByteWriter writer) { put_loop(writer, *setup.loop); });
  if (!setup.loop->puppet.text.empty())
    append(puppet_chunk, [&](ByteWriter writer) { put_puppet(writer, *setup.loop); });
  for (std::size_t at = plain_origins(*setup.loop); at < setup.loop->origins.size(); ++at) {
    const flow::ModelOrigin& origin = *setup.loop->origins[at];
    for (std::size_t chunk = 0; chunk < origin_chunks(origin); ++chunk)
      append(origin_chunk, [&](ByteWriter writer) { put_origin(writer, origin, chunk); });
  }
  std::span<const deform::VertexBlock> rest(setup.loop->rest);
  while (!rest.empty()) {
    const std::size_t count = std::min(rest.size(), max_blocks_of_chunk);
    append(rest_chunk, [&](ByteWriter writer) { put_rest(writer, rest.first(count)); });
    rest = rest.subspan(count);
  }
  return bytes;
}

bool read_setup_chunk(ChunkType type, std::span<const std::byte> payload, Setup& setup) {
  ByteReader reader(payload);
  if (type == head_chunk) return read_head(reader, setup);
  if (type == hand_chunk) return read_hand(reader, setup.hands);
  if (type == loop_chunk) return read_loop(reader, setup.loop);
  if (type == puppet_chunk) return read_puppet(reader, setup.loop);
  if (type == origin_chunk) return read_origin(payload, setup.loop);
  if (type == rest_chunk) return read_rest(payload, setup.loop);
  if (type != glove_chunk) return true;
  auto glove = glove_of(payload);
  if (!glove || glove->number != setup.gloves.size()) return false;
  setup.gloves.push_back(std::move(glove->info));
  return true;
}

} // namespace nendo::recording
