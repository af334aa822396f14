// The window of a guided calibration: simulated wearers, and a mouse that presses buttons by name.

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <nendo/hand/calibration_store.hpp>

#include "gloves/open_hand.hpp"
#include "studio/calibration_person.hpp"
#include "support/memory_screen.hpp"
#include "support/pty_host.hpp"
#include "support/restraint.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"
#include "viewer/pointing.hpp"

namespace calibration_screen_test {

using namespace nendo;
using namespace nendo::test;
using hand::PoseId;
using viewer::Theme;

namespace {

constexpr const char* quick = "Quick: about a minute";
constexpr const char* full = "Full: about four minutes";
constexpr const char* touch_up = "Touch up: half a minute";

/// Calibrations of this test's own.
struct Store {
  TemporaryFolder folder;
  Store() { REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0); }
  std::filesystem::path path_of(const std::string& user, Side side) const {
    return folder.path() / "nendo" / "calibrations" / hand::calibration_file_name(user, "", side);
  }
  std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
      count += entry.is_regular_file() ? 1U : 0U;
    return count;
  }
};

/// What the hidden hand in an emulated glove does; its sensors read otherwise than a typical one's.
class HiddenHand {
public:
  std::atomic<int> step{0}; ///< 0 is a free motion, then flat, fist, and a half closed hand
  static constexpr double gain = 0.92;
  static constexpr double offset_rad = 0.09;

  static hand::SensorAngles angles(int step, double time_s) {
    const double bend = step == 0   ? 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * time_s / 2.0)
                        : step == 1 ? 0.0
                        : step == 2 ? 1.0
                                    : 0.5;
    hand::SensorAngles angles{};
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const hand::AssumedAngle& fist = hand::pose_of(PoseId::fist).assumed[slot];
      const bool bends = fist.known() && fist.angle_rad > 0.2;
      angles[slot] = bend * (bends ? fist.angle_rad : step == 0 ? 1.0 : 0.04);
    }
    return angles;
  }
  hand::SensorAngles worn(double time_s) const {
    hand::SensorAngles worn = angles(step, time_s);
    for (double& angle : worn)
      angle = gain * angle + offset_rad;
    return worn;
  }
};

void check_layout(const std::string& what) {
  const auto shown = viewer::controls();
  CAPTURE(what);
  CHECK(shown.size() > 2);
  for (std::size_t at = 0; at < shown.size(); ++at) {
    CAPTURE(shown[at].name);
    CHECK_FALSE(shown[at].is_cut);
    for (std::size_t other = 0; other < at; ++other) {
      const auto overlap =
          shown[at].max.cwiseMin(shown[other].max) - shown[at].min.cwiseMax(shown[other].min);
      CHECK_MESSAGE(overlap.minCoeff() <= 0.0F, shown[other].name);
    }
  }
}

} // namespace

