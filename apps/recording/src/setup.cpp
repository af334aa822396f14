#include <nendo/recording/setup.hpp>

#include <bit>
#include <utility>

#include <nendo/base/crc32c.hpp>
#include <nendo/driver/sample_record.hpp>

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

std::vector<std::byte> setup_bytes(const Setup& setup, std::uint32_t& chunks) {
  std::vector<std::byte> bytes;
  std::vector<std::byte> payload;
  ByteWriter(bytes).bytes(driver::file_header());
  chunks = 0;
  const auto append = [&](driver::ChunkType type, auto&& fill) {
    payload.clear();
    fill(ByteWriter(payload));
    driver::append_chunk(bytes, type, chunks++, payload);
  };
  append(head_chunk, [&](ByteWriter writer) { put_head(writer, setup); });
  for (std::size_t at = 0; at < setup.gloves.size(); ++at) {
    append(driver::glove_chunk, [&](ByteWriter writer) {
      driver::put_glove(writer, {static_cast<std::uint8_t>(at), setup.gloves[at]});
    });
  }
  for (std::size_t at = 0; at < setup.hands.size(); ++at) {
    append(hand_chunk, [&](ByteWriter writer) {
      put_hand(writer, static_cast<std::uint8_t>(at), setup.hands[at]);
    });
  }
  if (setup.loop) append(loop_chunk, [&](ByteWriter writer) { put_loop(writer, *setup.loop); });
  return bytes;
}

bool read_setup_chunk(driver::ChunkType type, std::span<const std::byte> payload, Setup& setup) {
  ByteReader reader(payload);
  if (type == head_chunk) return read_head(reader, setup);
  if (type == hand_chunk) return read_hand(reader, setup.hands);
  if (type == loop_chunk) return read_loop(reader, setup.loop);
  if (type != driver::glove_chunk) return true;
  auto glove = driver::glove_of(payload);
  if (!glove || glove->number != setup.gloves.size()) return false;
  setup.gloves.push_back(std::move(glove->info));
  return true;
}

} // namespace nendo::recording
