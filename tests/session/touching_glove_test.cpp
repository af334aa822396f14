// Hands that touch the model, from `--right sim:touch` to the loop's frames.

#include <doctest/doctest.h>

#include "gloves/open_hand.hpp"
#include "motions/touching_hand.hpp"
#include "session/open_hands.hpp"
#include "session/run_session.hpp"
#include "support/program.hpp"
#include "support/surface_distance.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

namespace touching_glove_test {

using namespace nendo;

namespace {

// What noise and the converter's steps may do to a fingertip; 19 of 20 stay below 2.8 mm.
constexpr double max_off_m = 0.008;

} // namespace

TEST_SUITE("touching_glove") {
  TEST_CASE("a GLOVE is distinguished from others by its kind and motion") {
    const deform::Mesh ball = test::sphere(16, 32, 10.0);
    for (const char* touching :
         {"sim:touch", "sim:touch?seed=3", "sim:press", "sim:knead", "sim:grip?rate=120"}) {
      motions::PlannedHand planned{ball, 0.8, Side::right};
      CHECK(gloves::open_glove(touching, Side::right, &planned));
      CHECK(planned.T_stage_wrist);
      CHECK((planned.wrist_path == nullptr) == std::string_view(touching).starts_with("sim:touch"));
    }
    for (const char* other : {"sim", "sim:grasp", "sim:touching", "serial:touch", "", "?"}) {
      motions::PlannedHand planned{ball, 0.8, Side::right};
      (void)gloves::open_glove(other, Side::right, &planned);
      CHECK_FALSE(planned.T_stage_wrist);
    }
  }

  TEST_CASE("the loop places both hands where they touch, and sees them there") {
    const deform::Mesh ball = test::sphere(32, 64, 10.0);
    session::RunOptions options;
    options.left = "sim:touch?seed=7";
    options.right = "sim:touch?seed=7";
    EventCount event_count;
    const auto opened = session::open_hands(options, ball, event_count);
    REQUIRE(opened);
    for (const auto& hand : opened->hands)
      hand.glove->stop(); // so that the first samples are what the loop shows
    const auto placed = session::place_loop(options, opened->hands, ball);
    REQUIRE(placed);
    for (const auto& hand : opened->hands)
      hand.ring->drain([](const GloveSample&) {});
    placed->loop->tick(0, HostClock::now());
    REQUIRE(placed->loop->frames().update());
    const flow::Frame& frame = placed->loop->frames().front();
    for (const auto& hand : opened->hands) {
      const std::size_t at = flow::Placement::index_of(hand.side);
      const auto meant =
          motions::TouchingHand::make(ball, hand::HandSkeleton(hand.side), {.seed = 7});
      REQUIRE(meant);
      const auto tips = frame.hands[at].pose.fingertip_positions();
      for (std::size_t k = 0; k < hand::finger_count; ++k) {
        const Eigen::Vector3d tip = tips.col(static_cast<Eigen::Index>(k));
        const motions::TouchTarget target =
            meant->target(static_cast<hand::Finger>(k), to_seconds(hand.first.device_time));
        CHECK((tip - target.place_m()).norm() < max_off_m);
        const double off_m = test::nearest_triangle(ball, frame.units_per_metre * tip).distance /
                             frame.units_per_metre;
        CHECK(std::abs(off_m - std::abs(target.depth_m)) < max_off_m + 0.001);
      }
    }
  }

  TEST_CASE("what cannot be touched is one line that names the remedy") {
    const test::TemporaryFolder folder;
    const auto points = (folder.path() / "points.obj").string();
    test::write_file(points, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    const auto done = test::nendo({"run", "--right", "sim:touch", "--mesh", points, "--out",
                                   (folder.path() / "shape.obj").string()});
    CHECK(done.exit_code == static_cast<int>(Errc::bad_input));
    CHECK(done.err.find("sim:sculpt") != std::string::npos);
    CHECK(std::count(done.err.begin(), done.err.end(), '\n') == 2); // the first: it has no faces
    for (const std::string glove : {"sim:touch?seed=x", "sim:touch?colour=red"})
      CHECK(test::nendo({"run", "--left", glove}).exit_code == static_cast<int>(Errc::usage));
  }

  TEST_CASE("a run with touching hands shapes the model and folds it nowhere") {
    const test::TemporaryFolder folder;
    const auto out = (folder.path() / "shape.obj").string();
    const auto done = test::nendo({"run", "--left", "sim:touch", "--right", "sim:touch?seed=2",
                                   "--duration", "2", "--json", "--out", out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    CHECK(done.out.find("\"failed\":0") != std::string::npos);
    CHECK(std::filesystem::exists(out));
  }
}

} // namespace touching_glove_test
