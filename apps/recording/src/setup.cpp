#include <nendo/recording/setup.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
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

namespace {

constexpr double farthest_wrist_m = 1e6; // as setup_loop.cpp reads
constexpr double largest_readable = 1e100;
constexpr double min_readable = 1e-100;
constexpr std::size_t max_puppet_text = std::size_t{1} << 20;

bool is_in_range(double value) noexcept {
  return value >= min_readable && value <= largest_readable;
}

/// The value of a loop that is out of its range, and what to do.
std::string reason_of_loop(const LoopSetup& loop) {
  if (loop.mesh.size() > UINT16_MAX)
    return "the models' names are too long; run it in their folder";
  if (!is_in_range(loop.placement.units_per_metre))
    return "the model's size is not within 1e-100 and 1e100; scale it";
  for (const auto& wrist : loop.placement.T_stage_wrist)
    if (!(wrist.translation().cwiseAbs().maxCoeff() <= farthest_wrist_m))
      return "a hand is more than 1000 km from the model's middle; take out the vertices that "
             "lie so far away, or move the hand nearer";
  const auto& supports = loop.options.sculptor.deformer.supports;
  if (!supports.are_usable() || !is_in_range(loop.options.sculptor.piece_length))
    return "a radius is not within 1e-98 and 1e100 model units; choose another --radius";
  return "a setting of the loop is out of its range; leave out the options that you do not need";
}

std::string reason_of(ChunkType type, const Setup& setup) {
  if (type == hand_chunk)
    return "a hand's size, calibration or filter has a number that no hand has; calibrate again, "
           "or use --calibration none";
  if (type == loop_chunk && setup.loop) return reason_of_loop(*setup.loop);
  if (type == puppet_chunk && setup.loop && setup.loop->puppet.text.size() > max_puppet_text)
    return "its puppet is longer than 1 MiB; take functions or masks out of it";
  if (type == puppet_chunk)
    return "its puppet has a number that is out of its range; correct its file";
  if (type == rest_chunk || type == origin_chunk)
    return "the shape has a vertex that is too far away; reset it first";
  return "what describes the gloves cannot be read; name other gloves";
}

} // namespace

Result<void> check_readable(const Setup& setup, std::span<const std::byte> bytes) {
  if (setup.loop && setup.loop->mesh.size() > UINT16_MAX) // a writer cuts strings off there
    return Error{Errc::failed, "this run cannot be recorded: " + reason_of_loop(*setup.loop)};
  auto chunks = ChunkReader::of(bytes, "the recording");
  if (!chunks) return chunks.error();
  Setup read;
  while (const auto chunk = chunks->next()) {
    if (!read_setup_chunk(chunk->type, chunk->payload, read))
      return Error{Errc::failed, "this run cannot be recorded: " + reason_of(chunk->type, setup)};
  }
  if (chunks->damage_count() == 0) return {};
  return Error{Errc::failed, "this run cannot be recorded: its shape does not fit; reset it first"};
}

} // namespace nendo::recording
