#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include <nendo/base/side.hpp>
#include <nendo/base/text.hpp>

#include "drivers.hpp"
#include "osc/osc_parser.hpp"
#include "stream/device_clock.hpp"
#include "stream/listen.hpp"
#include "stream/stream_tracker.hpp"
#include "transport/udp_transport.hpp"

namespace nendo::driver::osc {
namespace {

struct OscOptions {
  Endpoint endpoint;
  PairAddresses pair; ///< empty addresses: none
  std::vector<std::uint16_t> stations;
};

std::string_view address_of(std::uint16_t station) noexcept {
  return station == left_station ? left_address : right_address;
}

/// Senders are not asked anything: they may begin long after the driver.
class OscProtocol final : public TrackerProtocol {
public:
  explicit OscProtocol(OscOptions options) : options_(std::move(options)), parser_(options_.pair) {}

  Result<TrackerInfo> identify(Transport& /*transport*/, const std::string& source,
                               IdentifyReason reason, const ReplyDeadline& /*limit*/) override {
    if (reason == IdentifyReason::reviving) explain_silence(source);
    TrackerInfo info;
    info.model = "OSC at " + options_.endpoint.authority();
    info.stations = options_.stations;
    info.facts = {{"listens_at", options_.endpoint.authority()}};
    for (const std::uint16_t station : options_.stations)
      info.facts.push_back({station == left_station ? "left_address" : "right_address",
                            std::string(address_of(station))});
    if (!options_.pair.position.empty()) {
      info.facts.push_back({"position_address", options_.pair.position});
      info.facts.push_back({"rotation_address", options_.pair.rotation});
    }
    return info;
  }

  /// What waited is old.
  Result<void> start_stream(Transport& transport, const std::string& /*source*/,
                            const ReplyDeadline& /*limit*/) override {
    parser_.count_discarded(drop_waiting(transport));
    return {};
  }

  /// Bad messages are counted, but do not make the tracker doubtful: any program can send some.
  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    const auto take = [&](const Pose& pose) {
      PoseSample sample;
      sample.station = pose.station;
      sample.position_m = pose.position_m;
      sample.turn_xyzw = pose.turn_xyzw;
      if (pose.time) {
        sample.has_device_time = true;
        sample.device_time = *pose.time;
        sample.measured = clocks_[pose.station - left_station].to_host(*pose.time, arrival);
      }
      sink.deliver(sample);
    };
    parser_.push(chunk, arrival,
                 FindingSink{take, [this](const UnknownAddress& found) { remember(found); }});
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  /// The beginning of an address.
  struct Address {
    std::array<char, 64> characters{};
    std::size_t length = 0;
    std::string_view text() const noexcept { return {characters.data(), length}; }
  };

  void remember(const UnknownAddress& found) noexcept {
    const std::string_view text = found.address.substr(0, Address{}.characters.size());
    for (Address& address : unknown_) {
      if (address.text() == text) return;
      if (address.length > 0) continue;
      std::copy(text.begin(), text.end(), address.characters.begin());
      address.length = text.size();
      return;
    }
  }

  std::string unknown_addresses() const {
    std::string list;
    for (const Address& address : unknown_)
      if (address.length > 0) list += (list.empty() ? "" : ", ") + printable(address.text());
    return list;
  }

  /// A sender's own addresses, such as those of a phone, are seen here first. Logs once.
  void explain_silence(const std::string& source) {
    if (parser_.counters().records > 0 || has_explained_) return;
    if (const std::string unknown = unknown_addresses(); !unknown.empty()) {
      spdlog::warn("device: {} gets messages to {}, and none that it knows ({}); name a sender's "
                   "own addresses by position= and rotation=",
                   source, unknown, address_of(options_.stations.front()));
    } else if (parser_.counters().bad_records > 0) {
      spdlog::warn("device: {} gets datagrams that are no poses; {} wants seven numbers: x y z in "
                   "metres, a unit quaternion x y z w",
                   source, address_of(options_.stations.front()));
    } else {
      return;
    }
    has_explained_ = true;
  }

