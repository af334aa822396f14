#pragma once
// Checks that every streamed glove must pass. Each function is the body of a test case. Its kind of
// glove has `plug(side)`, which returns a port with such a glove at the far end, `spec(path)`,
// which opens that, and `longest_record` in bytes.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/driver/open_glove.hpp>

#include "support/eventually.hpp"
#include "support/pty_unit.hpp"
#include "support/required.hpp"
#include "support/temporary_folder.hpp"

namespace nendo::test {

using namespace std::chrono_literals;

/// A kind of which there is an emulated unit.
struct Kind {
  std::function<std::unique_ptr<emulator::EmulatedUnit>(Side)> make;
  std::function<std::string(const std::string& path)> spec;
  std::uint64_t longest_record = 0;

  std::unique_ptr<PtyUnit> plug(Side side) const { return std::make_unique<PtyUnit>(make(side)); }
};

inline void check_conservation(const driver::StreamStats& stats, std::uint64_t longest_record) {
  CHECK(stats.bytes >= stats.record_bytes + stats.discarded_bytes);
  CHECK(stats.bytes - stats.record_bytes - stats.discarded_bytes < longest_record);
}

inline void no_glove_is_an_error_that_says_so(const Kind& kind, std::string_view noise) {
  struct Case {
    std::string noise;
    std::string said;
  };
  for (const Case& wrong : {Case{"", "switched on"}, Case{std::string(noise), "baud"}}) {
    const PtyUnit port(std::make_unique<Stranger>(wrong.noise));
    const std::string spec = kind.spec(port.path());
    const auto start = HostClock::now();
    const auto glove = driver::open_glove(spec);
    CHECK(HostClock::now() - start < 30s);
    REQUIRE_FALSE(glove);
    CAPTURE(glove.error().message);
    CHECK(glove.error().code == Errc::no_device);
    CHECK(glove.error().message.find(wrong.said) != std::string::npos);
    CHECK(glove.error().message.find(spec) == 0);
    CHECK(glove.error().message.find('\n') == std::string::npos);
  }
  const auto missing = driver::open_glove(kind.spec("/dev/nendo-no-such-port"));
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == Errc::no_device);
}

inline void samples_are_in_order_and_add_up(const Kind& kind) {
  const PtyUnit port(kind.make(Side::right));
  SampleRing ring(4096);
  auto glove = required(driver::open_glove(kind.spec(port.path())));
  const HostTime before = HostClock::now();
  test::require_ok(glove->start(ring));
  CHECK(glove->start(ring).error().code == Errc::failed);
  CHECK(eventually([&] { return ring.size() >= 20; }));
  glove->stop();
  std::uint64_t next = 0;
  HostTime last = before;
  ring.drain([&](const GloveSample& sample) {
    CHECK(sample.sequence == next++);
    CHECK(sample.arrival >= last);
    CHECK(sample.measured == sample.arrival);
    last = sample.arrival;
    CHECK(sample.present == glove->info().sensors);
    CHECK(sample.side == glove->info().side);
    CHECK(sample.wrist_switch == WristSwitch::unknown);
    for (const RawCount count : sample.raw)
      CHECK(count.value <= glove->info().counts.max_count);
  });
  CHECK(last <= HostClock::now());
  const driver::StreamStats stats = glove->stats();
  CHECK(stats.records == next);
  CHECK(stats.bad_records == 0);
  check_conservation(stats, kind.longest_record);
}

/// For gloves that stream by themselves.
inline void what_had_waited_is_no_rate(const Kind& kind) {
  const PtyUnit port(kind.make(Side::right));
  auto glove = required(driver::open_glove(kind.spec(port.path())));
  std::this_thread::sleep_for(2s); // nobody reads
  SampleRing ring(4096);
  test::require_ok(glove->start(ring));
  CHECK(eventually([&] { return glove->stats().rate_hz > 0.0; }));
  const double first_hz = glove->stats().rate_hz;
  // Of seconds in which nothing waited; of one in which nobody could read, if the machine was busy.
  double later_hz = 0.0;
  for (int second = 0; second < 4 && !(first_hz < 1.5 * later_hz); ++second) {
    const double before_hz = glove->stats().rate_hz;
    CHECK(eventually([&] { return glove->stats().rate_hz != before_hz; }));
    later_hz = std::max(later_hz, glove->stats().rate_hz);
  }
  glove->stop();
  CHECK(first_hz < 1.5 * later_hz);
}

template <class AnyKind>
void a_full_ring_refuses_and_counts(const AnyKind& kind) {
  const auto port = kind.plug(Side::right);
  SampleRing ring(8);
  auto glove = required(driver::open_glove(kind.spec(port->path())));
  test::require_ok(glove->start(ring));
  CHECK(eventually([&] { return glove->stats().ring_refused > 5; }));
  glove->stop();
  const driver::StreamStats stats = glove->stats();
  CHECK(stats.records == stats.ring_refused + ring.size());
  check_conservation(stats, kind.longest_record);
}

template <class AnyKind>
void stop_is_prompt_and_start_works_again(const AnyKind& kind) {
  const auto port = kind.plug(Side::right);
  SampleRing ring(4096);
  auto glove = required(driver::open_glove(kind.spec(port->path())));
  for (int round = 0; round < 2; ++round) {
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return glove->stats().records > 3; }));
    const auto start = HostClock::now();
    glove->stop();
    glove->stop();
    CHECK(HostClock::now() - start < 1s);
  }
}

