// What the server writes, the driver's parser reads with the same bits.

#include "serve/lines.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/version.hpp>

#include "serve_fixtures.hpp"
#include "served/served_lines.hpp"
#include "support/random_poses.hpp"

namespace lines_test {

using namespace nendo;
using nlohmann::ordered_json;

namespace {

HostClock::duration random_time(std::mt19937_64& random) {
  return HostClock::duration(static_cast<std::int64_t>(random() >> 3U) -
                             static_cast<std::int64_t>(std::uint64_t{1} << 60U));
}

template <class Sample>
void set_random_times(Sample& sample, std::mt19937_64& random) {
  sample.arrival = HostTime(random_time(random));
  sample.measured = HostTime(random_time(random));
  sample.sequence = random();
  sample.has_device_time = random() % 2 == 0;
  if (sample.has_device_time) sample.device_time = random_time(random);
  sample.is_replayed = random() % 2 == 0;
  if (!sample.is_replayed) return;
  sample.recorded_arrival = HostTime(random_time(random));
  sample.recorded_measured = HostTime(random_time(random));
}

GloveSample random_sample(std::mt19937_64& random) {
  GloveSample sample;
  set_random_times(sample, random);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (random() % 3 > 0)
      sample.set(static_cast<Sensor>(slot), RawCount{static_cast<std::uint16_t>(random())});
  sample.sampled_too_fast = random() % 2 == 0;
  sample.wrist_switch = static_cast<WristSwitch>(random() % 3);
  sample.side = random() % 2 == 0 ? Side::left : Side::right;
  return sample;
}

/// Any bits that are a finite number.
double random_number(std::mt19937_64& random) {
  for (;;) {
    const auto number = std::bit_cast<double>(random());
    if (std::isfinite(number)) return number;
  }
}

PoseSample random_pose(std::mt19937_64& random) {
  PoseSample pose;
  set_random_times(pose, random);
  for (double& number : pose.position_m)
    number = random_number(random);
  for (double& number : pose.turn_xyzw)
    number = random_number(random);
  pose.station = static_cast<std::uint16_t>(random());
  pose.error = static_cast<char>(' ' + random() % 95);
  return pose;
}

template <class Sample>
void check_same_times(const Sample& one, const Sample& other) {
  CHECK(one.arrival == other.arrival);
  CHECK(one.measured == other.measured);
  CHECK(one.sequence == other.sequence);
  CHECK(one.has_device_time == other.has_device_time);
  CHECK(one.device_time == other.device_time);
  CHECK(one.is_replayed == other.is_replayed);
  CHECK(one.recorded_arrival == other.recorded_arrival);
  CHECK(one.recorded_measured == other.recorded_measured);
}

template <std::size_t count>
bool are_same_bits(const std::array<double, count>& one, const std::array<double, count>& other) {
  return std::bit_cast<std::array<std::uint64_t, count>>(one) ==
         std::bit_cast<std::array<std::uint64_t, count>>(other);
}

/// Reads a line as the driver does.
template <class Kind>
Kind read(const std::string& object) {
  const auto line = driver::served::decode_line(object);
  REQUIRE_MESSAGE(line, object);
  REQUIRE(std::holds_alternative<Kind>(*line));
  return *std::get_if<Kind>(&*line);
}

std::vector<std::string> keys_of(const ordered_json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items())
    keys.push_back(key);
  return keys;
}

} // namespace

