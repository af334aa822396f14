#include "vrpn/vrpn_place.hpp"

#include <optional>
#include <string_view>
#include <utility>

#include <nendo/base/number_in.hpp>

namespace nendo::driver::vrpn {
namespace {

Error no_place(const DeviceSpec& spec, const std::string& what) {
  return {Errc::usage, "\"" + spec.text + "\": " + what +
                           "; e.g. vrpn:Tracker0@192.168.1.20, vrpn:Tracker0@lab:3883, "
                           "vrpn:Tracker0@[fe80::1%eth0]"};
}

/// Splits HOST, HOST:PORT, [ADDRESS] or [ADDRESS]:PORT. Returns nothing if the text is none of
/// them.
std::optional<Place> server_in(std::string_view text) {
  Place place;
  const bool is_bracketed = text.starts_with('[');
  const std::size_t host_end = is_bracketed ? text.find(']') : text.find(':');
  place.host = text.substr(is_bracketed ? 1 : 0, host_end - (is_bracketed ? 1 : 0));
  if (is_bracketed && host_end == std::string_view::npos) return std::nullopt;
  std::string_view rest =
      host_end == std::string_view::npos ? "" : text.substr(host_end + (is_bracketed ? 1 : 0));
  if (place.host.empty()) return std::nullopt;
  if (rest.empty()) return place;
  const auto port = number_in<std::uint16_t>(rest.substr(1));
  if (!rest.starts_with(':') || !port || *port == 0) return std::nullopt;
  place.port = *port;
  return place;
}

} // namespace

Result<Place> parse_place(const DeviceSpec& spec) {
  const std::string_view target = spec.target;
  const std::size_t at = target.rfind('@');
  if (at == std::string_view::npos || at == 0)
    return no_place(spec, "name the tracker and its server");
  if (at >= max_name_bytes) return no_place(spec, "names of VRPN have 99 characters at most");
  auto place = server_in(target.substr(at + 1));
  if (!place)
    return no_place(spec, "after @ comes a host, or one with a port of 1 to 65535, or an address "
                          "of IPv6 in brackets");
  place->tracker = target.substr(0, at);
  return *std::move(place);
}

} // namespace nendo::driver::vrpn
