#include "publish/target.hpp"

#include <cstring>

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
  auto endpoint = parse_endpoint(rest.substr(0, mark));
  if (!endpoint) return wrong(text, endpoint.error().message);
  target.endpoint = *std::move(endpoint);
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
  const SocketAddress here = std::get_if<OscTarget>(&one)->endpoint.socket_address();
  const SocketAddress there = std::get_if<OscTarget>(&other)->endpoint.socket_address();
  return here.length == there.length &&
         std::memcmp(&here.address, &there.address, here.length) == 0;
}

} // namespace nendo::publish
