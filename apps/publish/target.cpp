#include "publish/target.hpp"

#include <cstring>

#include <netdb.h>

#include <nendo/base/number_in.hpp>
#include <nendo/base/shared_name.hpp>
#include <nendo/base/text.hpp>

namespace nendo::publish {
namespace {

Error wrong(std::string_view text, const std::string& what) {
  return {Errc::usage, std::string(text) + ": " + what};
}

Result<Target> parse_segment(std::string_view text, std::string_view rest) {
  SegmentTarget target;
  const std::size_t mark = rest.find('?');
  const std::string_view name = rest.substr(0, mark);
  target.name = name.empty() ? "run" : std::string(name);
  if (!is_shared_name(target.name)) return wrong(text, std::string(shared_name_rule));
  if (mark == std::string_view::npos) return Target(target);
  constexpr std::string_view key = "group=";
  const std::string_view option = rest.substr(mark + 1);
  if (!option.starts_with(key))
    return wrong(text, "unknown option; ?group=GROUP lets that group read it");
  target.group = group_named(std::string(option.substr(key.size())));
  if (!target.group) return wrong(text, "no such group; getent group lists them");
  return Target(target);
}

Result<void> find_address(std::string_view text, std::string_view place, OscTarget& target) {
  const std::size_t colon = place.rfind(':');
  const std::string_view port = colon == std::string_view::npos ? place : place.substr(colon + 1);
  std::string host =
      colon == std::string_view::npos ? "127.0.0.1" : std::string(place.substr(0, colon));
  const auto number = number_in<std::uint16_t>(port);
  if (!number || *number == 0)
    return wrong(text, "use PORT, ADDRESS:PORT or [ADDRESS]:PORT after the colon, with a port of 1 "
                       "to 65535");
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  addrinfo wanted{};
  wanted.ai_family = bracketed ? AF_INET6 : AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), std::string(port).c_str(), &wanted, &found) != 0)
    return wrong(text, "use a numeric address; one of IPv6 in brackets: [::1]:9000");
  const bool fits = found->ai_addrlen <= sizeof target.address;
  if (fits) {
    std::memcpy(&target.address, found->ai_addr, found->ai_addrlen);
    target.length = found->ai_addrlen;
  }
  ::freeaddrinfo(found);
  if (!fits) return wrong(text, "use an address of IPv4 or IPv6");
  return {};
}

Result<Target> parse_osc(std::string_view text, OscFormat format, std::string_view rest) {
  OscTarget target;
  target.format = format;
  const std::size_t mark = rest.find('?');
  if (mark != std::string_view::npos) {
    constexpr std::string_view key = "rate=";
    const std::string_view option = rest.substr(mark + 1);
    if (!option.starts_with(key))
      return wrong(text, "unknown option; ?rate=HZ sends at most so often");
    target.rate_hz = to_finite_number(option.substr(key.size()));
    if (!target.rate_hz || *target.rate_hz < 0.1 || *target.rate_hz > 10'000.0)
      return wrong(text, "use a rate of 0.1 to 10000 Hz");
  }
  if (const auto found = find_address(text, rest.substr(0, mark), target); !found)
    return found.error();
  return Target(target);
}

} // namespace

Result<Target> parse_target(std::string_view text) {
  constexpr std::string_view segment = "shm";
  constexpr std::string_view osc = "osc:";
  constexpr std::string_view vmc = "vmc:";
  if (text == segment) return parse_segment(text, "");
  if (text == "shm:" || text.starts_with("shm:?"))
    return wrong(text, "has no name; use shm:NAME, or shm, which is shm:run");
  if (text.starts_with("shm:") || text.starts_with("shm?"))
    return parse_segment(text, text.substr(text[3] == ':' ? 4 : 3));
  if (text.starts_with(osc)) return parse_osc(text, OscFormat::nendo, text.substr(osc.size()));
  if (text.starts_with(vmc)) return parse_osc(text, OscFormat::vmc, text.substr(vmc.size()));
  if (text.starts_with("udp:"))
    return wrong(text, "is no longer sent; use osc:PORT, or shm:NAME on this machine");
  return wrong(text, "use shm:NAME, osc:[ADDRESS:]PORT or vmc:[ADDRESS:]PORT");
}

bool is_same_place(const Target& one, const Target& other) noexcept {
  if (one.index() != other.index()) return false;
  if (const auto* segment = std::get_if<SegmentTarget>(&one))
    return segment->name == std::get_if<SegmentTarget>(&other)->name;
  const auto& here = *std::get_if<OscTarget>(&one);
  const auto& there = *std::get_if<OscTarget>(&other);
  return here.length == there.length &&
         std::memcmp(&here.address, &there.address, here.length) == 0;
}

} // namespace nendo::publish
