#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/replay_driver.hpp>

#include <chrono>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/base/byte_writer.hpp>

#include "support/takes.hpp"

namespace tracked_take_test {

using namespace nendo;
using namespace nendo::recording;
using namespace std::chrono_literals;
using flow::Mode;
using test::RecordedLoop;

namespace {

PoseSample any_pose(std::mt19937& random, HostTime now, std::uint64_t number) {
  std::uniform_real_distribution<double> noise(-0.002, 0.002);
  PoseSample pose;
  pose.arrival = now;
  pose.measured = now - 5ms;
  pose.sequence = number;
  pose.station = 2;
  const double angle = 0.01 * static_cast<double>(number);
  pose.position_m = {0.5 + 0.1 * std::cos(angle) + noise(random), 0.1 * std::sin(angle), -0.2};
  pose.turn_xyzw = {0.0, 0.0, std::sin(0.5 * angle), std::cos(0.5 * angle)};
  if (random() % 20 == 0) pose.position_m[0] += 0.5; // which the gate refuses
  if (random() % 30 == 0) pose.error = 'k';
  return pose;
}

/// Two tracked hands shape; the right one is lost for a while, and someone moves them back.
void play(RecordedLoop& live) {
  std::mt19937 random(7);
  HostTime now = HostClock::now();
  for (std::uint64_t tick = 0; tick < 400; ++tick) {
    now += 4ms;
    live.test.bend(static_cast<int>(tick / 20), now);
    live.test.poses[0]->try_push(any_pose(random, now, tick));
    const bool is_lost = tick >= 150 && tick < 220;
    if (!is_lost) live.test.poses[1]->try_push(any_pose(random, now, tick));
    if (tick == 300) live.test.commands.try_push(flow::Recentre{});
    live.test.loop->tick(tick, now, now + 100us);
  }
}

RecordedLoop tracked_loop(Mode mode) {
  return RecordedLoop(mode, hand::FilterKind::off, false, false, flow::SwitchAction::none, nullptr,
                      false, true);
}

} // namespace

TEST_SUITE("tracked_take") {
  TEST_CASE("a take with two trackers is replayed bit for bit, with its refusals and losses") {
    for (const Mode mode : {Mode::type1, Mode::type2, Mode::clay}) {
      CAPTURE(name_of(mode));
      RecordedLoop live = tracked_loop(mode);
      live.record();
      play(live);
      REQUIRE(live.end());
      auto reader = TakeReader::open(live.path);
      REQUIRE(reader);
      REQUIRE(reader->setup().trackers.size() == 2);
      CHECK(reader->setup().trackers[1].side == Side::right);
      CHECK(reader->setup().trackers[1].info.facts.size() == 1);
      auto replay = LoopReplay::make(reader->setup(), live.test.model);
      REQUIRE(replay);
      while (const auto entry = reader->next())
        (*replay)->feed(*entry);
      CHECK((*replay)->is_exact());
      REQUIRE(reader->ending());
      CHECK(reader->ending()->shape == sum_of((*replay)->loop().final_shape()));
      for (const std::size_t hand : {0U, 1U}) {
        const auto& counts = (*replay)->loop().stats().wrists[hand].counts;
        const auto& wanted = live.test.loop->stats().wrists[hand].counts;
        CHECK(counts.poses == wanted.poses);
        CHECK(counts.refused == wanted.refused);
        CHECK(counts.losses == wanted.losses);
        CHECK(wanted.refused > 0);
      }
      CHECK(live.test.loop->stats().wrists[1].counts.losses == 1);
    }
  }

  TEST_CASE("a reader that knows no trackers refuses the loop, and a loop without its tracker is "
            "no loop") {
    RecordedLoop live = tracked_loop(Mode::type1);
    std::uint32_t chunks = 0;
    const auto bytes = setup_bytes(live.setup, chunks);
    // The last byte of LOOP names the rules of the sculptor, which older readers compare with 3.
    auto reader = ChunkReader::of(bytes, "a setup");
    REQUIRE(reader);
    Setup without;
    bool has_loop = false;
    while (const auto chunk = reader->next()) {
      if (chunk->type == chunk_type("LOOP")) {
        has_loop = true;
        CHECK(std::to_integer<int>(chunk->payload.back()) == 7);
      }
      if (chunk->type != tracker_chunk)
        REQUIRE(read_setup_chunk(chunk->type, chunk->payload, without));
    }
    CHECK(has_loop);
    const auto replay = LoopReplay::make(without, live.test.model);
    REQUIRE_FALSE(replay);
    CHECK(replay.error().message.find("tracker") != std::string::npos);
  }

  TEST_CASE("a pose is read as it was written, whatever its numbers are") {
    PoseSample pose;
    pose.arrival = HostTime(5s);
    pose.measured = HostTime(4s);
    pose.device_time = 17ns;
    pose.has_device_time = true;
    pose.sequence = 9;
    pose.station = 4;
    pose.error = 'k';
    pose.position_m = {1.0, -2.0, std::numeric_limits<double>::infinity()};
    pose.turn_xyzw = {0.1, 0.2, 0.3, 1e300};
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    put_entry(writer, RecordedPose{Side::left, pose});
    LogEntries entries(bytes);
    const auto read = pose_of(*entries.next());
    REQUIRE(read);
    CHECK(read->side == Side::left);
    CHECK(read->pose.arrival == pose.arrival);
    CHECK(read->pose.measured == pose.measured);
    CHECK(read->pose.device_time == pose.device_time);
    CHECK(read->pose.has_device_time);
    CHECK(read->pose.sequence == 9);
    CHECK(read->pose.station == 4);
    CHECK(read->pose.error == 'k');
    CHECK(read->pose.position_m == pose.position_m);
    CHECK(read->pose.turn_xyzw == pose.turn_xyzw);
    CHECK_FALSE(entries.next());
  }

  TEST_CASE("replay: gives the poses of each hand again, and says what a recording has not") {
    RecordedLoop live = tracked_loop(Mode::type1);
    live.record();
    play(live);
    REQUIRE(live.end());
    const std::array more{replay_tracker_driver()};
    const std::string name = "replay:" + live.path.string();
    const std::array both{name + "?hand=left&speed=20", name + "?speed=20&hand=right"};
    auto stations = driver::open_trackers(both, more);
    REQUIRE(stations);
    CHECK((*stations)[0].tracker == (*stations)[1].tracker);
    CHECK((*stations)[0].station != (*stations)[1].station);
    CHECK((*stations)[1].source == both[1]);
    PoseRing left(1024), right(1024);
    const std::array rings{&left, &right};
    REQUIRE(driver::start_trackers(*stations, rings));
    const HostTime end = HostClock::now() + 20s;
    while (!(*stations)[0].tracker->has_ended() && HostClock::now() < end)
      std::this_thread::sleep_for(1ms);
    CHECK(left.size() == 400);
    CHECK(right.size() == 330);
    PoseSample pose;
    REQUIRE(left.try_pop(pose));
    CHECK(pose.is_replayed);
    CHECK(pose.recorded_arrival - pose.recorded_measured == 5ms);

    const std::array alone{name};
    const auto vague = driver::open_trackers(alone, more);
    REQUIRE_FALSE(vague);
    CHECK(vague.error().message.find("?hand=left") != std::string::npos);
    RecordedLoop still(Mode::type1);
    still.record();
    REQUIRE(still.end());
    const std::array none{"replay:" + still.path.string()};
    const auto untracked = driver::open_trackers(none, more);
    REQUIRE_FALSE(untracked);
    CHECK(untracked.error().code == Errc::bad_input);
  }
}

} // namespace tracked_take_test
