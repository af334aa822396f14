#include <nendo/driver/vrpn_protocol.hpp>

#include <nendo/base/byte_writer.hpp>

namespace nendo::driver::vrpn {

std::vector<std::byte> greeting() {
  std::vector<std::byte> bytes;
  ByteWriter(bytes).bytes(std::as_bytes(std::span(cookie)));
  bytes.resize(cookie_bytes);
  return bytes;
}

void append_message(std::vector<std::byte>& out, std::int64_t time_us, std::int32_t sender,
                    std::int32_t type, std::span<const std::byte> payload) {
  constexpr std::int64_t second_us = 1'000'000;
  ByteWriter writer(out);
  writer.u32_be(static_cast<std::uint32_t>(header_bytes + payload.size()));
  writer.u32_be(static_cast<std::uint32_t>(time_us / second_us));
  writer.u32_be(static_cast<std::uint32_t>(time_us % second_us));
  writer.u32_be(static_cast<std::uint32_t>(sender));
  writer.u32_be(static_cast<std::uint32_t>(type));
  writer.u32_be(0);
  writer.bytes(payload);
  out.resize(out.size() + padded(payload.size()) - payload.size());
}

void append_name(std::vector<std::byte>& out, std::int32_t what, std::int32_t number,
                 std::string_view name) {
  std::vector<std::byte> payload;
  ByteWriter writer(payload);
  writer.u32_be(static_cast<std::uint32_t>(name.size() + 1));
  writer.bytes(std::as_bytes(std::span(name)));
  writer.u8(0);
  append_message(out, 0, number, what, payload);
}

} // namespace nendo::driver::vrpn