TEST_SUITE("calibration_screen" * doctest::skip(!test::restraint_is_counted)) {
  TEST_CASE("a visitor calibrates an emulated glove by buttons, and its angles become the hand's") {
    const MemoryScreen memory;
    if (!memory.is_there()) return;
    const Store store;
    HiddenHand hand;
    emulator::EmulatorOptions options;
    options.cyberglove.played = [&](double time_s) { return hand.worn(time_s); };
    ServedEmulator served(options);
    const auto glove = gloves::open_glove("serial:" + served->tty_path());
    REQUIRE_MESSAGE(glove, (glove ? "" : glove.error().message));
    {
      Visitor visitor({{800, 600}, Theme::light, 1.0F});
      visitor.screen.emplace(**glove, calibrate::CalibrationRequest{});
      REQUIRE(visitor.screen->start());
      visitor.look(3);
      CHECK_FALSE(Visitor::find("Start")->is_possible); // whose?
      visitor.press("your name");
      visitor.type(U"anna");
      visitor.press(quick);
      REQUIRE(visitor.waits_for("Start"));
      visitor.press("Start");
      REQUIRE(visitor.waits_for("Enough joints have shown how far they go. Press Begin."));
      hand.step = 1;
      visitor.press("Begin");
      REQUIRE(visitor.waits_for("Taken. Now take this pose."));
      hand.step = 2;
      REQUIRE(visitor.waits_for("Keep"));
      CHECK(store.files() == 0);
      hand.step = 3;
      visitor.press("keep learning while I work");
      visitor.press("Keep");
      REQUIRE(visitor.outcome);
      REQUIRE(*visitor.outcome);
      CHECK((*visitor.outcome)->adapt);
      CHECK((*visitor.outcome)->written == store.path_of("anna", Side::right));
    }
    const auto written = hand::read_calibration(store.path_of("anna", Side::right));
    REQUIRE_MESSAGE(written, (written ? "" : written.error().message));
    CHECK(written->method == "quick");
    // The half closed hand, of which the calibration has seen nothing.
    SampleRing ring(1024);
    REQUIRE((*glove)->start(ring));
    GloveSample sample;
    const HostTime end = HostClock::now() + std::chrono::seconds(5);
    for (int samples = 0; samples < 90 && HostClock::now() < end;)
      if (ring.try_pop(sample)) ++samples;
    (*glove)->stop();
    const hand::SensorAngles truth = HiddenHand::angles(3, 0.0);
    const hand::SensorAngles angles = written->calibration.angles_rad(sample);
    for (const auto& finger : finger_sensors)
      for (const Sensor sensor : finger) {
        CAPTURE(name_of(sensor));
        CHECK(std::abs(angles[index_of(sensor)] - truth[index_of(sensor)]) < from_degrees(3.0));
      }
  }

  TEST_CASE("a full calibration is this wearer's, and a touch-up is possible from then on") {
    const MemoryScreen memory;
    if (!memory.is_there()) return;
    const Store store;
    Person person(2002, {{800, 600}, Theme::light, 1.0F}, {"anna"});
    person.look(2);
    CHECK_FALSE(Visitor::find(touch_up)->is_possible); // there is nothing to touch up
    person.begin(full);
    for (const PoseId pose : hand::full_takes())
      person.take(pose);
    REQUIRE(person.waits_for("Keep"));
    for (const PoseId pose :
         {PoseId::pinch_index, PoseId::pinch_middle, PoseId::pinch_ring, PoseId::pinch_little})
      person.take(pose, 0.5);
    for (const char* finger : {"index", "middle", "ring", "little"})
      CHECK(Visitor::find("thumb, " + std::string(finger) + " finger: touched") != nullptr);
    person.press("Keep");
    REQUIRE(person.outcome);
    const auto written = hand::read_calibration(store.path_of("anna", person.wearer.side()));
    REQUIRE_MESSAGE(written, (written ? "" : written.error().message));
    CHECK(written->method == "full");
    for (const Sensor sensor : {Sensor::index_mcp, Sensor::middle_pip, Sensor::ring_pip,
                                Sensor::little_mcp, Sensor::wrist_pitch}) {
      CAPTURE(name_of(sensor));
      CHECK(written->calibration[sensor].gain_rad_per_count ==
            doctest::Approx(person.wearer.truth()[sensor].gain_rad_per_count).epsilon(0.15));
    }
    person.outcome.reset();
    person.screen.reset();
    person.screen.emplace(person.glove, calibrate::CalibrationRequest{});
    REQUIRE(person.screen->start());
    person.look(2);
    person.press("anna"); // a recent name
    CHECK(Visitor::find(touch_up)->is_possible);
    person.begin(touch_up);
    for (const PoseId pose : hand::touch_up_poses())
      person.take(pose);
    REQUIRE(person.waits_for("Keep"));
    person.press("Keep");
    CHECK(hand::read_calibration(store.path_of("anna", person.wearer.side()))->method ==
          "full, touched up");
  }

  TEST_CASE("a finger that is held wrong is named, with the way in which it must go") {
    const MemoryScreen memory;
    if (!memory.is_there()) return;
    const Store store;
    Person person(2004, {{800, 600}, Theme::light, 1.0F}, {"bo"});
    person.begin(quick);
    hand::SensorAngles wrong = person.wearer.perform(PoseId::flat);
    wrong[index_of(Sensor::ring_mcp)] = wrong[index_of(Sensor::ring_pip)] = from_degrees(85.0);
    person.hold(wrong, 0.4);
    CHECK(Visitor::find("ring finger: straighten it.") != nullptr);
    person.take(PoseId::flat);
    wrong = person.wearer.perform(PoseId::fist);
    for (const Sensor sensor : finger_sensors[0])
      wrong[index_of(sensor)] = 0.0;
    person.hold(wrong, 0.4);
    CHECK(Visitor::find("index finger: bend it more.") != nullptr);
    person.take(PoseId::fist);
    CHECK(person.waits_for("Keep"));
  }

  TEST_CASE("Back, Skip, chips and keys do what they say, and nothing is written before Keep") {
    const MemoryScreen memory;
    if (!memory.is_there()) return;
    const Store store;
    Person person(2002, {{800, 600}, Theme::light, 1.0F}, {"cleo"});
    person.begin(full);
    CHECK(Visitor::find("Begin") == nullptr);
    person.take(PoseId::flat);
    person.take(PoseId::fist);
    CHECK(Visitor::find("spread")->is_possible); // it is asked for
    CHECK_FALSE(Visitor::find("thumb out")->is_possible);
    person.press("Skip");
    CHECK_FALSE(Visitor::find("spread")->is_possible);
    CHECK(Visitor::find("thumb out")->is_possible);
    person.press("Back"); // the fist is forgotten
    CHECK_FALSE(Visitor::find("spread")->is_possible);
    person.take(PoseId::flat, 0.2); // it counts once the hand has moved
    person.take(PoseId::fist);
    CHECK(Visitor::find("spread")->is_possible);
    person.press("flat"); // one that is taken, again
    CHECK_FALSE(Visitor::find("spread")->is_possible);
    person.type_key('N');
    REQUIRE(Visitor::find("Start again") != nullptr);
    CHECK(Visitor::find("fist")->is_possible);
    person.type_key('N'); // twice in a row
    CHECK(Visitor::find("Begin") != nullptr);
    CHECK(store.files() == 0);
    person.move_freely();
    person.type_key(' ');
    person.take(PoseId::flat);
    person.press("Finish now"); // the fist is missing
    REQUIRE(person.waits_for("fist"));
    CHECK(Visitor::find("Keep") == nullptr);
    person.take(PoseId::fist);
    person.press("Leave");
    REQUIRE(person.outcome);
    REQUIRE(*person.outcome);
    CHECK((*person.outcome)->kept == 2);
    CHECK_FALSE((*person.outcome)->finished);
    CHECK_FALSE(std::filesystem::exists(store.path_of("cleo", person.wearer.side())));

    person.outcome.reset(); // the next time it continues there
    person.screen.reset();
    person.screen.emplace(person.glove, calibrate::CalibrationRequest{"cleo"});
    REQUIRE(person.screen->start());
    person.take(PoseId::flat, 0.3);
    person.look(2);
    CHECK(Visitor::find("continue the poses of last time") != nullptr);
    person.press("Start");
    CHECK_FALSE(person.screen->has_unkept_poses()); // those of last time stay kept
    person.move_freely(1.0);
    person.press("Begin");
    person.take(PoseId::spread);
    CHECK(Visitor::find("thumb out")->is_possible);
    CHECK(person.screen->has_unkept_poses());
    person.press("Finish now");
    REQUIRE(person.waits_for("Discard"));
    person.press("Take poses again");
    REQUIRE(person.waits_for("Finish now"));
    person.take(PoseId::hook, 0.3);
    for (const PoseId pose : {PoseId::flat, PoseId::fist, PoseId::spread})
      if (Visitor::find("Keep") == nullptr) person.take(pose);
    person.press("Finish now");
    REQUIRE(person.waits_for("Discard"));
    person.press("Discard");
    REQUIRE(person.outcome);
    CHECK_FALSE((*person.outcome)->finished);
    CHECK(store.files() == 0);
  }

  TEST_CASE("what cannot be written is said, and can be discarded") {
    const MemoryScreen memory;
    if (!memory.is_there()) return;
    const Store store;
    const auto taken = store.folder.path() / "file";
    write_file(taken, "no folder");
    calibrate::CalibrationRequest request{"eve", calibrate::CalibrationKind::quick};
    request.out = taken / "eve.toml";
    Person person(2002, {{800, 600}, Theme::light, 1.0F}, request);
    person.begin(quick);
    for (const PoseId pose : hand::quick_poses())
      person.take(pose);
    REQUIRE(person.waits_for("Keep"));
    person.press("Keep");
    CHECK_FALSE(person.outcome);
    person.look(2);
    CHECK(std::ranges::any_of(viewer::controls(), [&](const viewer::Control& control) {
      return control.name.find(taken.string()) != std::string::npos;
    }));
    person.press("Discard");
    CHECK(person.outcome);
    CHECK(store.files() == 1);
  }

  TEST_CASE("the joint under the mouse is the one whose ball is there") {
    for (const Side side : {Side::left, Side::right}) {
      const hand::HandPose pose = hand::HandSkeleton(side).pose({}, studio::upright());
      constexpr render::Size size{1280, 720};
      const render::Camera camera =
          studio::camera_for(studio::view_of(PoseId::pinch_little, side), 0.4, 1.2);
      const Eigen::Vector3d knuckle = pose[hand::Joint::ring_intermediate].translation();
      const Eigen::Vector2d pixel = viewer::pixel_of(camera, knuckle, size).value();
      std::vector<studio::JointMark> marks;
      for (const Sensor sensor : sensors_22)
        marks.push_back({sensor, studio::place_of(sensor, pose), calibrate::Certainty::sure});
      const auto* const mark = studio::mark_at(pixel, camera, size, marks);
      REQUIRE(mark != nullptr);
      CHECK(mark->sensor == Sensor::ring_pip);
      const Eigen::Vector2d beside = pixel + Eigen::Vector2d(0.0, 25.0);
      CHECK(studio::mark_at(beside, camera, size, marks) == nullptr);
    }
  }

  TEST_CASE("no two controls overlap and no text is cut, in any step, at any size and scale") {
    const MemoryScreen memory;
    if (!memory.is_there()) return;
    struct Case {
      render::Size size;
      float scale;
    };
    for (const Case& one :
         {Case{{1280, 720}, 1.0F}, Case{{1920, 1080}, 1.0F}, Case{{1920, 1080}, 2.0F}}) {
      CAPTURE(one.size.width);
      CAPTURE(one.scale);
      const Store store;
      Person person(2002, {one.size, Theme::dark, one.scale}, {"anna"});
      person.look(3);
      check_layout("silent");
      person.take(PoseId::flat, 0.3);
      check_layout("before");
      person.press(full);
      person.press("Start");
      person.look(2);
      check_layout("free motion");
      const reference::FreeMotion motion(1, person.wearer.ranges());
      for (int n = 0; n < 900; ++n)
        person.push(motion.angles_rad(n / 90.0));
      person.look();
      person.press("Begin");
      person.look(2);
      check_layout("first pose");
      for (const PoseId pose : {PoseId::flat, PoseId::fist, PoseId::spread})
        person.take(pose);
      person.press("Start again");
      check_layout("a notice");
      person.press("Finish now");
      REQUIRE(person.waits_for("Keep"));
      person.look(2);
      check_layout("after");
    }
  }
}

} // namespace calibration_screen_test
