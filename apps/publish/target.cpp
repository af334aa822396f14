#include "publish/target.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <grp.h>
#include <netdb.h>

#include <nendo/base/number_in.hpp>

namespace nendo::publish {
namespace {

Error wrong(std::string_view text, const std::string& what) {
  return {Errc::usage, std::string(text) + ": " + what};
}

bool is_name(std::string_view name) noexcept {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), allowed);
}

std::optional<unsigned> group_of(const std::string& name) {
  if (const auto number = number_in<unsigned>(name); number && *number != 0xFFFFFFFFU)
    return number;
  group entry{};
  group* found = nullptr;
  std::array<char, 16384> buffer{};
  ::getgrnam_r(name.c_str(), &entry, buffer.data(), buffer.size(), &found);
  return found != nullptr ? std::optional(found->gr_gid) : std::nullopt;
}

Result<Target> parse_segment(std::string_view text, std::string_view rest) {
  SegmentTarget target;
  const std::size_t mark = rest.find('?');
  const std::string_view name = rest.substr(0, mark);
  target.name = name.empty() ? "run" : std::string(name);
  if (!is_name(target.name))
    return wrong(text, "use letters, digits, '-', '_' and '.' for the name, at most 64");
  if (mark == std::string_view::npos) return Target(target);
  constexpr std::string_view key = "group=";
  const std::string_view option = rest.substr(mark + 1);
  if (!option.starts_with(key))
    return wrong(text, "unknown option; ?group=GROUP lets that group read it");
  target.group = group_of(std::string(option.substr(key.size())));
  if (!target.group) return wrong(text, "no such group; getent group lists them");
  return Target(target);
}

Result<Target> parse_datagrams(std::string_view text, std::string_view rest) {
  const std::size_t colon = rest.rfind(':');
  const std::string_view port = colon == std::string_view::npos ? rest : rest.substr(colon + 1);
  std::string host =
      colon == std::string_view::npos ? "127.0.0.1" : std::string(rest.substr(0, colon));
  const auto number = number_in<std::uint16_t>(port);
  if (!number || *number == 0)
    return wrong(text, "use udp:PORT, udp:ADDRESS:PORT or udp:[ADDRESS]:PORT, with a port of 1 to "
                       "65535");
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  addrinfo wanted{};
  wanted.ai_family = bracketed ? AF_INET6 : AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  DatagramTarget target;
  if (::getaddrinfo(host.c_str(), std::string(port).c_str(), &wanted, &found) != 0)
    return wrong(text, "use a numeric address; one of IPv6 in brackets: udp:[::1]:9000");
  const bool fits = found->ai_addrlen <= sizeof target.address;
  if (fits) {
    std::memcpy(&target.address, found->ai_addr, found->ai_addrlen);
    target.length = found->ai_addrlen;
  }
  ::freeaddrinfo(found);
  if (!fits) return wrong(text, "use an address of IPv4 or IPv6");
  return Target(target);
}

} // namespace

Result<Target> parse_target(std::string_view text) {
  constexpr std::string_view segment = "shm";
  constexpr std::string_view datagrams = "udp:";
  if (text == segment) return parse_segment(text, "");
  if (text == "shm:" || text.starts_with("shm:?"))
    return wrong(text, "has no name; use shm:NAME, or shm, which is shm:run");
  if (text.starts_with("shm:") || text.starts_with("shm?"))
    return parse_segment(text, text.substr(text[3] == ':' ? 4 : 3));
  if (text.starts_with(datagrams)) return parse_datagrams(text, text.substr(datagrams.size()));
  return wrong(text, "use shm:NAME, udp:PORT or udp:ADDRESS:PORT");
}

Error system_error(const std::string& place, const std::string& what, const std::string& remedy) {
  const int number = errno;
  const bool forbidden = number == EACCES || number == EPERM;
  return {forbidden ? Errc::no_permission : Errc::failed,
          place + ": " + what + ": " + std::generic_category().message(number) + "; " + remedy};
}

bool is_same_place(const Target& one, const Target& other) noexcept {
  if (one.index() != other.index()) return false;
  if (const auto* segment = std::get_if<SegmentTarget>(&one))
    return segment->name == std::get_if<SegmentTarget>(&other)->name;
  const auto& [address, length] = *std::get_if<DatagramTarget>(&one);
  const auto& there = *std::get_if<DatagramTarget>(&other);
  return length == there.length && std::memcmp(&address, &there.address, length) == 0;
}

} // namespace nendo::publish
