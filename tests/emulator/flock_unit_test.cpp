#include "units/flock_unit.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "simulated/wrist_motion.hpp"
#include "support/pty_host.hpp"
#include "support/unit_bench.hpp"

namespace flock_unit_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::emulator;
using nendo::emulator::flock::FlockUnit;
using nendo::emulator::flock::FlockUnitOptions;
using nendo::test::Bytes;

namespace {

struct Bench : nendo::test::AdvancedBench<FlockUnit, FlockUnitOptions> {
  explicit Bench(const FlockUnitOptions& options = {}) : AdvancedBench(options), began(now) {}

  /// Sends the bytes, and returns what comes within 20 ms.
  Bytes command(const Bytes& bytes) {
    send(bytes);
    return after(20ms);
  }
  void configure(std::uint8_t units) {
    after(700ms);
    command({'P', 50, units});
    after(700ms);
  }

  EmulatedUnit::Time began;
};

/// A value of two bytes, from -1 to 1, by the layout as published.
double value_at(const Bytes& record, std::size_t k) {
  const int bits = ((record[2 * k + 1] & 0x7F) << 7 | (record[2 * k] & 0x7F)) << 2;
  return (bits >= 32768 ? bits - 65536 : bits) / 32768.0;
}

constexpr double step = 1.0 / 8192.0;

} // namespace

