#include "ros2/this_machine.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/filter.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace nendo::ros2 {
namespace {

constexpr const char* loopback = "lo";
constexpr const char* remedy = "; set ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET if DDS may reach other "
                               "machines";

int number_of(int socket, int option) noexcept {
  int value = -1;
  socklen_t length = sizeof value;
  return ::getsockopt(socket, SOL_SOCKET, option, &value, &length) == 0 ? value : -1;
}

template <class Value>
bool set(int socket, int level, int option, const Value& value) noexcept {
  return ::setsockopt(socket, level, option, &value, sizeof value) == 0;
}

/// Drops what neither came over the loopback nor is multicast of this machine.
bool filter_input(int socket, std::uint32_t loopback_index) noexcept {
  const auto ancillary = [](int what) { return static_cast<std::uint32_t>(SKF_AD_OFF + what); };
  std::array<sock_filter, 6> program{{
      {BPF_LD | BPF_W | BPF_ABS, 0, 0, ancillary(SKF_AD_IFINDEX)},
      {BPF_JMP | BPF_JEQ | BPF_K, 2, 0, loopback_index},
      {BPF_LD | BPF_W | BPF_ABS, 0, 0, ancillary(SKF_AD_PKTTYPE)},
      {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, PACKET_LOOPBACK},
      {BPF_RET | BPF_K, 0, 0, 0xFFFFFFFF}, // all of it
      {BPF_RET | BPF_K, 0, 0, 0},          // nothing
  }};
  const sock_fprog filter{program.size(), program.data()};
  return set(socket, SOL_SOCKET, SO_ATTACH_FILTER, filter);
}

} // namespace

bool has_multicast() {
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return false;
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> interfaces(first, &::freeifaddrs);
  for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    const unsigned wanted = IFF_UP | IFF_MULTICAST;
    if ((one->ifa_flags & wanted) == wanted && (one->ifa_flags & IFF_LOOPBACK) == 0 &&
        one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET)
      return true;
  }
  return false;
}

std::vector<int> open_sockets() {
  std::vector<int> sockets;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", failed)) {
    const std::string name = entry.path().filename();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (number_of(descriptor, SO_TYPE) >= 0) sockets.push_back(descriptor);
  }
  return sockets;
}

Result<void> hold_to_this_machine(const std::vector<int>& others) {
  const Error other_transport{
      Errc::usage,
      std::string("CYCLONEDDS_URI: only UDP over IPv4 can be kept to this machine") + remedy};
  const std::uint32_t index = ::if_nametoindex(loopback);
  std::size_t held = 0;
  for (const int socket : open_sockets()) {
    if (std::ranges::find(others, socket) != others.end()) continue;
    const int domain = number_of(socket, SO_DOMAIN);
    if (domain != AF_INET && domain != AF_INET6) continue;
    if (domain == AF_INET6 || number_of(socket, SO_TYPE) != SOCK_DGRAM) return other_transport;
    if (index == 0 || !filter_input(socket, index) ||
        !set(socket, IPPROTO_IP, IP_UNICAST_IF, ::htonl(index)) ||
        !set(socket, IPPROTO_IP, IP_MULTICAST_TTL, 0))
      return Error{Errc::failed, std::string("DDS cannot be kept to this machine: ") +
                                     std::strerror(errno) + remedy};
    ++held;
  }
  return held > 0 ? Result<void>() : other_transport;
}

} // namespace nendo::ros2
