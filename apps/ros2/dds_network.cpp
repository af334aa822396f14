#include "ros2/dds_network.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string_view>

#include <nendo/base/text.hpp>

namespace nendo::ros2 {
namespace {

constexpr std::int64_t max_domain_id = 232; // the ports of further domains do not exist
constexpr std::size_t max_peers = 32;
constexpr std::size_t max_peer_length = 253; // of a name in DNS

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

Error wrong(std::string_view variable, std::string_view value, std::string_view remedy) {
  return {Errc::usage, std::string(variable) + "=" + in_quotes(value) + ": " + std::string(remedy)};
}

Result<std::uint32_t> parse_domain_id(const std::string& text) {
  if (text.empty()) return std::uint32_t{0};
  const bool is_digits = std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  const std::optional<std::int64_t> number = to_integer(text);
  if (!is_digits || !number || *number > max_domain_id)
    return wrong("ROS_DOMAIN_ID", text, "use a number from 0 to 232");
  return static_cast<std::uint32_t>(*number);
}

/// Returns the elements of XML. Peers become part of it, so their characters are checked.
Result<std::string> parse_peers(const std::string& text) {
  std::string elements;
  std::size_t count = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view peer = cut(rest, ';');
    if (peer.empty()) continue;
    const bool is_address = std::ranges::all_of(peer, [](char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
             std::string_view("-._:").find(c) != std::string_view::npos;
    });
    if (!is_address || peer.size() > max_peer_length || ++count > max_peers)
      return wrong("ROS_STATIC_PEERS", peer,
                   "use names or addresses, with ';' between, at most 32");
    elements += "<Peer address=\"" + std::string(peer) + "\"/>";
  }
  return elements;
}

enum class Range { this_machine, loopback, subnet };

Result<Range> parse_range(const Environment& environment) {
  const std::string& only = environment.localhost_only;
  const std::string& range = environment.discovery_range;
  if (!only.empty() && only != "0" && only != "1")
    return wrong("ROS_LOCALHOST_ONLY", only, "use 0 or 1");
  if (range == "OFF")
    return wrong("ROS_AUTOMATIC_DISCOVERY_RANGE", range,
                 "then no program could find these topics; use LOCALHOST or SUBNET");
  const bool is_subnet = range == "SUBNET" || range == "SYSTEM_DEFAULT";
  if (!is_subnet && !range.empty() && range != "LOCALHOST")
    return wrong("ROS_AUTOMATIC_DISCOVERY_RANGE", range, "use LOCALHOST or SUBNET");
  if (only == "1") return Range::loopback; // for ROS, it prevails
  return is_subnet ? Range::subnet : Range::this_machine;
}

} // namespace

Environment environment() {
  return {variable("ROS_DOMAIN_ID"), variable("ROS_LOCALHOST_ONLY"),
          variable("ROS_AUTOMATIC_DISCOVERY_RANGE"), variable("ROS_STATIC_PEERS"),
          variable("CYCLONEDDS_URI")};
}

Result<DdsNetwork> network_of(const Environment& environment, bool has_multicast) {
  const auto domain_id = parse_domain_id(environment.domain_id);
  if (!domain_id) return domain_id.error();
  const auto range = parse_range(environment);
  if (!range) return range.error();
  auto peers = parse_peers(environment.static_peers);
  if (!peers) return peers.error();
  if (*range == Range::loopback) peers = std::string(); // as ROS ignores them then
  DdsNetwork network;
  network.domain_id = *domain_id;
  network.is_this_machine_only = *range != Range::subnet && peers->empty();

  std::string general, discovery = "<ParticipantIndex>auto</ParticipantIndex>"
                                   "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>";
  if (*range != Range::subnet) *peers += "<Peer address=\"127.0.0.1\"/>";
  if (*range == Range::loopback || (network.is_this_machine_only && !has_multicast))
    // Readers on the loopback announce no other address, and it does not multicast.
    general = "<Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
              "<AllowMulticast>false</AllowMulticast>";
  else if (network.is_this_machine_only)
    // Most readers on this machine announce the address of its network, and some can only be found
    // by multicast, which a time to live of 0 keeps on this machine.
    general = "<AllowMulticast>spdp</AllowMulticast><MulticastTimeToLive>0</MulticastTimeToLive>";
  else if (*range != Range::subnet)
    general = "<AllowMulticast>false</AllowMulticast>";
  if (!peers->empty()) discovery += "<Peers>" + *peers + "</Peers>";
  // The limits beyond which a writer waits for a reader that stalls are above all that writers
  // keep.
  network.config = "<CycloneDDS><Domain><General>" + general + "</General><Discovery>" + discovery +
                   "</Discovery><Internal><Watermarks><WhcAdaptive>false</WhcAdaptive>"
                   "<WhcHigh>64 MB</WhcHigh></Watermarks></Internal></Domain></CycloneDDS>";
  if (!environment.cyclonedds_uri.empty()) network.config += "," + environment.cyclonedds_uri;
  return network;
}

} // namespace nendo::ros2
