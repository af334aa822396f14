#include "osc/osc_packet.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace nendo::driver::osc {
namespace {

using OscBytes = std::span<const std::byte>;

/// Removes `count` bytes, at most 8, from `rest`, and returns the number that they are. Returns
/// nothing if there are fewer.
std::optional<std::uint64_t> take_big_endian(OscBytes& rest, std::size_t count) noexcept {
  if (rest.size() < count) return std::nullopt;
  std::uint64_t number = 0;
  for (const std::byte byte : rest.first(count))
    number = number << 8U | std::to_integer<std::uint64_t>(byte);
  rest = rest.subspan(count);
  return number;
}

std::optional<std::string_view> take_string(OscBytes& rest) noexcept {
  const auto end = std::find(rest.begin(), rest.end(), std::byte{0});
  if (end == rest.end()) return std::nullopt;
  const auto length = static_cast<std::size_t>(end - rest.begin());
  const std::size_t padded = (length / 4 + 1) * 4;
  if (padded > rest.size()) return std::nullopt;
  const std::string_view text(reinterpret_cast<const char*>(rest.data()), length);
  rest = rest.subspan(padded);
  return text;
}

bool is_bundle(OscBytes packet) noexcept {
  return packet.size() >= bundle_mark.size() &&
         std::equal(bundle_mark.begin(), bundle_mark.end(), packet.begin(),
                    [](char c, std::byte byte) { return std::byte(c) == byte; });
}

/// Returns the time since 2020 of an NTP time: 32 bits of seconds since 1900, and as many of their
/// fraction. NTP's seconds begin again in 2036; of all eras, the time nearest to 2020 is meant.
std::chrono::nanoseconds since_2020(std::uint64_t ntp) noexcept {
  constexpr std::uint32_t ntp_of_2020 = 3'786'825'600;
  const auto seconds =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(ntp >> 32U) - ntp_of_2020);
  const std::uint64_t fraction_ns = (ntp & 0xFFFF'FFFFU) * 1'000'000'000U >> 32U;
  return std::chrono::seconds(seconds) +
         std::chrono::nanoseconds(static_cast<std::int64_t>(fraction_ns));
}

std::optional<Message> read_message(OscBytes rest) noexcept {
  const auto address = take_string(rest);
  if (!address || !address->starts_with('/')) return std::nullopt;
  const auto types = take_string(rest);
  if (!types || !types->starts_with(',')) return std::nullopt;
  return Message{*address, types->substr(1), rest, std::nullopt};
}

std::optional<double> take_number(OscBytes& rest, char type) noexcept {
  const auto bits = take_big_endian(rest, type == 'd' ? 8 : 4);
  if (!bits) return std::nullopt;
  switch (type) {
  case 'd':
    return std::bit_cast<double>(*bits);
  case 'f':
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(*bits)));
  case 'i':
    return static_cast<double>(static_cast<std::int32_t>(*bits));
  default:
    return std::nullopt;
  }
}

} // namespace

/// Of a packet that is no bundle, that is all of it, once.
std::optional<MessageReader::Bytes> MessageReader::next_element() noexcept {
  if (packet_) return std::exchange(packet_, std::nullopt);
  while (depth_ > 0 && bundles_[depth_ - 1].rest.empty())
    --depth_;
  if (depth_ == 0) return std::nullopt;
  Bytes& rest = bundles_[depth_ - 1].rest;
  const auto size = take_big_endian(rest, 4);
  if (!size || *size > rest.size() || *size % 4 != 0) {
    is_malformed_ = true;
    return std::nullopt;
  }
  const Bytes element = rest.first(static_cast<std::size_t>(*size));
  rest = rest.subspan(element.size());
  return element;
}

bool MessageReader::enter_bundle(Bytes bytes) noexcept {
  bytes = bytes.subspan(bundle_mark.size());
  const auto tag = take_big_endian(bytes, 8);
  if (!tag || depth_ == max_nesting) return false;
  constexpr std::uint64_t immediately = 1;
  Bundle bundle{bytes, depth_ > 0 ? bundles_[depth_ - 1].time : std::nullopt};
  if (*tag > immediately) bundle.time = since_2020(*tag); // 0 is what careless programs send
  bundles_[depth_++] = bundle;
  return true;
}

std::optional<Message> MessageReader::next() noexcept {
  while (!is_malformed_) {
    const auto element = next_element();
    if (!element) break;
    if (is_bundle(*element)) {
      is_malformed_ = !enter_bundle(*element);
      continue;
    }
    auto message = read_message(*element);
    is_malformed_ = !message;
    if (message && depth_ > 0) message->time = bundles_[depth_ - 1].time;
    return message;
  }
  return std::nullopt;
}

bool is_well_formed(std::span<const std::byte> packet) noexcept {
  MessageReader reader(packet);
  while (reader.next()) {
  }
  return !reader.is_malformed();
}

bool read_numbers(const Message& message, std::span<double> numbers) noexcept {
  if (message.types.size() != numbers.size()) return false;
  OscBytes rest = message.arguments;
  for (std::size_t at = 0; at < numbers.size(); ++at) {
    const auto number = take_number(rest, message.types[at]);
    if (!number) return false;
    numbers[at] = *number;
  }
  return rest.empty();
}

} // namespace nendo::driver::osc
