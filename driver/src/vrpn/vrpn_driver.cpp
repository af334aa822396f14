// A tracker of a VRPN server, see nendo/driver/vrpn_protocol.hpp.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include <nendo/base/text.hpp>

#include "drivers.hpp"
#include "stream/device_clock.hpp"
#include "stream/listen.hpp"
#include "stream/stream_tracker.hpp"
#include "transport/tcp_transport.hpp"
#include "vrpn/vrpn_parser.hpp"
#include "vrpn/vrpn_place.hpp"

namespace nendo::driver::vrpn {
namespace {

using namespace std::chrono_literals;

constexpr auto write_timeout = 100ms;
constexpr auto naming_time = 1000ms; ///< from the connection to the tracker's name
constexpr auto pong_time = 250ms;    ///< a server answers within a cycle of its loop, e.g. 10 ms
constexpr int pings = 4;             ///< the first may come before the device listens
constexpr auto sensors_time = 400ms; ///< until each sensor that is seen has sent a pose
constexpr auto text_interval = 5s;   ///< between two messages of the server in the log
constexpr std::size_t max_listed = 24;

/// The turn from axes with z up (x to the right, y to the front) to the stage's: -90 degrees
/// about x.
constexpr std::array<double, 4> stage_from_z_up_xyzw{-0.7071067811865476, 0, 0, 0.7071067811865476};

/// What a server and its tracker said while they were asked.
struct Heard {
  std::optional<std::string> greeting; ///< printable
  bool is_vrpn_7 = false;
  std::vector<std::string> names;    ///< the server's devices, printable; the first ones
  bool has_answered = false;         ///< the tracker, by a pong or a pose
  std::vector<std::int32_t> sensors; ///< that sent poses; the first ones

  void add_name(std::string_view name) {
    if (name != control_name) add(names, printable(name));
  }
  void add_sensor(std::int32_t sensor) { add(sensors, sensor); }
  bool has_heard(std::uint16_t sensor) const {
    return std::find(sensors.begin(), sensors.end(), sensor) != sensors.end();
  }

private:
  template <class Item>
  static void add(std::vector<Item>& list, Item item) {
    if (list.size() < max_listed && std::find(list.begin(), list.end(), item) == list.end())
      list.push_back(std::move(item));
  }
};

std::string listed(std::vector<std::string> items) {
  std::sort(items.begin(), items.end());
  std::string list;
  for (const std::string& item : items)
    list += (list.empty() ? "" : ", ") + item;
  return items.size() < max_listed ? list : list + ", and perhaps more";
}

std::string listed(std::vector<std::int32_t> sensors) {
  std::sort(sensors.begin(), sensors.end());
  std::string list;
  for (const std::int32_t sensor : sensors)
    list += (list.empty() ? "" : ", ") + std::to_string(sensor);
  return list;
}

/// Passes the tracker's messages to the log, one per text_interval at most.
class TextLog {
public:
  void log(const std::string& source, const Text& text, HostTime now) {
    if (last_ && now - *last_ < text_interval) {
      ++left_out_;
      return;
    }
    last_ = now;
    const auto level = text.severity >= text_warning ? spdlog::level::warn : spdlog::level::info;
    const std::string more = left_out_ == 0 ? "" : fmt::format(" (and {} before it)", left_out_);
    spdlog::log(level, "device: {}: the server says {}{}", source, in_quotes(text.text), more);
    left_out_ = 0;
  }

private:
  std::optional<HostTime> last_;
  std::uint64_t left_out_ = 0;
};

class VrpnProtocol final : public TrackerProtocol {
public:
  VrpnProtocol(std::string source, Place place, std::shared_ptr<const TcpConnector> server,
               std::span<const std::uint16_t> sensors, bool z_up)
      : source_(std::move(source)), place_(std::move(place)), server_(std::move(server)),
        sensors_(sensors.begin(), sensors.end()), z_up_(z_up), parser_(place_.tracker, sensors_),
        clocks_(sensors_.size()) {}

  /// A connection that is still there is asked whether the tracker is: a body that no camera sees
  /// sends nothing.
  Result<TrackerInfo> identify(Transport& transport, const std::string& /*source*/,
                               IdentifyReason reason, const ReplyDeadline& limit) override {
    parser_.deliver_poses(false);
    heard_.has_answered = false;
    const bool is_new = connection_ != server_->connections();
    if (is_new) {
      connection_ = server_->connections();
      if (auto met = meet(transport, limit); !met) return met.error();
    }
    if (auto answered = ask(transport, limit, is_new); !answered) {
      transport.hang_up();
      return answered.error();
    }
    if (reason == IdentifyReason::opening) look_for_sensors(transport, limit);
    return describe();
  }

