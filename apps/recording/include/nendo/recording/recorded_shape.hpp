#pragma once
// A shape in a recording. A replay does not need it. It is for programs that have no loop, and for
// a comparison with the result of a replay on another machine.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/base/byte_writer.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/recording/chunk_file.hpp>

namespace nendo::recording {

struct RecordedShape {
  std::uint64_t tick = 0; ///< the number of the tick that made it
  std::vector<float> xyz; ///< model units, x y z of one vertex after another
};

inline constexpr ChunkType shape_chunk = chunk_type("SHAP");
/// The greatest number of vertices that a chunk has room for.
inline constexpr std::size_t max_recorded_vertices = (max_payload_bytes - 12) / 12;

NENDO_API RecordedShape shape_of(std::uint64_t tick, const deform::Points& vertices);
/// Writes the payload of a chunk. The shape must have at most max_recorded_vertices.
NENDO_API void put_shape(ByteWriter& writer, const RecordedShape& shape);
/// Returns nothing if the payload is not what put_shape() writes, or has a number that is not
/// finite.
NENDO_API std::optional<RecordedShape> read_shape(std::span<const std::byte> payload);

/// Returns the greatest distance between a vertex of `shape` and the same vertex of `vertices`, in
/// model units. Returns nothing if the numbers of vertices differ.
NENDO_API std::optional<double> distance_between(const RecordedShape& shape,
                                                 const deform::Points& vertices);

} // namespace nendo::recording
