#pragma once
// Reads and writes the single chunks of a setup, which FORMAT.md describes. Enumerators are written
// as their numbers, so new ones must be added at the ends of their lists, here and in the document.

#include <nendo/base/byte_reader.hpp>
#include <nendo/base/byte_writer.hpp>
#include <nendo/driver/sample_record.hpp>
#include <nendo/recording/setup.hpp>

namespace nendo::recording {

inline constexpr driver::ChunkType head_chunk = driver::chunk_type("HEAD");
inline constexpr driver::ChunkType hand_chunk = driver::chunk_type("HAND");
inline constexpr driver::ChunkType loop_chunk = driver::chunk_type("LOOP");

constexpr bool is_setup_chunk(driver::ChunkType type) noexcept {
  return type == head_chunk || type == hand_chunk || type == loop_chunk ||
         type == driver::glove_chunk;
}

void put_head(ByteWriter& writer, const Setup& setup);
void put_hand(ByteWriter& writer, std::uint8_t number, const flow::HandInput& hand);
void put_loop(ByteWriter& writer, const LoopSetup& loop);

// These return false if the payload is not usable. Then nothing has changed.
bool read_head(ByteReader& reader, Setup& setup);
bool read_hand(ByteReader& reader, std::vector<flow::HandInput>& hands);
bool read_loop(ByteReader& reader, std::optional<LoopSetup>& loop);

} // namespace nendo::recording
