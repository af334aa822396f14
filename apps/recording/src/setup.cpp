#include <nendo/recording/setup.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include <nendo/base/crc32c.hpp>
#include <nendo/flow/wire_path.hpp>
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
  if (!std::ranges::equal(blocks, unchanged))
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
  for (const RecordedTracker& tracker : setup.trackers) {
    const auto hand = std::ranges::find_if(setup.hands, [&](const flow::HandInput& input) {
      return input.side == tracker.side && input.wrist_source;
    });
    if (hand == setup.hands.end()) continue;
    append(tracker_chunk,
           [&](ByteWriter writer) { put_tracker(writer, tracker, hand->wrist_source->tracking); });
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
  if (type == tracker_chunk) return read_tracker(reader, setup);
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

bool is_in_range(double value) noexcept {
  return value >= min_number && value <= max_number;
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
  if (type == tracker_chunk)
    return "a tracker's mount has a number that no mount has; calibrate it again";
  if (type == loop_chunk && setup.loop) return reason_of_loop(*setup.loop);
  if (type == puppet_chunk && setup.loop && setup.loop->puppet.text.size() > max_text_bytes)
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

using deform::EdgeOperation;
using flow::ModelOrigin;
using flow::ModelSource;

namespace {

constexpr std::size_t operation_bytes = 9;
constexpr std::size_t vertex_bytes = 24;

} // namespace

std::size_t plain_origins(const LoopSetup& loop) noexcept {
  const std::size_t max = std::min(loop.origins.size(), max_plain_origins);
  std::size_t count = 0;
  while (count < max && loop.origins[count]->source == ModelSource::subdivided)
    ++count;
  return count;
}

namespace {

/// The values of an origin that only its first chunk has.
void change_fields(auto& fields, auto& origin) {
  fields.number(origin.seam_width, 0.0, max_number);
  fields.u32(origin.part);
  auto places = static_cast<std::uint32_t>(origin.wire.size());
  fields.whole(places, 0, flow::WirePath::max_places);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads)
    origin.wire.resize(std::min<std::size_t>(places, flow::WirePath::max_places));
  for (auto& place : origin.wire)
    for (auto* const end : {&place.from, &place.to})
      for (auto& coordinate : *end)
        fields.number(coordinate, -max_number, max_number);
}

void operation_fields(auto& fields, auto& operation) {
  fields.one_of(operation.kind, EdgeOperation::Kind::flip);
  fields.u32(operation.from);
  fields.u32(operation.to);
}

void read_operations(ByteReader& reader, FieldReader& fields, ModelOrigin& origin) {
  fields.require(reader.remaining() % operation_bytes == 0);
  while (fields.fine() && reader.remaining() > 0)
    operation_fields(fields, origin.refining.emplace_back());
}

void read_vertices(ByteReader& reader, FieldReader& fields, ModelOrigin& origin) {
  fields.require(reader.remaining() % vertex_bytes == 0);
  if (!fields.fine()) return;
  const Eigen::Index first = origin.shape.cols();
  origin.shape.conservativeResize(
      3, first + static_cast<Eigen::Index>(reader.remaining() / vertex_bytes));
  for (Eigen::Index at = first; at < origin.shape.cols(); ++at)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      fields.number(origin.shape(axis, at), -max_number, max_number);
}

std::size_t max_of_chunk(const ModelOrigin& origin) noexcept {
  return is_of_shape(origin.source) ? max_vertices_of_chunk : max_operations_of_chunk;
}

} // namespace

std::size_t origin_chunks(const ModelOrigin& origin) noexcept {
  const std::size_t all = is_of_shape(origin.source) ? static_cast<std::size_t>(origin.shape.cols())
                                                     : origin.refining.size();
  const std::size_t most = max_of_chunk(origin);
  return std::max<std::size_t>(1, (all + most - 1) / most);
}

void put_origin(ByteWriter& writer, const ModelOrigin& origin, std::size_t chunk) {
  FieldWriter fields(writer);
  fields.one_of(origin.source, ModelSource::topology);
  writer.u8(chunk > 0 ? 1 : origin.keeps_rest ? 2 : 0);
  const std::size_t first = chunk * max_of_chunk(origin);
  const std::size_t end = first + max_of_chunk(origin);
  if (is_of_shape(origin.source)) {
    if (chunk == 0) change_fields(fields, origin);
    const auto count = static_cast<std::size_t>(origin.shape.cols());
    for (std::size_t at = first; at < std::min(end, count); ++at)
      for (const double coordinate : origin.shape.col(static_cast<Eigen::Index>(at)))
        writer.f64_le(coordinate);
    return;
  }
  for (std::size_t at = first; at < std::min(end, origin.refining.size()); ++at)
    operation_fields(fields, origin.refining[at]);
}

bool read_origin(std::span<const std::byte> payload, std::optional<LoopSetup>& loop) {
  ByteReader reader(payload);
  FieldReader fields(reader);
  ModelSource source{};
  fields.one_of(source, ModelSource::topology);
  const std::uint8_t kind = reader.u8();
  const bool goes_on = kind == 1;
  fields.require(kind < 2 || (kind == 2 && is_of_shape(source)));
  if (!loop || !fields.fine() || source == ModelSource::kept) return false;
  if (goes_on && (loop->origins.empty() || loop->origins.back()->source != source)) return false;
  ModelOrigin origin;
  if (goes_on) origin = *loop->origins.back();
  origin.source = source;
  origin.keeps_rest = origin.keeps_rest || kind == 2;
  if (is_of_shape(source)) {
    if (!goes_on) change_fields(fields, origin);
    read_vertices(reader, fields, origin);
  } else {
    read_operations(reader, fields, origin);
  }
  if (!fields.fine()) return false;
  if (goes_on) loop->origins.pop_back();
  loop->origins.push_back(std::make_shared<const ModelOrigin>(std::move(origin)));
  return true;
}

} // namespace nendo::recording