  /// What has waited is old, but later messages need its names.
  Result<void> start_stream(Transport& transport, const std::string& /*source*/,
                            const ReplyDeadline& limit) override {
    std::array<std::byte, 4096> buffer;
    IoStatus status = IoStatus::done;
    while (status == IoStatus::done && HostClock::now() < limit.deadline) {
      const ReadResult read = transport.read_some(buffer, 0ms);
      status = read.status;
      hear(std::span(buffer).first(read.count));
    }
    parser_.deliver_poses(true);
    return {}; // one that is gone is connected again by the reader
  }

  /// A server waits for a client that does not read, and all its other clients with it.
  void end_stream(Transport& transport, const ReplyDeadline& /*limit*/) noexcept override {
    transport.hang_up();
  }

  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    parser_.push(chunk,
                 FindingSink{[&](const Pose& pose) { deliver(pose, arrival, sink); },
                             [&](const Text& text) { text_log_.log(source_, text, arrival); },
                             [&](BadRecord) { sink.reject(); }});
  }

  void answer(Transport& transport) noexcept override {
    if (parser_.is_broken()) transport.hang_up();
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  Error problem(const std::string& what) const {
    return {Errc::no_device, source_ + ": " + server_->name() + " " + what};
  }

  void hear(std::span<const std::byte> chunk) {
    parser_.push(chunk, FindingSink{[&](const Greeting& greeting) {
                                      heard_.greeting = printable(greeting.text);
                                      heard_.is_vrpn_7 = greeting.is_vrpn_7;
                                    },
                                    [&](const SenderName& sender) { heard_.add_name(sender.name); },
                                    [&](const OtherPose& pose) {
                                      heard_.has_answered = true;
                                      heard_.add_sensor(pose.sensor);
                                    },
                                    [&](Pong) { heard_.has_answered = true; },
                                    [&](const Text& text) {
                                      text_log_.log(source_, text, HostClock::now());
                                    }});
  }

  /// Greets a server that is newly connected, and waits for the tracker's name.
  Result<void> meet(Transport& transport, const ReplyDeadline& limit) {
    parser_.reset();
    heard_ = {};
    for (DeviceClock& clock : clocks_)
      clock.reset();
    const std::uint64_t bytes_before = parser_.counters().bytes;
    IoStatus status = transport.write_all(greeting(), write_timeout);
    if (status == IoStatus::done) {
      status = listen(transport, limit, naming_time, [&](std::span<const std::byte> chunk) {
        hear(chunk);
        return parser_.knows_tracker() || parser_.is_broken();
      });
    }
    if (parser_.knows_tracker() && status == IoStatus::done)
      return send(transport, describe_ping(place_.tracker));
    return stranger(status, parser_.counters().bytes - bytes_before);
  }

  Error stranger(IoStatus status, std::uint64_t bytes_heard) const {
    if (heard_.greeting && !heard_.is_vrpn_7)
      return problem("is no server of VRPN 7, it says " + in_quotes(*heard_.greeting) +
                     "; is the port right (VRPN has " + std::to_string(default_port) + ")?");
    if (parser_.is_broken()) return unreadable();
    if (status == IoStatus::gone)
      return problem("closed the connection; is it a VRPN server, and does it have a limit of "
                     "clients?");
    if (bytes_heard == 0)
      return problem("accepts the connection and says nothing; is it a VRPN server, and does its "
                     "program still run? Restart it");
    if (!heard_.greeting)
      return problem("does not begin as a server of VRPN 7 does; is the port right (VRPN has " +
                     std::to_string(default_port) + ")?");
    if (heard_.names.empty())
      return problem("names no devices; is a tracker configured and switched on there?");
    return problem("has no tracker " + in_quotes(place_.tracker) +
                   "; it has: " + listed(heard_.names));
  }
  Error unreadable() const {
    return problem("sent a message of a wrong length; is it a VRPN server, and is its program "
                   "intact?");
  }

  Result<void> send(Transport& transport, std::span<const std::byte> bytes) const {
    if (transport.write_all(bytes, write_timeout) == IoStatus::done) return {};
    return problem("takes no messages; is its program still running?");
  }

  /// Pings the tracker, until it answers or sends a pose.
  Result<void> ask(Transport& transport, const ReplyDeadline& limit, bool is_new) {
    for (int turn = 0; turn < pings; ++turn) {
      if (auto sent = send(transport, ping()); !sent) return sent;
      if (heard_.has_answered) return {};
      const IoStatus status =
          listen(transport, limit, pong_time, [&](std::span<const std::byte> chunk) {
            hear(chunk);
            return heard_.has_answered || parser_.is_broken();
          });
      if (parser_.is_broken()) return unreadable();
      if (status == IoStatus::gone) return problem("closed the connection; is it restarted?");
      if (heard_.has_answered) return {};
    }
    if (!is_new) return problem("does not answer any more; does its program still run?");
    return problem("knows the name " + in_quotes(place_.tracker) +
                   ", but no tracker there answers to it; is it started at the server? Names: " +
                   listed(heard_.names));
  }

  /// A wrong number of a sensor and a body that is not seen look the same, so this is no error.
  void look_for_sensors(Transport& transport, const ReplyDeadline& limit) {
    const auto all_heard = [&] {
      return std::all_of(sensors_.begin(), sensors_.end(),
                         [&](std::uint16_t sensor) { return heard_.has_heard(sensor); });
    };
    if (!all_heard()) {
      listen(transport, limit, sensors_time, [&](std::span<const std::byte> chunk) {
        hear(chunk);
        return all_heard() || parser_.is_broken();
      });
    }
    for (const std::uint16_t sensor : sensors_) {
      if (heard_.has_heard(sensor)) continue;
      spdlog::warn("device: {}: sensor {} sends no poses yet; is it in view? {}", source_, sensor,
                   heard_.sensors.empty() ? "No sensor sends any"
                                          : "Sensors that do: " + listed(heard_.sensors));
    }
  }

  TrackerInfo describe() const {
    TrackerInfo info;
    info.model = "VRPN tracker " + printable(place_.tracker);
    info.stations = sensors_;
    if (z_up_) info.stage_from_tracker_xyzw = stage_from_z_up_xyzw;
    info.is_filtered = true;
    info.facts = {{"server", server_->name()},
                  {"protocol", heard_.greeting.value_or("")},
                  {"names", listed(heard_.names)},
                  {"sensors_seen", listed(heard_.sensors)},
                  {"up", z_up_ ? "z" : "y"}};
    return info;
  }

  void deliver(const Pose& pose, HostTime arrival, Sink& sink) noexcept {
    PoseSample sample;
    sample.station = pose.sensor;
    sample.position_m = pose.position_m;
    sample.turn_xyzw = pose.turn_xyzw;
    if (pose.stamp) {
      sample.has_device_time = true;
      sample.device_time = *pose.stamp;
      sample.measured = clock_of(pose.sensor).to_host(since_first(*pose.stamp), arrival);
    }
    sink.deliver(sample);
  }

  /// Each sensor has a clock of its own, since a server may send one sensor's older pose after
  /// another's newer one.
  DeviceClock& clock_of(std::uint16_t sensor) noexcept {
    const auto at = std::find(sensors_.begin(), sensors_.end(), sensor) - sensors_.begin();
    return clocks_[static_cast<std::size_t>(at)];
  }
  /// DeviceClock takes times within 73 years, and the server's begin in 1970.
  std::chrono::nanoseconds since_first(std::chrono::nanoseconds stamp) noexcept {
    if (!first_stamp_) first_stamp_ = stamp;
    return stamp - *first_stamp_;
  }

  const std::string source_;
  const Place place_;
  const std::shared_ptr<const TcpConnector> server_;
  const std::vector<std::uint16_t> sensors_;
  const bool z_up_;
  std::uint64_t connection_ = 0; ///< the number of the connection that was greeted
  Heard heard_;
  TextLog text_log_;
  Parser parser_;
  std::vector<DeviceClock> clocks_; ///< in the order of `sensors_`
  std::optional<std::chrono::nanoseconds> first_stamp_;
};

} // namespace

Result<std::unique_ptr<Tracker>> open_vrpn(const DeviceSpec& spec,
                                           std::span<const std::uint16_t> stations) {
  if (auto allowed = allow_options(spec, {"up"}); !allowed) return allowed.error();
  const auto up = word_option(spec, "up", {"y", "z"});
  if (!up) return up.error();
  auto place = parse_place(spec);
  if (!place) return place.error();
  const HostTime deadline = HostClock::now() + open_budget;
  const auto server = std::make_shared<TcpConnector>(place->host, place->port);
  auto protocol =
      std::make_unique<VrpnProtocol>(spec.text, *std::move(place), server, stations, *up == "z");
  return open_stream_tracker(
      spec.text, [server] { return server->connect(); }, std::move(protocol), deadline);
}

} // namespace nendo::driver::vrpn