TEST_SUITE("flock_unit") {
  TEST_CASE("poses are those of the motion, within a step of the format") {
    for (const driver::WristMotion motion :
         {driver::WristMotion::orbit, driver::WristMotion::table, driver::WristMotion::rest}) {
      FlockUnitOptions options;
      options.motion = motion;
      Bench bench(options);
      bench.configure(2);
      bench.command({'P', 35, 1, 0xF1, ']', 0xF2, ']'});
      for (int k = 0; k < 200; ++k) {
        bench.after(37ms);
        const double time_s = std::chrono::duration<double>(bench.now - bench.began).count();
        const Bytes records = bench.command({'B'});
        REQUIRE(records.size() == 30);
        for (std::uint16_t station = 1; station <= 2; ++station) {
          const Bytes record(records.begin() + 15 * (station - 1), records.begin() + 15 * station);
          CHECK(record.back() == station);
          const auto pose = driver::receiver_pose(motion, station, 1, time_s);
          const double range_m = 36.0 * 0.0254;
          for (std::size_t at = 0; at < 3; ++at)
            CHECK(std::abs(value_at(record, at) * range_m - pose.position_m[at]) <= range_m * step);
          // The quaternion turns the transmitter's axes to the receiver's, so it is the inverse.
          double same = value_at(record, 3) * pose.turn_xyzw[3];
          for (std::size_t at = 0; at < 3; ++at)
            same -= value_at(record, 4 + at) * pose.turn_xyzw[at];
          CHECK(std::abs(same) == doctest::Approx(1.0).epsilon(0.0005));
        }
      }
    }
  }

  TEST_CASE("angles, matrix and quaternion are the same turn") {
    FlockUnitOptions options;
    options.motion = driver::WristMotion::table;
    Bench bench(options);
    bench.configure(2);
    for (int k = 0; k < 50; ++k) {
      bench.after(53ms);
      bench.send({'W', 'B', 'X', 'B', '\\', 'B'}); // at one time
      const Bytes bytes = bench.after(20ms);
      REQUIRE(bytes.size() == 6 + 18 + 8);
      const Bytes angles(bytes.begin(), bytes.begin() + 6);
      const Bytes matrix(bytes.begin() + 6, bytes.begin() + 24);
      const Bytes quaternion(bytes.begin() + 24, bytes.end());
      constexpr double pi = 3.14159265358979323846;
      const double azimuth = value_at(angles, 0) * pi;
      const double elevation = value_at(angles, 1) * pi;
      // The first row of the matrix is the receiver's x axis, in the transmitter's axes.
      CHECK(std::abs(value_at(matrix, 0) - std::cos(elevation) * std::cos(azimuth)) < 0.001);
      CHECK(std::abs(value_at(matrix, 1) - std::cos(elevation) * std::sin(azimuth)) < 0.001);
      CHECK(std::abs(value_at(matrix, 2) + std::sin(elevation)) < 0.001);
      const double w = value_at(quaternion, 0);
      const double x = value_at(quaternion, 1);
      const double y = value_at(quaternion, 2);
      const double z = value_at(quaternion, 3);
      CHECK(std::abs(value_at(matrix, 0) - (1 - 2 * (y * y + z * z))) < 0.001);
      CHECK(std::abs(value_at(matrix, 1) - 2 * (x * y - w * z)) < 0.001);
      CHECK(std::abs(value_at(matrix, 2) - 2 * (x * z + w * y)) < 0.001);
    }
  }

  TEST_CASE("a receiver that crosses the transmitter's plane appears opposite") {
    FlockUnitOptions options;
    options.motion = driver::WristMotion::cross;
    Bench bench(options);
    bench.configure(2);
    bench.command({']'});
    bool flipped = false;
    for (int k = 0; k < 100; ++k) {
      bench.after(50ms);
      const Bytes record = bench.command({'B'});
      REQUIRE(record.size() == 14);
      CHECK(value_at(record, 0) >= -step);
      flipped = flipped || value_at(record, 1) > 0.1; // station 1 is on the left
    }
    CHECK(flipped);
  }

  TEST_CASE("a controller is the first unit and has the range of 144 inches") {
    FlockUnitOptions options;
    options.birds = {2, 3};
    options.has_controller = true;
    options.motion = driver::WristMotion::rest;
    Bench bench(options);
    bench.configure(3);
    CHECK(bench.command({'O', 36}) == Bytes{0xC1, 0xE0, 0xE0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    CHECK(test::text_of(bench.command({'O', 15})) == "6DERC     ");
    CHECK(test::text_of(bench.command({0xF2, 'O', 15})) == "6DFOB     ");
    const Bytes record = bench.command({0xF2, ']', 0xF2, 'B'});
    REQUIRE(record.size() == 14);
    CHECK(std::abs(value_at(record, 0) * 144.0 * 0.0254 - 0.34) < 0.001);
  }

  TEST_CASE("bytes in the quiet after a configuration spoil it") {
    Bench bench;
    bench.after(700ms);
    bench.command({'P', 50, 2});
    CHECK((bench.command({'O', 36})[0] & 0x40) == 0);
    CHECK(bench.command({'O', 10}) == Bytes{33});
  }

  TEST_CASE("records wait for the line, and those that it cannot take are refused") {
    FlockUnitOptions options;
    options.baud = 2400;
    Bench bench(options);
    bench.configure(2);
    bench.command({'P', 35, 1});
    bench.command({'@'});
    std::size_t bytes = 0;
    for (int k = 0; k < 100; ++k)
      bytes += bench.after(100ms).size();
    CHECK(bytes <= 2400);
    CHECK(bytes > 2300);
    CHECK(bench.unit.counters().bytes_refused > 0);
  }

  TEST_CASE("after a power cycle it must be configured again") {
    Bench bench;
    bench.configure(2);
    CHECK((bench.command({'O', 36})[0] & 0x40) != 0);
    bench.unit.inject({Incident::Kind::power_cycle}, bench.now);
    CHECK(bench.command({'O', 36}).empty());
    bench.after(1s);
    CHECK((bench.command({'O', 36})[0] & 0x40) == 0);
  }

  TEST_CASE("any bytes are heard") {
    Bench bench;
    bench.configure(2);
    Bytes all;
    for (int k = 0; k < 256; ++k)
      for (int next = 0; next < 256; next += 5) {
        bench.send({static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(next), 0});
        bench.after(1ms);
      }
    CHECK(bench.unit.counters().bytes_refused < 1'000'000'000);
  }

  TEST_CASE("a host that was written from the facts alone agrees with each command") {
    EmulatorOptions options;
    options.device = "flock";
    options.motion = "rest";
    options.tracker.stations = {1, 2};
    test::ServedEmulator emulator(options);
    const std::string command =
        std::string("python3 -B " NENDO_FLOCK_HOST " ") + emulator->tty_path();
    CHECK(std::system(command.c_str()) == 0);
  }

  TEST_CASE("addresses that no bird can have are usage errors") {
    EmulatorOptions options;
    options.device = "flock";
    options.tracker.stations = {15};
    CHECK(DeviceEmulator::open(options).error().code == Errc::usage);
    options.tracker.stations = {1};
    options.firmware = "erc";
    CHECK(DeviceEmulator::open(options).error().message.find("2 to 14") != std::string::npos);
    options.tracker.stations = {2};
    CHECK(DeviceEmulator::open(options));
    options.tracker.baud = 1200;
    CHECK(DeviceEmulator::open(options).error().message.find("baud") != std::string::npos);
  }
}

} // namespace flock_unit_test