template <class AnyKind>
void a_silent_stream_is_started_again(const AnyKind& kind) {
  const auto port = kind.plug(Side::right);
  SampleRing ring(1U << 14U);
  auto glove = required(driver::open_glove(kind.spec(port->path())));
  test::require_ok(glove->start(ring));
  REQUIRE(eventually([&] { return glove->stats().records > 3; }));
  port->mute = true;
  REQUIRE(eventually([&] { return glove->stats().silences >= 1; }));
  const std::uint64_t before = glove->stats().records;
  port->mute = false;
  CHECK(eventually([&] { return glove->stats().records > before + 3; }));
  glove->stop();
  const driver::StreamStats stats = glove->stats();
  CHECK(stats.silences == 1);
  CHECK(stats.reopened == 0);
  CHECK(stats.records == ring.size());
  check_conservation(stats, kind.longest_record);
}

inline void stop_is_prompt_while_silent_or_away(const Kind& kind) {
  for (const bool away : {false, true}) {
    CAPTURE(away);
    PtyUnit port(kind.make(Side::right));
    SampleRing ring(1U << 14U);
    auto glove = required(driver::open_glove(kind.spec(port.path())));
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return glove->stats().records > 3; }));
    port.mute = true;
    if (away) {
      port.unplug();
      std::this_thread::sleep_for(200ms); // nothing tells that the loss was noticed
    } else {
      REQUIRE(eventually([&] { return glove->stats().silences >= 1; }));
    }
    const auto start = HostClock::now();
    glove->stop();
    CHECK(HostClock::now() - start < 1s);
  }
}

inline void a_glove_that_vanishes_is_found_again(const Kind& kind, bool tells_its_hand) {
  const TemporaryFolder folder;
  const auto link = folder.path() / "glove";
  auto first = std::make_unique<PtyUnit>(kind.make(Side::right));
  std::filesystem::create_symlink(first->path(), link);
  SampleRing ring(1U << 14U);
  auto glove = required(driver::open_glove(kind.spec(link.string())));
  test::require_ok(glove->start(ring));
  REQUIRE(eventually([&] { return ring.size() > 3; }));

  first.reset();
  std::filesystem::remove(link);
  const PtyUnit second(kind.make(Side::left));
  std::filesystem::create_symlink(second.path(), link);
  REQUIRE(eventually([&] { return glove->stats().reopened == 1; }));
  ring.drain([](const GloveSample&) {});
  GloveSample sample;
  REQUIRE(eventually([&] { return ring.try_pop(sample); }));
  glove->stop();
  CHECK(sample.side == (tells_its_hand ? Side::left : Side::right));
  CHECK(glove->info().side == Side::right);
  check_conservation(glove->stats(), kind.longest_record);
}

/// An option that a kind of glove does not have or a value that it does not take, and the error's
/// words.
struct WrongOption {
  const char* options;
  const char* said;
};

inline void wrong_options_are_usage_errors(const std::string& kind,
                                           std::initializer_list<WrongOption> cases) {
  for (const WrongOption& wrong : cases) {
    const auto glove = driver::open_glove(kind + ":/dev/nendo-none" + wrong.options);
    REQUIRE_FALSE(glove);
    CAPTURE(glove.error().message);
    CHECK(glove.error().code == Errc::usage);
    CHECK(glove.error().message.find(wrong.said) != std::string::npos);
  }
  CHECK(driver::open_glove(kind + ":").error().code == Errc::usage);
}

/// A sensor, the angle of its joint in the relaxed hand, and the joint's range, in degrees.
struct RestingJoint {
  Sensor sensor;
  double angle;
  double range;
};

inline constexpr std::array resting_knuckles{
    RestingJoint{Sensor::thumb_mcp, 15, 55}, RestingJoint{Sensor::index_mcp, 23, 90},
    RestingJoint{Sensor::middle_mcp, 25, 90}, RestingJoint{Sensor::ring_mcp, 26, 90},
    RestingJoint{Sensor::little_mcp, 27, 90}};

/// Returns the first sample of the glove that `unit` emulates, whose hand is at rest.
inline GloveSample sample_at_rest(std::unique_ptr<emulator::EmulatedUnit> unit,
                                  const std::string& kind) {
  const PtyUnit port(std::move(unit));
  SampleRing ring(1U << 14U);
  auto glove = required(driver::open_glove(kind + ":" + port.path()));
  test::require_ok(glove->start(ring));
  GloveSample sample;
  REQUIRE(eventually([&] { return ring.try_pop(sample); }));
  return sample;
}

/// Checks the angles of `joints`, whose full range is `most` counts, to within `off` degrees.
inline void check_at_rest(const GloveSample& sample, std::span<const RestingJoint> joints,
                          double most, double off) {
  for (const RestingJoint& joint : joints) {
    CAPTURE(name_of(joint.sensor));
    const double degrees = sample[joint.sensor].value * joint.range / most;
    CHECK(std::abs(degrees - joint.angle) < off);
  }
}

} // namespace nendo::test
