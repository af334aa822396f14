#include "publish/target.hpp"

#include <nendo/base/shared_name.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/vrpn_protocol.hpp>

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

/// Parses ENDPOINT?rate=HZ, where an empty endpoint is the given one.
Result<void> parse_network(std::string_view text, std::string_view rest, Endpoint& endpoint,
                           std::optional<double>& rate_hz) {
  const std::size_t mark = rest.find('?');
  if (mark != std::string_view::npos) {
    constexpr std::string_view key = "rate=";
    const std::string_view option = rest.substr(mark + 1);
    if (!option.starts_with(key))
      return wrong(text, "unknown option; ?rate=HZ sends at most so often");
    rate_hz = to_finite_number(option.substr(key.size()));
    if (!rate_hz || *rate_hz < 0.1 || *rate_hz > 10'000.0)
      return wrong(text, "use a rate of 0.1 to 10000 Hz");
  }
  const std::string_view place = rest.substr(0, mark);
  if (place.empty() && endpoint.port != 0) return {};
  auto parsed = parse_endpoint(place);
  if (!parsed) return wrong(text, parsed.error().message);
  endpoint = *std::move(parsed);
  return {};
}

Result<Target> parse_osc(std::string_view text, OscFormat format, std::string_view rest) {
  OscTarget target;
  target.format = format;
  const auto parsed = parse_network(text, rest, target.endpoint, target.rate_hz);
  return parsed ? Result<Target>(target) : parsed.error();
}

Result<Target> parse_vrpn(std::string_view text, std::string_view rest) {
  VrpnTarget target;
  const bool has_endpoint = rest.starts_with(':');
  if (!has_endpoint) target.endpoint.port = driver::vrpn::default_port;
  const auto parsed =
      parse_network(text, rest.substr(has_endpoint ? 1 : 0), target.endpoint, target.rate_hz);
  return parsed ? Result<Target>(target) : parsed.error();
}

/// Returns the endpoint of a target that is no segment.
const Endpoint& network_endpoint(const Target& target) noexcept {
  const auto* osc = std::get_if<OscTarget>(&target);
  return osc ? osc->endpoint : std::get_if<VrpnTarget>(&target)->endpoint;
}

} // namespace

Result<Target> parse_target(std::string_view text) {
  constexpr std::string_view segment = "shm";
  constexpr std::string_view osc = "osc:";
  constexpr std::string_view vmc = "vmc:";
  constexpr std::string_view vrpn = "vrpn";
  if (text == segment) return parse_segment(text, "");
  if (text == "shm:" || text.starts_with("shm:?"))
    return wrong(text, "has no name; use shm:NAME, or shm, which is shm:run");
  if (text.starts_with("shm:") || text.starts_with("shm?"))
    return parse_segment(text, text.substr(text[3] == ':' ? 4 : 3));
  if (text.starts_with(osc)) return parse_osc(text, OscFormat::nendo, text.substr(osc.size()));
  if (text.starts_with(vmc)) return parse_osc(text, OscFormat::vmc, text.substr(vmc.size()));
  if (text == vrpn || text.starts_with("vrpn:") || text.starts_with("vrpn?"))
    return parse_vrpn(text, text.substr(vrpn.size()));
  if (text.starts_with("udp:"))
    return wrong(text, "is no longer sent; use osc:PORT, or shm:NAME on this machine");
  return wrong(text,
               "use shm:NAME, osc:[ADDRESS:]PORT, vmc:[ADDRESS:]PORT or vrpn[:[ADDRESS:]PORT]");
}

bool is_same_place(const Target& one, const Target& other) noexcept {
  if (one.index() != other.index()) return false;
  if (const auto* segment = std::get_if<SegmentTarget>(&one))
    return segment->name == std::get_if<SegmentTarget>(&other)->name;
  return network_endpoint(one).socket_address() == network_endpoint(other).socket_address();
}

} // namespace nendo::publish