  const OscOptions options_;
  Parser parser_;
  std::array<DeviceClock, 2> clocks_; ///< the senders of both hands may have different clocks
  std::array<Address, 4> unknown_;    ///< the first unknown ones
  bool has_explained_ = false;
};

Error wrong(const DeviceSpec& spec, const std::string& what) {
  return {Errc::usage, spec.text + ": " + what};
}

/// An address as OSC defines it: printable ASCII without what has a meaning in patterns.
bool is_address(std::string_view text) noexcept {
  constexpr std::size_t max_characters = 128;
  const auto is_allowed = [](char c) {
    return c > ' ' && c <= '~' && std::string_view("#*,?[]{}").find(c) == std::string_view::npos;
  };
  return text.starts_with('/') && text.size() > 1 && text.size() <= max_characters &&
         std::all_of(text.begin(), text.end(), is_allowed);
}

Result<PairAddresses> pair_option(const DeviceSpec& spec, std::span<const std::uint16_t> stations) {
  PairAddresses pair;
  const auto position = spec.options.find("position");
  const auto rotation = spec.options.find("rotation");
  if (position == spec.options.end() && rotation == spec.options.end()) return pair;
  if (position == spec.options.end() || rotation == spec.options.end())
    return wrong(spec, "give both position= and rotation=, which are two messages of one pose");
  if (stations.size() > 1)
    return wrong(spec, "position= and rotation= are of one hand; let the other hand's sender use a "
                       "port of its own");
  pair = {position->second, rotation->second, stations.front()};
  for (const std::string& address : {pair.position, pair.rotation})
    if (!is_address(address))
      return wrong(spec, in_quotes(address) + " is no OSC address, as /phone/position");
  if (pair.position == pair.rotation)
    return wrong(spec, "position= and rotation= must be different addresses");
  if (address_of(left_station) == pair.position || address_of(right_station) == pair.position ||
      address_of(left_station) == pair.rotation || address_of(right_station) == pair.rotation)
    return wrong(spec, "addresses that begin with /nendo/wrist have whole poses");
  return pair;
}

} // namespace

Result<std::uint16_t> take_osc_side(DeviceSpec& spec) {
  const std::size_t slash = spec.target.rfind('/');
  const auto side = slash == std::string::npos
                        ? std::optional<Side>{}
                        : side_named(std::string_view(spec.target).substr(slash + 1));
  if (!side) return wrong(spec, "name the port and the hand, as osc:9000/left or osc:9000/right");
  std::string target = spec.target.substr(0, slash);
  if (const auto listen = spec.options.extract("listen"); !listen.empty()) {
    if (target.find(':') != std::string::npos)
      return wrong(spec, "has two addresses; leave out listen=");
    const bool is_ipv6 = listen.mapped().find(':') != std::string::npos;
    target = (is_ipv6 ? "[" + listen.mapped() + "]" : listen.mapped()) + ":" + target;
  }
  const auto endpoint = parse_endpoint(target);
  if (!endpoint) return wrong(spec, endpoint.error().message);
  spec.target = endpoint->authority(); // one spelling, so that both hands share a socket
  return *side == Side::left ? left_station : right_station;
}

Result<std::unique_ptr<Tracker>> open_osc(const DeviceSpec& spec,
                                          std::span<const std::uint16_t> stations) {
  if (const auto known = allow_options(spec, {"position", "rotation"}); !known)
    return known.error();
  const auto endpoint = parse_endpoint(spec.target);
  if (!endpoint) return wrong(spec, endpoint.error().message);
  const auto pair = pair_option(spec, stations);
  if (!pair) return pair.error();
  OscOptions options{*endpoint, *pair, {stations.begin(), stations.end()}};
  return open_stream_tracker(
      spec.text, [at = *endpoint] { return open_udp(at); },
      std::make_unique<OscProtocol>(std::move(options)), HostClock::now() + open_budget);
}

} // namespace nendo::driver::osc
