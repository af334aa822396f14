// The guide of nendo calibrate, and what it shows.

#include <algorithm>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "calibrate/demonstration.hpp"
#include "calibrate/guide.hpp"
#include "calibrate/hand_drawing.hpp"
#include "calibrate/session.hpp"
#include "reference/wearers.hpp"

namespace calibration_guide_test {

using namespace nendo;
using namespace nendo::reference;
using namespace nendo::calibrate;
using namespace nendo::gloves;
using hand::PoseId;

namespace {

/// A wearer in front of a guide.
struct Session {
  Wearer wearer;
  CalibrationGuide guide;
  double time_s = 10.0;

  explicit Session(std::uint64_t seed, std::span<const PoseId> poses = hand::full_poses())
      : wearer(seed), guide(poses, CountScale{}) {}

  /// The last event that was one, while the wearer holds the angles for so long.
  CalibrationGuide::Event hold(const hand::SensorAngles& angles, double seconds) {
    auto last = CalibrationGuide::Event::none;
    for (double end = time_s + seconds; time_s < end; time_s += 1.0 / 90.0) {
      GloveSample sample = wearer.read(angles);
      sample.arrival = HostTime(from_seconds(time_s));
      sample.measured = sample.arrival;
      const auto event = guide.push(sample);
      if (event != CalibrationGuide::Event::none) last = event;
    }
    return last;
  }
  CalibrationGuide::Event do_pose(PoseId pose) { return hold(wearer.perform(pose), 2.0); }
};

bool is_printable(const std::string& line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

} // namespace

TEST_SUITE("calibration_guide") {
  TEST_CASE("poses that are held are taken in their order, once each") {
    Session session(3001);
    for (const PoseId pose : hand::full_poses()) {
      CAPTURE(hand::pose_of(pose).name);
      REQUIRE_FALSE(session.guide.is_done());
      CHECK(session.guide.asked() == pose);
      CHECK(session.do_pose(pose) == CalibrationGuide::Event::captured);
    }
    CHECK(session.guide.is_done());
    const auto readings = session.guide.readings();
    REQUIRE(readings.size() == hand::full_poses().size());
    for (std::size_t k = 0; k < readings.size(); ++k)
      CHECK(readings[k].pose == hand::full_poses()[k]);
    CHECK(session.hold(session.wearer.perform(PoseId::flat), 2.0) ==
          CalibrationGuide::Event::none); // nothing is asked for any more
  }

  TEST_CASE("holding on is not the next pose") {
    Session session(3002);
    const auto flat = session.wearer.perform(PoseId::flat);
    CHECK(session.hold(flat, 2.0) == CalibrationGuide::Event::captured);
    CHECK(session.hold(flat, 10.0) == CalibrationGuide::Event::none);
    CHECK(session.guide.number() == 1);
  }

  TEST_CASE("a pose that cannot be the one asked for is refused, and a sensor named by which") {
    Session session(3003);
    REQUIRE(session.do_pose(PoseId::flat) == CalibrationGuide::Event::captured);
    REQUIRE(session.do_pose(PoseId::fist) == CalibrationGuide::Event::captured);
    while (session.guide.asked() != PoseId::spread)
      session.guide.skip();
    // A flat hand's fingers are asked for; a hand with fingers bent is none.
    const auto event = session.do_pose(PoseId::hook);
    CHECK(event == CalibrationGuide::Event::implausible);
    REQUIRE(session.guide.implausible_sensor());
    CHECK(std::string(name_of(*session.guide.implausible_sensor())).find("ip") !=
          std::string::npos);
    CHECK(session.guide.asked() == PoseId::spread);
    CHECK(session.do_pose(PoseId::spread) == CalibrationGuide::Event::captured);
  }

  TEST_CASE("one can go back, and skip, but flat and fist are asked for again") {
    Session session(3004);
    session.guide.skip(); // flat
    REQUIRE(session.do_pose(hand::full_poses()[1]) == CalibrationGuide::Event::captured);
    session.guide.go_back();
    CHECK(session.guide.number() == 1);
    CHECK(session.guide.readings().empty());
    std::set<PoseId> asked;
    for (std::size_t k = 0; k < 3 * hand::full_poses().size(); ++k) {
      asked.insert(session.guide.asked());
      session.guide.skip();
      REQUIRE_FALSE(session.guide.is_done());
    }
    CHECK(asked.contains(PoseId::flat));
    CHECK(asked.contains(PoseId::fist));
  }

  TEST_CASE("a session continues where another one stopped") {
    Session before(3005);
    for (std::size_t k = 0; k < 4; ++k)
      REQUIRE(before.do_pose(hand::full_poses()[k]) == CalibrationGuide::Event::captured);
    Session after(3005);
    hand::CountRanges motion;
    motion.present.add(Sensor::ring_pip);
    constexpr auto slot = static_cast<std::size_t>(Sensor::ring_pip);
    motion.low_counts[slot] = 3.0;
    motion.high_counts[slot] = 254.0;
    after.guide.restore(before.guide.readings(), motion);
    CHECK(after.guide.number() == 4);
    CHECK(after.guide.readings().size() == 4);
    const GloveSample sample = after.wearer.read(after.wearer.perform(PoseId::flat));
    for (int n = 0; n < 3; ++n)
      after.guide.push_free_motion(sample);
    CHECK(after.guide.free_motion().low_counts[slot] == 3.0);
    CHECK(after.guide.free_motion().high_counts[slot] == 254.0);
    CHECK(after.guide.free_motion().present.has(Sensor::index_mcp));
  }

  TEST_CASE("what is asked for twice is taken twice, and both takes count") {
    constexpr std::array poses{PoseId::flat, PoseId::fist, PoseId::flat};
    Session session(3007, poses);
    CHECK_FALSE(session.guide.is_again());
    CHECK(session.do_pose(PoseId::flat) == CalibrationGuide::Event::captured);
    CHECK(session.do_pose(PoseId::fist) == CalibrationGuide::Event::captured);
    CHECK(session.guide.is_again());
    CHECK(session.do_pose(PoseId::flat) == CalibrationGuide::Event::captured);
    CHECK(session.guide.is_done());
    const auto readings = session.guide.readings();
    REQUIRE(readings.size() == 3);
    CHECK(readings[2].pose == PoseId::flat);

    Session after(3007, poses); // each take finds its place again
    after.guide.restore(readings, {});
    CHECK(after.guide.is_done());
    for (std::size_t k = 0; k < readings.size(); ++k)
      CHECK(after.guide.readings()[k].held.mean_counts == readings[k].held.mean_counts);
  }

  TEST_CASE("a pose can be taken once more, beside the first take, even if nothing differs") {
    Session session(3008);
    session.guide.take_again(); // of nothing
    CHECK(session.guide.asked() == PoseId::flat);
    const auto flat = session.wearer.perform(PoseId::flat);
    REQUIRE(session.hold(flat, 2.0) == CalibrationGuide::Event::captured);
    const std::size_t poses = session.guide.pose_count();
    for (int n = 0; n < 3; ++n) // one key, held down
      session.guide.take_again();
    CHECK(session.guide.pose_count() == poses + 1);
    CHECK(session.guide.asked() == PoseId::flat);
    CHECK(session.hold(flat, 5.0) == CalibrationGuide::Event::none); // held on
    session.hold(session.wearer.perform(PoseId::fist), 0.3);
    CHECK(session.hold(flat, 2.0) == CalibrationGuide::Event::captured);
    CHECK(session.guide.readings().size() == 2);
    CHECK(session.guide.asked() == PoseId::fist);
    Session after(3008); // a session that continues has both
    after.guide.restore(session.guide.readings(), {});
    CHECK(after.guide.readings().size() == 2);
    CHECK(after.guide.asked() == PoseId::fist);
    for (std::size_t n = 0; n < 2 * CalibrationGuide::max_takes; ++n) {
      after.guide.take_again();
      after.hold(after.wearer.perform(PoseId::fist), 0.3);
      after.do_pose(PoseId::flat);
      if (after.guide.asked() != PoseId::fist) break;
    }
    const auto readings = after.guide.readings();
    CHECK(std::count_if(readings.begin(), readings.end(), [](const auto& reading) {
            return reading.pose == PoseId::flat;
          }) == CalibrationGuide::max_takes);
  }

  TEST_CASE("a pose that is taken again replaces its take, even if nothing differs") {
    Session session(3009);
    const auto flat = session.wearer.perform(PoseId::flat);
    REQUIRE(session.hold(flat, 2.0) == CalibrationGuide::Event::captured);
    session.guide.go_back();
    CHECK(session.guide.readings().empty());
    CHECK(session.hold(flat, 5.0) == CalibrationGuide::Event::none); // held on
    session.hold(session.wearer.perform(PoseId::fist), 0.3);
    CHECK(session.hold(flat, 2.0) == CalibrationGuide::Event::captured);
    CHECK(session.guide.readings().size() == 1);
  }

  TEST_CASE("a fist that is the flat hand is none, also where another session took the flat hand") {
    for (const bool quick : {true, false}) {
      CAPTURE(quick);
      const auto poses = quick ? hand::quick_poses() : hand::full_takes();
      Session before(3011, poses);
      const auto flat = before.wearer.perform(PoseId::flat);
      REQUIRE(before.hold(flat, 2.0) == CalibrationGuide::Event::captured);
      Session after(3011, poses);
      after.guide.restore(before.guide.readings(), {});
      REQUIRE(after.guide.asked() == PoseId::fist);
      CHECK(after.hold(flat, 3.0) == CalibrationGuide::Event::none); // held on since then
      CHECK(after.guide.capture().state() == hand::CaptureState::unchanged);
      // Another flat hand, or the same after a movement, is no fist either.
      hand::SensorAngles turned = flat;
      turned[static_cast<std::size_t>(Sensor::wrist_pitch)] += 0.6;
      CHECK(after.hold(turned, 2.0) == CalibrationGuide::Event::implausible);
      CHECK(after.hold(flat, 2.0) == CalibrationGuide::Event::implausible);
      CHECK(after.guide.implausible_sensor());
      CHECK(after.guide.asked() == PoseId::fist);
      CHECK(after.do_pose(PoseId::fist) == CalibrationGuide::Event::captured);
    }
  }

  TEST_CASE("fist and flat in each other's place are noticed at the second, and one can go back") {
    Session session(3012, hand::quick_poses());
    REQUIRE(session.do_pose(PoseId::fist) == CalibrationGuide::Event::captured); // as if flat
    CHECK(session.do_pose(PoseId::flat) == CalibrationGuide::Event::implausible);
    session.guide.go_back();
    CHECK(session.guide.asked() == PoseId::flat);
    session.do_pose(PoseId::fist); // on the way
    session.guide.go_back();
    CHECK(session.do_pose(PoseId::flat) == CalibrationGuide::Event::captured);
    CHECK(session.do_pose(PoseId::fist) == CalibrationGuide::Event::captured);
    CHECK(session.guide.is_done());
  }

  TEST_CASE("every wearer's flat hand and fist are taken, in either order") {
    for (std::uint64_t seed = 3100; seed < 3140; ++seed) {
      CAPTURE(seed);
      Session session(seed, hand::quick_poses());
      CHECK(session.do_pose(PoseId::flat) == CalibrationGuide::Event::captured);
      CHECK(session.do_pose(PoseId::fist) == CalibrationGuide::Event::captured);
      Session other(seed, hand::quick_poses());
      const std::vector<hand::PoseReading> fist{session.guide.readings().back()};
      other.guide.restore(fist, {});
      REQUIRE(other.guide.asked() == PoseId::flat);
      CHECK(other.do_pose(PoseId::flat) == CalibrationGuide::Event::captured);
      CHECK(other.guide.is_done());
    }
  }

  TEST_CASE("one that restarts has no pose and no free motion, and takes any pose first") {
    Session session(3013);
    const auto flat = session.wearer.perform(PoseId::flat);
    for (int n = 0; n < 3; ++n)
      session.guide.push_free_motion(session.wearer.read(flat));
    REQUIRE(session.hold(flat, 2.0) == CalibrationGuide::Event::captured);
    REQUIRE(session.do_pose(PoseId::fist) == CalibrationGuide::Event::captured);
    session.guide.take_again();
    session.guide.reset();
    CHECK(session.guide.pose_count() == hand::full_poses().size());
    CHECK(session.guide.readings().empty());
    CHECK_FALSE(session.guide.has_any());
    CHECK(session.guide.free_motion().present.bits == 0);
    CHECK(session.guide.number() == 0);
    CHECK(session.hold(flat, 2.0) == CalibrationGuide::Event::captured);
    CHECK(session.do_pose(PoseId::fist) == CalibrationGuide::Event::captured);
  }

  TEST_CASE("a file of takes without end is cut at the most that count") {
    Session session(3010);
    REQUIRE(session.do_pose(PoseId::flat) == CalibrationGuide::Event::captured);
    const std::vector<hand::PoseReading> many(1000, session.guide.readings().front());
    session.guide.restore(many, {});
    CHECK(session.guide.readings().size() == CalibrationGuide::max_takes);
    CHECK(session.guide.asked() == PoseId::fist);
  }

  TEST_CASE("every pose is drawn for either hand, and no two alike") {
    for (const Side side : {Side::left, Side::right}) {
      std::set<std::string> drawings;
      for (const PoseId pose : hand::full_poses()) {
        std::string both;
        for (const HandView view : {HandView::palm, HandView::side}) {
          const auto lines = draw_hand(demonstrated(pose, side), side, view, 36, 18);
          REQUIRE(lines.size() == 18);
          for (const auto& line : lines) {
            CHECK(line.size() == 36);
            CHECK(is_printable(line));
            both += line;
          }
        }
        CHECK(std::count_if(both.begin(), both.end(), [](char c) { return c != ' '; }) > 100);
        drawings.insert(both);
      }
      CHECK(drawings.size() == hand::full_poses().size());
    }
  }

  TEST_CASE("the picture fits every screen, and says what to do on all but the smallest") {
    Session session(3006);
    session.do_pose(PoseId::flat);
    driver::GloveInfo info;
    info.sensors = sensors_22;
    info.side = session.wearer.side();
    const std::string user = "d\033[2Jo";
    GloveSample sample = session.wearer.read(session.wearer.perform(PoseId::fist));
    SeenCounts seen;
    seen.add(sample);
    const hand::HandPose pose = demonstrated(session.guide.asked(), info.side);
    const CalibrationPicture picture{&info, &user, &session.guide, &sample,   &seen,
                                     0.0,   &pose, true,           sensors_22};
    for (int rows = 1; rows <= 60; rows += 3)
      for (int columns = 1; columns <= 200; columns += 9) {
        const auto lines = calibration_lines(picture, {columns, rows});
        CHECK(static_cast<int>(lines.size()) <= std::max(rows, 1));
        for (const auto& line : lines) {
          CHECK(static_cast<int>(line.size()) <= columns);
          CHECK(is_printable(line));
        }
        if (rows < 4 || columns < 80) continue;
        CHECK(lines.back().find("q quit") != std::string::npos);
        CHECK(lines[1] == hand::pose_of(session.guide.asked()).instruction);
      }
  }

  TEST_CASE("at 40 columns every instruction, notice and key can be read to its end") {
    driver::GloveInfo info;
    info.sensors = sensors_22;
    const std::string user = "anna";
    const std::string notice = "No calibration yet: index_middle_abduction: the poses contradict "
                               "each other; hold them again. b goes back a pose; n restarts.";
    Session session(3014);
    const GloveSample sample = session.wearer.read(session.wearer.perform(PoseId::flat));
    SeenCounts seen;
    seen.add(sample);
    for (; session.guide.number() + 1 < session.guide.pose_count(); session.guide.skip()) {
      const hand::HandPose pose = demonstrated(session.guide.asked(), info.side);
      const CalibrationPicture picture{&info, &user, &session.guide, &sample,    &seen,
                                       0.0,   &pose, false,          sensors_22, notice};
      for (const int columns : {40, 31, 60}) {
        std::string text;
        for (const auto& line : calibration_lines(picture, {columns, 24})) {
          CHECK(static_cast<int>(line.size()) <= columns);
          text += line + " ";
        }
        CAPTURE(text);
        for (const std::string_view whole :
             {hand::pose_of(session.guide.asked()).instruction, std::string_view(notice),
              std::string_view("Then SPACE begins."), std::string_view("q quit")})
          CHECK(text.find(whole) != std::string::npos);
      }
    }
  }
}

} // namespace calibration_guide_test
