#include "markers/pose_sender.hpp"

#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace nendo::markers {
namespace {

void append_number(std::string& packet, std::uint64_t number, int bytes) {
  for (int at = bytes; at-- > 0;)
    packet += static_cast<char>(number >> (8 * at) & 0xFFU);
}

void append_string(std::string& packet, std::string_view text) {
  packet += text;
  packet.append(4 - text.size() % 4, '\0');
}

std::uint64_t ntp_time(std::chrono::system_clock::time_point time) {
  constexpr std::int64_t ntp_of_1970 = 2'208'988'800;
  const auto since_1970 = time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_1970);
  const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970 - seconds);
  return static_cast<std::uint64_t>(seconds.count() + ntp_of_1970) << 32U |
         (static_cast<std::uint64_t>(rest.count()) << 32U) / 1'000'000'000U;
}

} // namespace

std::string pose_packet(Side side, const StagePose& pose,
                        std::chrono::system_clock::time_point time) {
  std::string message;
  append_string(message, "/nendo/wrist/" + std::string(name_of(side)));
  append_string(message, ",ddddddd");
  for (const double number : pose.position_m)
    append_number(message, std::bit_cast<std::uint64_t>(number), 8);
  for (const double number : pose.turn_xyzw)
    append_number(message, std::bit_cast<std::uint64_t>(number), 8);
  std::string packet;
  append_string(packet, "#bundle");
  append_number(packet, ntp_time(time), 8);
  append_number(packet, message.size(), 4);
  return packet + message;
}

Result<PoseSender> PoseSender::open(std::string_view to) {
  const auto endpoint = parse_endpoint(to);
  if (!endpoint)
    return Error{Errc::usage, "--to " + std::string(to) + ": " + endpoint.error().message};
  PoseSender sender;
  sender.to_ = endpoint->socket_address();
  sender.socket_ =
      UniqueFd(::socket(sender.to_.address.any.sa_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!sender.socket_.is_open())
    return Error{Errc::failed, "--to " + std::string(to) + ": no socket: " + std::strerror(errno)};
  return sender;
}

void PoseSender::send(const std::string& packet) const noexcept {
  ::sendto(socket_.get(), packet.data(), packet.size(), MSG_DONTWAIT, &to_.address.any, to_.length);
}

} // namespace nendo::markers