TEST_SUITE("serve_lines") {
  TEST_CASE("samples come through with all their bits") {
    std::mt19937_64 random(1);
    for (int turn = 0; turn < 500; ++turn) {
      const GloveSample sample = random_sample(random);
      const std::size_t glove = random() % 16;
      const std::uint64_t dropped = random();
      const std::string text =
          serve::with_count(serve::sample_line(sample, glove), "dropped", dropped);
      REQUIRE(text.find('\n') == text.size() - 1);
      const auto line = read<driver::served::SampleLine>(text.substr(0, text.size() - 1));
      CHECK(line.glove == glove);
      CHECK(line.dropped == dropped);
      check_same_times(line.sample, sample);
      CHECK(line.sample.raw == sample.raw);
      CHECK(line.sample.present == sample.present);
      CHECK(line.sample.sampled_too_fast == sample.sampled_too_fast);
      CHECK(line.sample.wrist_switch == sample.wrist_switch);
      CHECK(line.sample.side == sample.side);
    }
  }

  TEST_CASE("poses come through with all their bits") {
    std::mt19937_64 random(2);
    for (int turn = 0; turn < 500; ++turn) {
      const PoseSample pose = random_pose(random);
      const auto line = read<driver::served::PoseLine>(serve::pose_line(pose, 1));
      CHECK(line.tracker == 1);
      CHECK(line.dropped == 0);
      check_same_times(line.pose, pose);
      CHECK(are_same_bits(line.pose.position_m, pose.position_m));
      CHECK(are_same_bits(line.pose.turn_xyzw, pose.turn_xyzw));
      CHECK(line.pose.station == pose.station);
      CHECK(line.pose.error == pose.error);
    }
  }

  TEST_CASE("numbers that are not finite are null, and bytes that are no letter a question mark") {
    PoseSample pose;
    pose.position_m = {std::numeric_limits<double>::infinity(),
                       std::numeric_limits<double>::quiet_NaN(), 1.0};
    pose.error = '\xE4';
    const auto line = ordered_json::parse(serve::pose_line(pose, 0));
    CHECK(line["position_m"][0].is_null());
    CHECK(line["position_m"][1].is_null());
    CHECK(line["error"] == "?");
    CHECK_FALSE(driver::served::decode_line(serve::pose_line(pose, 0)));
  }

  TEST_CASE("gloves and trackers come through, whatever their strings contain") {
    const std::string odd = "a \"quoted\" \\ \x01 \xC3\xA4 \xFF}\n{";
    serve::Devices devices = test::two_gloves();
    serve::ServedGlove& glove = devices.gloves[0];
    glove.info.model = odd;
    glove.info.side = Side::right; // a glove of the other hand
    glove.info.facts.insert(glove.info.facts.begin(), {"zz", odd});
    glove.info.counts = {4095, true};
    glove.info.rate_hz = 0.1;
    glove.info.kind = driver::SourceKind::recorded;
    glove.info.recording = "take.nendo";
    const auto line = read<driver::served::GloveLine>(serve::glove_line(glove, 7));
    CHECK(line.index == 7);
    CHECK(line.side == Side::left);
    CHECK(line.info.source == glove.info.source);
    CHECK(line.info.model.starts_with("a \"quoted\" \\ ? "));
    CHECK(line.info.model == printable(line.info.model));
    CHECK(line.info.side == Side::right);
    CHECK(line.info.sensors == glove.info.sensors);
    CHECK(line.info.rate_hz == 0.1);
    CHECK(line.info.counts == glove.info.counts);
    CHECK(line.info.abilities.wrist_switch);
    REQUIRE(line.info.facts.size() == 3);
    CHECK(line.info.facts[0].name == "zz");
    CHECK(line.info.facts[1].value == "Aleft");
    CHECK(line.info.kind == driver::SourceKind::recorded);
    CHECK(line.info.recording.starts_with("/"));
    CHECK(line.info.recording.ends_with("/take.nendo"));

    const serve::ServedTracker& tracker = devices.trackers[0];
    const auto served = read<driver::served::TrackerLine>(serve::tracker_line(tracker, 0));
    CHECK(served.side == Side::right);
    CHECK(served.station == 4);
    CHECK(served.info.source == tracker.info.source);
    CHECK(served.info.model == "FASTRAK");
    CHECK(served.info.stations == tracker.info.stations);
    CHECK(served.info.rate_hz == 120.0);
    CHECK(are_same_bits(served.info.stage_from_tracker_xyzw, tracker.info.stage_from_tracker_xyzw));
  }

  TEST_CASE("the server's other lines are read by the driver") {
    const auto version = read<driver::served::VersionLine>(serve::version_line("hands"));
    CHECK(version.protocol == 1);
    CHECK(version.version == NENDO_VERSION);
    CHECK(read<driver::served::WatchLine>(serve::watch_line({true, false, 30.0})).samples);
    CHECK_FALSE(read<driver::served::WatchLine>(serve::watch_line({})).samples);
    CHECK(read<driver::served::ErrorLine>(serve::error_line("no \"x\"")).message == "no \"x\"");
  }

  TEST_CASE("hands have all joints, angles and distances, in a fixed order") {
    std::mt19937 random(3);
    serve::HandsFrame frame;
    frame.tick = 12;
    frame.woke = HostTime(std::chrono::nanoseconds(5'000'000'001));
    flow::HandFrame& hand = frame.hands[flow::Placement::index_of(Side::right)];
    hand.present = true;
    hand.angles = test::random_angles(random);
    hand.pose = hand::HandSkeleton(Side::right).pose(hand.angles, test::random_place(random));
    hand.sensors = sensors_18;
    hand.samples = 99;
    hand.lost = true;
    hand.wrist_switch = WristSwitch::off;
    const std::string text = serve::with_count(serve::hands_line(frame), "skipped", 4);
    const auto line = ordered_json::parse(text);
    CHECK(keys_of(line) ==
          std::vector<std::string>{"class", "tick", "time_ns", "hands", "skipped"});
    CHECK(line["time_ns"] == 5'000'000'001);
    CHECK(line["skipped"] == 4);
    REQUIRE(line["hands"].size() == 1);
    const auto& right = line["hands"][0];
    CHECK(keys_of(right) == std::vector<std::string>{"side", "samples", "sampled_ns", "silent",
                                                     "switch", "tracked", "lost", "tracked_ns",
                                                     "joints", "angles_rad", "measured",
                                                     "pinch_m"});
    CHECK(right["side"] == "right");
    CHECK(right["samples"] == 99);
    CHECK(right["lost"] == true);
    CHECK(right["switch"] == "off");
    CHECK(right["tracked_ns"].is_null());
    REQUIRE(right["joints"].size() == 26);
    std::size_t at = 0;
    for (const auto& [name, joint] : right["joints"].items()) {
      CHECK(name == name_of(static_cast<hand::Joint>(at)));
      const Eigen::Vector3d place = hand.pose.joints[at++].translation();
      for (std::size_t axis = 0; axis < 3; ++axis)
        CHECK(joint["position_m"][axis].get<double>() == place[static_cast<Eigen::Index>(axis)]);
      double squares = 0.0;
      for (const auto& part : joint["orientation_xyzw"])
        squares += part.get<double>() * part.get<double>();
      CHECK(squares == doctest::Approx(1.0));
    }
    REQUIRE(right["angles_rad"].size() == 23);
    CHECK(right["angles_rad"]["ring_pip_flexion"].get<double>() ==
          hand.angles[hand::Angle::ring_pip_flexion]);
    // 18 sensors measure no DIP joint.
    for (const auto& name : right["measured"])
      CHECK(name.get<std::string>().find("dip") == std::string::npos);
    CHECK(right["measured"].size() > 12);
    const auto distance = [&](const char* one, const char* other) {
      double squares = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        squares += std::pow(right["joints"][one]["position_m"][axis].get<double>() -
                                right["joints"][other]["position_m"][axis].get<double>(),
                            2);
      return std::sqrt(squares);
    };
    CHECK(keys_of(right["pinch_m"]) ==
          std::vector<std::string>{"index", "middle", "ring", "little"});
    for (const auto& [finger, metres] : right["pinch_m"].items())
      CHECK(metres.get<double>() ==
            doctest::Approx(distance("thumb_tip", (finger + "_tip").c_str())));
  }
}

} // namespace lines_test
