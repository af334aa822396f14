#include <nendo/recording/recorded_shape.hpp>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include <nendo/base/byte_reader.hpp>

namespace nendo::recording {

RecordedShape shape_of(std::uint64_t tick, const deform::Points& vertices) {
  RecordedShape shape;
  shape.tick = tick;
  shape.xyz.resize(static_cast<std::size_t>(vertices.size()));
  Eigen::Matrix3Xf::Map(shape.xyz.data(), 3, vertices.cols()) = vertices.cast<float>();
  return shape;
}

void put_shape(ByteWriter& writer, const RecordedShape& shape) {
  assert(shape.xyz.size() <= 3 * max_recorded_vertices);
  writer.u64_le(shape.tick);
  writer.u32_le(static_cast<std::uint32_t>(shape.xyz.size() / 3));
  for (const float coordinate : shape.xyz)
    writer.u32_le(std::bit_cast<std::uint32_t>(coordinate));
}

std::optional<RecordedShape> read_shape(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  RecordedShape shape;
  shape.tick = reader.u64_le();
  const std::size_t vertices = reader.u32_le();
  if (reader.overrun() || 12 + 12 * vertices > payload.size()) return std::nullopt;
  shape.xyz.resize(3 * vertices);
  for (float& coordinate : shape.xyz)
    coordinate = std::bit_cast<float>(reader.u32_le());
  const bool finite = std::all_of(shape.xyz.begin(), shape.xyz.end(),
                                  [](float coordinate) { return std::isfinite(coordinate); });
  if (!finite) return std::nullopt;
  return shape;
}

std::optional<double> distance_between(const RecordedShape& shape, const deform::Points& vertices) {
  if (static_cast<Eigen::Index>(shape.xyz.size()) != vertices.size()) return std::nullopt;
  if (vertices.cols() == 0) return 0.0;
  const auto recorded = Eigen::Matrix3Xf::Map(shape.xyz.data(), 3, vertices.cols());
  return (recorded.cast<double>() - vertices).colwise().norm().maxCoeff();
}

} // namespace nendo::recording
