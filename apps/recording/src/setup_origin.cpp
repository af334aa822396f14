// How the model came from the file's before a recording began.

#include <algorithm>

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

/// What of an origin stands in its first chunk alone.
void put_change(ByteWriter& writer, const ModelOrigin& origin) {
  writer.f64_le(origin.seam_width);
  writer.u32_le(origin.part);
  writer.u32_le(static_cast<std::uint32_t>(origin.wire.size()));
  for (const deform::WirePlace& place : origin.wire)
    for (const Eigen::Vector3d& end : {place.from, place.to})
      for (const double coordinate : end)
        writer.f64_le(coordinate);
}

void read_change(ByteReader& reader, CheckedReader& checked, ModelOrigin& origin) {
  origin.seam_width = checked.number(0.0, largest_coordinate);
  origin.part = reader.u32_le();
  const std::uint32_t places = reader.u32_le();
  checked.require(places <= flow::WirePath::max_places);
  for (std::uint32_t at = 0; checked.fine() && at < places; ++at) {
    deform::WirePlace& place = origin.wire.emplace_back();
    for (Eigen::Vector3d* const end : {&place.from, &place.to})
      for (double& coordinate : *end)
        coordinate = checked.number(-largest_coordinate, largest_coordinate);
  }
}

void read_operations(ByteReader& reader, CheckedReader& checked, ModelOrigin& origin) {
  checked.require(reader.remaining() % operation_bytes == 0);
  while (checked.fine() && reader.remaining() > 0) {
    EdgeOperation& operation = origin.refining.emplace_back();
    operation.kind = checked.one_of(EdgeOperation::Kind::flip);
    operation.from = reader.u32_le();
    operation.to = reader.u32_le();
  }
}

void read_vertices(ByteReader& reader, CheckedReader& checked, ModelOrigin& origin) {
  checked.require(reader.remaining() % vertex_bytes == 0);
  if (!checked.fine()) return;
  const Eigen::Index first = origin.shape.cols();
  origin.shape.conservativeResize(
      3, first + static_cast<Eigen::Index>(reader.remaining() / vertex_bytes));
  for (Eigen::Index at = first; at < origin.shape.cols(); ++at)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      origin.shape(axis, at) = checked.number(-largest_coordinate, largest_coordinate);
}

} // namespace

namespace {

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
  writer.u8(static_cast<std::uint8_t>(origin.source));
  writer.u8(chunk > 0 ? 1 : origin.keeps_rest ? 2 : 0);
  const std::size_t first = chunk * max_of_chunk(origin);
  const std::size_t end = first + max_of_chunk(origin);
  if (is_of_shape(origin.source)) {
    if (chunk == 0) put_change(writer, origin);
    const auto count = static_cast<std::size_t>(origin.shape.cols());
    for (std::size_t at = first; at < std::min(end, count); ++at)
      for (const double coordinate : origin.shape.col(static_cast<Eigen::Index>(at)))
        writer.f64_le(coordinate);
    return;
  }
  for (std::size_t at = first; at < std::min(end, origin.refining.size()); ++at) {
    writer.u8(static_cast<std::uint8_t>(origin.refining[at].kind));
    writer.u32_le(origin.refining[at].from);
    writer.u32_le(origin.refining[at].to);
  }
}

bool read_origin(std::span<const std::byte> payload, std::optional<LoopSetup>& loop) {
  ByteReader reader(payload);
  CheckedReader checked(reader);
  const auto source = checked.one_of(ModelSource::topology);
  const std::uint8_t kind = reader.u8();
  const bool goes_on = kind == 1;
  checked.require(kind < 2 || (kind == 2 && is_of_shape(source)));
  if (!loop || !checked.fine() || source == ModelSource::kept) return false;
  if (goes_on && (loop->origins.empty() || loop->origins.back()->source != source)) return false;
  ModelOrigin origin;
  if (goes_on) origin = *loop->origins.back();
  origin.source = source;
  origin.keeps_rest = origin.keeps_rest || kind == 2;
  if (is_of_shape(source)) {
    if (!goes_on) read_change(reader, checked, origin);
    read_vertices(reader, checked, origin);
  } else {
    read_operations(reader, checked, origin);
  }
  if (!checked.fine()) return false;
  if (goes_on) loop->origins.pop_back();
  loop->origins.push_back(std::make_shared<const ModelOrigin>(std::move(origin)));
  return true;
}

} // namespace nendo::recording
