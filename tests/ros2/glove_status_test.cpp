// What /diagnostics says of gloves and trackers.

#include <cstdint>
#include <string>

#include <doctest/doctest.h>

#include "ros2/glove_status.hpp"

namespace glove_status_test {

using namespace nendo;
using ros::DiagnosticLevel;

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

ros2::HandsRecord record_at(std::int64_t woke_ns) {
  ros2::HandsRecord record;
  record.record.woke_ns = woke_ns;
  record.record.ticks = 1000;
  record.record.hands[1].flags = NENDO_PUBLISH_PRESENT;
  record.record.hands[1].samples = 500;
  record.states.hands[1].measured = 0x3FFFFF;
  record.states.hands[1].sampled_ns = woke_ns - 5'000'000;
  return record;
}

std::string value_of(const ros::DiagnosticStatus& status, const std::string& key) {
  for (const ros::KeyValue& value : status.values)
    if (value.key == key) return value.value;
  return "(none)";
}

} // namespace

TEST_SUITE("glove_status") {
  TEST_CASE("a glove that delivers is ok, with its counts and rates") {
    ros2::GloveStatus status("clay");
    ros::DiagnosticArray out;
    status.of_run(record_at(second_ns), second_ns, 77 * second_ns, out);
    ros2::HandsRecord later = record_at(3 * second_ns);
    later.record.ticks = 1180;
    later.record.hands[1].samples = 800;
    status.of_run(later, 3 * second_ns, 79 * second_ns, out);
    CHECK(out.header.stamp == ros::Time{79, 0});
    REQUIRE(out.status.size() == 3);
    CHECK(out.status[0].name == "nendo-ros2: run");
    CHECK(out.status[0].hardware_id == "shm:clay");
    CHECK(out.status[1].name == "nendo-ros2: left glove");
    CHECK(out.status[1].message == "no glove");
    CHECK(out.status[1].values.empty());
    CHECK(out.status[2].name == "nendo-ros2: right glove");
    for (const auto& one : out.status)
      CHECK(one.level == DiagnosticLevel::ok);
    CHECK(value_of(out.status[0], "ticks per second") == "90.0");
    CHECK(value_of(out.status[2], "samples") == "800");
    CHECK(value_of(out.status[2], "samples per second") == "150.0");
    CHECK(value_of(out.status[2], "age of the newest sample in ms") == "5.0");
    CHECK(value_of(out.status[2], "measured angles") == "22");
    CHECK(value_of(out.status[2], "tracker") == "none");
    CHECK(value_of(out.status[2], "wrist switch") == "(none)");
  }

  TEST_CASE("silent gloves, lost trackers and stopped runs have their levels") {
    ros2::GloveStatus status("clay");
    ros::DiagnosticArray out;
    ros2::HandsRecord record = record_at(second_ns);
    auto& state = record.states.hands[1];
    state.flags = NENDO_PUBLISH_TRACKED | NENDO_PUBLISH_HAS_SWITCH | NENDO_PUBLISH_SWITCH_ON;
    status.of_run(record, second_ns, 0, out);
    CHECK(out.status[2].level == DiagnosticLevel::ok);
    CHECK(value_of(out.status[2], "tracker") == "moves the wrist");
    CHECK(value_of(out.status[2], "wrist switch") == "on");
    state.flags |= NENDO_PUBLISH_LOST;
    status.of_run(record, second_ns, 0, out);
    CHECK(out.status[2].level == DiagnosticLevel::warn);
    CHECK(value_of(out.status[2], "tracker") == "lost");
    record.record.hands[1].flags |= NENDO_PUBLISH_SILENT;
    status.of_run(record, second_ns, 0, out);
    CHECK(out.status[2].level == DiagnosticLevel::error);
    CHECK(out.status[0].level == DiagnosticLevel::ok);
    status.of_run(record, 3 * second_ns, 0, out);
    CHECK(out.status[0].level == DiagnosticLevel::error);
    status.of_no_run(0, out);
    for (const auto& one : out.status) {
      CHECK(one.level == DiagnosticLevel::stale);
      CHECK(one.message == "no run publishes to shm:clay");
      CHECK(one.values.empty());
    }
  }

  TEST_CASE("counts that begin again give no rate") {
    ros2::GloveStatus status("clay");
    ros::DiagnosticArray out;
    status.of_run(record_at(second_ns), second_ns, 0, out);
    ros2::HandsRecord next = record_at(2 * second_ns);
    next.record.ticks = 3;
    status.of_run(next, 2 * second_ns, 0, out);
    CHECK(value_of(out.status[0], "ticks per second") == "0.0");
  }
}

} // namespace glove_status_test
