// How the model came from the file's before a recording began.

#include <algorithm>
#include <type_traits>

#include <nendo/flow/wire_path.hpp>

#include "setup_parts.hpp"

namespace nendo::recording {

using deform::EdgeOperation;
using flow::ModelOrigin;
using flow::ModelSource;

namespace {

constexpr std::size_t operation_bytes = 9;
constexpr std::size_t vertex_bytes = 24;
constexpr double largest_coordinate = 1e100;

} // namespace

std::size_t plain_origins(const LoopSetup& loop) noexcept {
  const auto most = std::min(loop.origins.size(), max_plain_origins);
  const auto first = loop.origins.begin();
  const auto end = first + static_cast<std::ptrdiff_t>(most);
  return static_cast<std::size_t>(
      std::find_if(first, end,
                   [](const auto& origin) { return origin->source != ModelSource::subdivided; }) -
      first);
}

namespace {

/// The values of an origin that only its first chunk has.
void change_fields(auto& fields, auto& origin) {
  fields.number(origin.seam_width, 0.0, largest_coordinate);
  fields.u32(origin.part);
  auto places = static_cast<std::uint32_t>(origin.wire.size());
  fields.whole(places, 0, flow::WirePath::max_places);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads)
    origin.wire.resize(std::min<std::size_t>(places, flow::WirePath::max_places));
  for (auto& place : origin.wire)
    for (auto* const end : {&place.from, &place.to})
      for (auto& coordinate : *end)
        fields.number(coordinate, -largest_coordinate, largest_coordinate);
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
      fields.number(origin.shape(axis, at), -largest_coordinate, largest_coordinate);
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
