#pragma once
// A server with two gloves and a tracker, and a plain client.

#include <array>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>

#include "serve/server.hpp"
#include "support/eventually.hpp"
#include "support/required.hpp"
#include "support/runtime_folder.hpp"

namespace nendo::test {

/// Left and right glove, and a tracker at the right hand.
inline serve::Devices two_gloves() {
  serve::Devices devices;
  for (const Side side : {Side::left, Side::right}) {
    driver::GloveInfo info;
    info.source = "serial:/dev/" + std::string(name_of(side));
    info.model = "CyberGlove, 22 sensors";
    info.side = side;
    info.sensors = sensors_22;
    info.rate_hz = 90.0;
    info.abilities = {true, true, false, false};
    info.facts = {{"serial", "A" + std::string(name_of(side))}, {"firmware", "2.1"}};
    devices.gloves.push_back({static_cast<std::uint8_t>(side == Side::left ? 3 : 1), side, info});
  }
  driver::TrackerInfo tracker;
  tracker.source = "fastrak:/dev/ttyUSB2";
  tracker.model = "FASTRAK";
  tracker.stations = {2, 4};
  tracker.rate_hz = 120.0;
  tracker.stage_from_tracker_xyzw = driver::stage_from_z_down_xyzw;
  devices.trackers.push_back({Side::right, 4, tracker});
  return devices;
}

/// The glove's sample `number`, which is in each count.
inline GloveSample numbered_sample(Side side, std::uint64_t number) {
  GloveSample sample;
  sample.side = side;
  sample.sequence = number;
  sample.arrival = HostClock::now();
  sample.measured = sample.arrival;
  for (const Sensor sensor : sensors_22)
    sample.set(sensor, RawCount{static_cast<std::uint16_t>(number % 65536)});
  return sample;
}

/// A server in a folder of its own, whose loop is the test.
struct ServedHands {
  static constexpr std::uint8_t left_input = 3;
  static constexpr std::uint8_t right_input = 1;

  RuntimeFolder folder;
  std::unique_ptr<serve::Server> server;

  explicit ServedHands(const serve::ServerLimits& limits = {}) {
    server = required(serve::Server::open(
        required(serve::Socket::claim({}, {folder.path() / "nendo", ""})), two_gloves(), limits));
  }
  void send(std::uint8_t input, std::uint64_t number) const {
    server->input().sample(input,
                           numbered_sample(input == left_input ? Side::left : Side::right, number));
  }
};

/// A client that is plain system calls and nlohmann's JSON.
class LineClient {
public:
  explicit LineClient(const std::string& path)
      : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    const timeval patience{20, 0};
    ::setsockopt(fd_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    REQUIRE(::connect(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  }

  bool send(const std::string& bytes) const {
    return ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  /// Sends a request, and returns its answer. Lines before that are dropped.
  nlohmann::ordered_json ask(const std::string& request) {
    REQUIRE(send(request + "\n"));
    for (;;) {
      auto line = next();
      if (line["class"] == "WATCH" || line["class"] == "ERROR") return line;
    }
  }
  /// Returns the next line, or nothing at the end of the connection.
  std::optional<std::string> next_text() {
    for (;;) {
      if (const std::size_t end = heard_.find('\n'); end != std::string::npos) {
        std::string line = heard_.substr(0, end);
        heard_.erase(0, end + 1);
        return line;
      }
      std::array<char, 65536> buffer;
      const ssize_t got = ::recv(fd_.get(), buffer.data(), buffer.size(), 0);
      if (got <= 0) return std::nullopt;
      heard_.append(buffer.data(), static_cast<std::size_t>(got));
    }
  }
  nlohmann::ordered_json next() {
    const auto text = next_text();
    REQUIRE(text);
    return nlohmann::ordered_json::parse(*text);
  }
  /// Returns whether the server has closed the connection, after any lines.
  bool is_closed() {
    while (next_text()) {
    }
    return errno != EAGAIN;
  }
  void end_sending() const { ::shutdown(fd_.get(), SHUT_WR); }
  /// Ends also a read of another thread.
  void end_all() const { ::shutdown(fd_.get(), SHUT_RDWR); }
  void leave() { fd_.close(); }

private:
  UniqueFd fd_;
  std::string heard_;
};

} // namespace nendo::test
