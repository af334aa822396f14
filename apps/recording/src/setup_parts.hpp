#pragma once
// Reads and writes the single chunks of a setup, which FORMAT.md describes.

#include <algorithm>
#include <optional>
#include <span>
#include <type_traits>

#include <nendo/recording/sample_record.hpp>
#include <nendo/recording/setup.hpp>

#include "fields.hpp"

namespace nendo::recording {

inline constexpr ChunkType head_chunk = chunk_type("HEAD");
inline constexpr ChunkType hand_chunk = chunk_type("HAND");
inline constexpr ChunkType loop_chunk = chunk_type("LOOP");
inline constexpr ChunkType rest_chunk = chunk_type("REST");
inline constexpr ChunkType origin_chunk = chunk_type("ORIG");
inline constexpr ChunkType puppet_chunk = chunk_type("PUPP");

constexpr bool is_setup_chunk(ChunkType type) noexcept {
  return type == head_chunk || type == hand_chunk || type == loop_chunk || type == rest_chunk ||
         type == origin_chunk || type == puppet_chunk || type == glove_chunk ||
         type == tracker_chunk;
}

/// The properties that a device reported.
void fact_fields(auto& fields, auto& facts) {
  constexpr std::size_t max_facts = 256;
  const std::size_t count = fields.count(std::min(facts.size(), max_facts), max_facts);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads) facts.resize(count);
  for (std::size_t at = 0; at < count; ++at) {
    fields.line(facts[at].name);
    fields.line(facts[at].value);
  }
}

// The bodies of entries.
inline constexpr std::size_t sample_bytes = 86;
void sample_body(FieldWriter& fields, const RecordedSample& recorded);
void sample_body(FieldReader& fields, RecordedSample& recorded);
inline constexpr std::size_t pose_bytes = 93;
void pose_body(FieldWriter& fields, const RecordedPose& recorded);
void pose_body(FieldReader& fields, RecordedPose& recorded);
inline constexpr std::size_t settings_bytes = 98;
void settings_body(FieldWriter& fields, const flow::LoopSettings& settings);
void settings_body(FieldReader& fields, flow::LoopSettings& settings);

void put_head(ByteWriter& writer, const Setup& setup);
void put_hand(ByteWriter& writer, std::uint8_t number, const flow::HandInput& hand);
/// Writes the tracker of a hand, and how its poses move the wrist.
void put_tracker(ByteWriter& writer, const RecordedTracker& tracker,
                 const hand::TrackingOptions& options);
void put_loop(ByteWriter& writer, const LoopSetup& loop);
void put_puppet(ByteWriter& writer, const LoopSetup& loop);
/// Writes some of the blocks of the shape at first. A chunk has at most max_blocks_of_chunk.
void put_rest(ByteWriter& writer, std::span<const deform::VertexBlock> blocks);
inline constexpr std::size_t max_blocks_of_chunk = std::size_t{1} << 14;

/// Of the origins, the first ones that only subdivide. LOOP has their number, and ORIG the others.
std::size_t plain_origins(const LoopSetup& loop) noexcept;
inline constexpr std::size_t max_plain_origins = 16;
/// Writes that of so many chunks of an origin. Each has at most max_operations_of_chunk of its
/// operations, or max_vertices_of_chunk of the vertices of the shape that it was made of.
void put_origin(ByteWriter& writer, const flow::ModelOrigin& origin, std::size_t chunk);
std::size_t origin_chunks(const flow::ModelOrigin& origin) noexcept;
inline constexpr std::size_t max_operations_of_chunk = std::size_t{1} << 20;
/// Of 24 bytes each: more would not go into a chunk.
inline constexpr std::size_t max_vertices_of_chunk = std::size_t{1} << 19;

// These return false if the payload is not usable. Then nothing has changed.
bool read_head(ByteReader& reader, Setup& setup);
bool read_hand(ByteReader& reader, std::vector<flow::HandInput>& hands);
bool read_tracker(ByteReader& reader, Setup& setup);
bool read_loop(ByteReader& reader, std::optional<LoopSetup>& loop);
bool read_rest(std::span<const std::byte> payload, std::optional<LoopSetup>& loop);
bool read_origin(std::span<const std::byte> payload, std::optional<LoopSetup>& loop);
bool read_puppet(ByteReader& reader, std::optional<LoopSetup>& loop);

struct NumberedPuppet {
  std::uint32_t number = 0;
  RecordedPuppet puppet;
};
/// Reads what put_puppet_version() writes. Returns nothing if it is not usable.
std::optional<NumberedPuppet> read_puppet_version(std::span<const std::byte> payload);

} // namespace nendo::recording
