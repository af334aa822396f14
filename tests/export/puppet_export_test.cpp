// A recorded puppet as a `.glb`, read back by the tests' own reader. The shapes to compare with are
// those of the loop that was recorded; the exporter replays it.

#include <algorithm>
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include <nendo/puppet/puppet_edit.hpp>

#include "export/gltf_export.hpp"
#include "export/morphs.hpp"
#include "support/counted_frames.hpp"
#include "support/glb_reader.hpp"
#include "support/recorded_motion.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/edit.hpp"
#include "timeline/reduce.hpp"

namespace puppet_export_test {

using namespace nendo;
using namespace nendo::exporting;
using nendo::test::Glb;

namespace {

/// On the ball of the tests. One function goes below 0, one above 1, and one is of a joint that the
/// test leaves alone. A puppet has its functions in the order of their names.
std::string puppet_text(const std::string& distance) {
  return "version = 1\nmodel = \"ball.obj\"\ndistance = \"" + distance + "\"\n" + R"(
[points]
nose = { at = [0, 0, 1], radius = 0.9 }
ear = { at = [1, 0, 0], radius = 1.1 }
crown = { at = [0, 1, 0], radius = 0.7, pin = true }
[functions.earWiggle]
input = "left.middle_flexion"
travel_deg = -30
least = -0.8
move = { ear = [0.3, 0.05, 0], nose = [0, 0, 0.04] }
[functions.idle]
input = "left.wrist_yaw"
travel_deg = 20
move = { ear = [0, 0, 0.3] }
[functions.nod]
input = "left.little_flexion"
travel_deg = 10
most = 1.6
turn = { degrees = 12, axis = [1, 0, 0], through = [0, 0, 0], points = { nose = 1, ear = 0.5 } }
[functions.poke]
input = "right.index_flexion"
travel_deg = 25
curve = "ease"
move = { nose = [0.1, -0.1, 0.25] }
)";
}

const std::vector<std::string> names{"earWiggle", "earWiggle_negative", "idle", "nod", "poke"};
/// Of each target: its function, and the function's value at a weight of 1.
const std::vector<std::size_t> functions{0, 0, 1, 2, 3};
const std::vector<double> unit_values{1.0, -1.0, 1.0, 1.6, 1.0};

struct PuppetMotion {
  std::string distance = "surface";
  flow::Mode mode = flow::Mode::type1;
  std::optional<flow::Request> request{}; ///< halfway, while the hands are bent
  bool edits = false; ///< at a third and at two thirds, while the hands are bent
};

/// The ear goes farther out; a pin becomes a point that a function moves.
std::shared_ptr<const puppet::Rig> edited(const puppet::Rig& rig, bool first,
                                          const deform::Mesh& model) {
  const auto to =
      first ? puppet::with_move(rig, *rig.puppet().function_named("earWiggle"), 1, {0.5, 0.1, 0.0})
            : puppet::with_function(rig, {{0, 0, -1}, 0.6}, {0, 0, -0.3},
                                    *puppet::HandSignal::named("right.middle_flexion"), 0.4);
  if (!to) throw std::runtime_error(to.error().message);
  return std::make_shared<const puppet::Rig>(*to, model);
}

/// Hands bend and stretch, and the frames are kept as they were made.
struct RecordedPuppet {
  explicit RecordedPuppet(const PuppetMotion& motion) : played(motion.mode) {
    const auto puppet = puppet::parse_puppet(puppet_text(motion.distance), "test");
    if (!puppet) throw std::runtime_error(puppet.error().message);
    auto& test = played.test;
    test.options.rig = std::make_shared<const puppet::Rig>(*puppet, test.model);
    test.options.sculptor.deformer.supports = test.options.rig->supports();
    test.loop =
        std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs, test.options);
    played.setup = test::setup_of(test);
    played.setup.loop->puppet.text = puppet->text;
    played.record();
    constexpr std::uint64_t ticks = 60;
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      const HostTime woke = played.setup.begun_host + (tick + 1) * std::chrono::milliseconds(10);
      const double turn = 6.283185307179586 * static_cast<double>(tick) / (ticks - 1);
      test.bend(static_cast<int>(30.0 * (1.0 - std::cos(turn))), woke);
      if (motion.edits && (tick == 20 || tick == 40)) {
        const auto& now = test.loop->changes().puppet(test.loop->changes().newest_puppet());
        if (!played.change_puppet(edited(*now, tick == 20, test.model)))
          throw std::runtime_error("the edit was refused");
      }
      if (motion.request && tick == ticks / 2) test.commands.try_push(*motion.request);
      test.loop->tick(tick, woke, woke);
      test.loop->frames().update();
      const flow::Frame& frame = test.loop->frames().front();
      times_s.push_back(seconds_between(played.setup.begun_host, woke));
      shapes.push_back(test.vertices_of(frame));
      values.push_back(frame.functions);
      puppets.push_back(frame.puppet);
    }
    if (!played.end()) throw std::runtime_error("not recorded");
  }

  test::CountedFrames frames() const {
    auto opened = takes::RecordedFrames::open(played.path, played.test.model);
    if (!opened) throw std::runtime_error(opened.error().message);
    return test::CountedFrames(*std::move(opened));
  }
  Result<Exported> export_it(takes::FrameSource& source, const Choice& choice = {}) const {
    return export_gltf(source, choice, {.tolerance = 1e-3}, path());
  }
  Result<Exported> export_it(const Choice& choice = {}) const {
    test::CountedFrames source = frames();
    return export_it(source, choice);
  }
  std::filesystem::path path() const { return played.folder.path() / "take.glb"; }
  Glb read() const { return Glb(test::file_bytes(path())); }
  const deform::Points& rest() const { return played.test.model.vertices; }
  double diagonal() const { return deform::diagonal_of(rest()); }
  double since_first_s(std::size_t frame) const { return times_s[frame] - times_s[0]; }

  /// Of all frames, in parts of the diagonal.
  double farthest_off(const Glb& glb) const {
    double worst = 0.0;
    for (std::size_t at = 0; at < shapes.size(); ++at)
      worst = std::max(worst, test::farthest(glb.vertices(0, since_first_s(at)), shapes[at]));
    return worst / diagonal();
  }

  test::RecordedLoop played;
  std::vector<double> times_s;
  std::vector<deform::Points> shapes;
  std::vector<decltype(flow::Frame::functions)> values;
  std::vector<std::uint32_t> puppets;
};

std::vector<std::string> target_names(const Glb& glb) {
  return glb.json["meshes"][0]["extras"]["targetNames"];
}

} // namespace

TEST_SUITE("puppet_export") {
  TEST_CASE("each function of a puppet is a target with its name, and its values are the weights") {
    for (const std::string distance : {"surface", "air"}) {
      CAPTURE(distance);
      const RecordedPuppet take({.distance = distance});
      const auto done = take.export_it();
      REQUIRE(done);
      REQUIRE(done->morphs);
      CHECK(done->morphs->basis == MorphBasis::functions);
      CHECK(done->morphs->targets == names.size());
      const Glb glb = take.read();
      CHECK(target_names(glb) == names);
      CHECK(glb.json["meshes"][0]["extras"]["targetValues"].size() == names.size());
      double most = 0.0;
      std::vector<double> lowest(4, 0.0), highest(4, 0.0);
      for (std::size_t at = 0; at < take.shapes.size(); ++at) {
        const auto weights = glb.animated(0, "weights", take.since_first_s(at), {});
        REQUIRE(weights.size() == static_cast<Eigen::Index>(names.size()));
        CHECK(weights.minCoeff() >= 0.0); // Blender takes no others
        CHECK(weights.maxCoeff() <= 1.0);
        std::vector<double> values(4, 0.0);
        for (std::size_t target = 0; target < names.size(); ++target)
          values[functions[target]] +=
              unit_values[target] * weights[static_cast<Eigen::Index>(target)];
        for (std::size_t function = 0; function < 4; ++function) {
          const auto value = static_cast<double>(take.values[at][function]);
          CHECK(values[function] == doctest::Approx(value).epsilon(1e-5));
          lowest[function] = std::min(lowest[function], value);
          highest[function] = std::max(highest[function], value);
        }
        most = std::max(most, test::farthest(take.shapes[at], take.rest()));
      }
      CHECK(lowest[0] < -0.7);
      CHECK(highest[1] == 0.0); // nothing moves it
      CHECK(highest[2] > 1.2);
      CHECK(highest[3] > 0.9);
      CHECK(most > 0.05 * take.diagonal());
      const double off = take.farthest_off(glb);
      MESSAGE(distance << ": off by " << off << " of the diagonal");
      CHECK(off < ControlMorphs::max_error);
      CHECK(off < done->morphs->greatest_error + 1e-7);
    }
  }

  TEST_CASE("at a value of 0 the shape is the rest, and at 1 a point is where its function says") {
    const RecordedPuppet take(PuppetMotion{});
    REQUIRE(take.export_it());
    const Glb glb = take.read();
    const auto& primitive = glb.json["meshes"][0]["primitives"][0];
    const Eigen::Matrix3Xd rest = glb.accessor(primitive["attributes"]["POSITION"]);
    CHECK(test::farthest(rest, take.rest()) < 1e-7 * take.diagonal());
    for (const double weight : glb.json["meshes"][0]["weights"])
      CHECK(weight == 0.0);
    const auto way = [&](std::size_t target) -> Eigen::Matrix3Xd {
      return glb.accessor(primitive["targets"][target]["POSITION"].get<std::size_t>());
    };
    // Vertex 0 of the ball is where the nose is.
    CHECK((way(4).col(0) - Eigen::Vector3d(0.1, -0.1, 0.25)).norm() < 1e-6);
    CHECK((way(0).col(0) - Eigen::Vector3d(0.0, 0.0, 0.04)).norm() < 1e-6);
    CHECK((way(0) + way(1)).isZero(0.0));
    CHECK(way(2).col(0).norm() < 1e-6);
    CHECK(way(2).colwise().norm().maxCoeff() > 0.25); // unused, and yet there
    // Behind all radii nothing moves: vertex 1 is opposite.
    for (std::size_t target = 0; target < names.size(); ++target)
      CHECK(way(target).col(1).isZero(0.0));
  }

  TEST_CASE("a commit along the surface leaves the functions as they are") {
    const RecordedPuppet take({.request = flow::Request::commit});
    const auto done = take.export_it();
    REQUIRE(done);
    CHECK(done->morphs->basis == MorphBasis::functions);
    CHECK(take.farthest_off(take.read()) < ControlMorphs::max_error);
  }

  TEST_CASE("a puppet that is edited on the way is a model of its own from there on, exact") {
    for (const std::string distance : {"surface", "air"}) {
      for (const auto& request :
           {std::optional<flow::Request>(), std::optional(flow::Request::commit)}) {
        if (distance == "air" && request) continue; // no sum, as without edits
        CAPTURE(distance);
        const RecordedPuppet take({.distance = distance, .request = request, .edits = true});
        const auto done = take.export_it();
        REQUIRE(done);
        REQUIRE(done->morphs);
        CHECK(done->morphs->basis == MorphBasis::functions);
        CHECK(done->morphs->models == 3);
        const Glb glb = take.read();
        CHECK(target_names(glb) == names);
        const std::vector<std::string> last = glb.json["meshes"][2]["extras"]["targetNames"];
        CHECK(last.size() == names.size() + 1);
        std::array<int, 3> frames{};
        double worst = 0.0;
        for (std::size_t at = 0; at < take.shapes.size(); ++at) {
          const std::size_t shown = take.puppets[at];
          REQUIRE(shown < frames.size());
          ++frames[shown];
          const double time_s = take.since_first_s(at);
          worst = std::max(worst, test::farthest(glb.vertices(shown, time_s), take.shapes[at]));
          for (std::size_t node = 0; node < frames.size(); ++node)
            CHECK((glb.animated(node, "scale", time_s + 1e-6, Eigen::Vector3d::Zero()).norm() >
                   0.0) == (node == shown));
        }
        CHECK(*std::min_element(frames.begin(), frames.end()) > 15);
        CHECK(worst < ControlMorphs::max_error * take.diagonal());
        // At other rates the frames are held while the take continues.
        const auto slow = take.export_it({.rate_hz = 24.0});
        REQUIRE(slow);
        CHECK(slow->morphs->basis == MorphBasis::functions);
        CHECK(slow->morphs->models == 3);
      }
    }
  }

  TEST_CASE(
      "shapes that are no sums of the functions are reported, and are as near as is asked for") {
    for (const PuppetMotion& motion :
         {PuppetMotion{.request = flow::Request::undo}, PuppetMotion{.mode = flow::Mode::type2},
          PuppetMotion{.distance = "air", .request = flow::Request::commit}}) {
      const RecordedPuppet take(motion);
      test::CountedFrames frames = take.frames();
      const auto done = take.export_it(frames);
      REQUIRE(done);
      CHECK(frames.made == take.shapes.size()); // once
      REQUIRE(done->morphs);
      CHECK(done->morphs->has_puppet);
      CHECK(done->morphs->basis == MorphBasis::key_shapes);
      const Glb glb = take.read();
      CHECK(target_names(glb) != names);
      CHECK(take.farthest_off(glb) < 1.01e-3);
    }
  }

  TEST_CASE("the file by functions is the same if control vectors are not tried beside them") {
    for (const std::string distance : {"surface", "air"}) {
      CAPTURE(distance);
      const RecordedPuppet take({.distance = distance});
      test::CountedFrames frames = take.frames();
      REQUIRE(take.export_it(frames));
      const std::string bytes = test::file_bytes(take.path());
      test::CountedFrames others = take.frames();
      others.says_one_model = false; // so that there can be no control vectors
      REQUIRE(take.export_it(others));
      CHECK(test::file_bytes(take.path()) == bytes);
    }
  }

  TEST_CASE("a timeline of the take has the same targets, also mirrored, and the player's shapes") {
    const RecordedPuppet take(PuppetMotion{});
    auto made = timeline::timeline_of_take(take.played.path, take.played.test.model, {0.0, 0.0});
    REQUIRE(made);
    for (const bool mirrors : {false, true}) {
      CAPTURE(mirrors);
      if (mirrors) REQUIRE(timeline::mirror(made->timeline, 0.0));
      const auto frames_of = [&] {
        auto frames = takes::TimelineFrames::make(made->timeline, take.played.test.model);
        REQUIRE(frames);
        return *std::move(frames);
      };
      const auto done = take.export_it(*frames_of());
      REQUIRE(done);
      CHECK(done->morphs->basis == MorphBasis::functions);
      const Glb glb = take.read();
      CHECK(target_names(glb) == names);
      const auto frames = frames_of();
      double worst = 0.0, most = 0.0;
      while (frames->next()) {
        const deform::Points shape = take.played.test.vertices_of(frames->frame());
        worst = std::max(worst, test::farthest(glb.vertices(0, frames->time_s()), shape));
        most = std::max(most, test::farthest(shape, take.rest()));
      }
      CHECK(worst < ControlMorphs::max_error * take.diagonal());
      CHECK(most > 0.05 * take.diagonal());
    }
  }

  TEST_CASE("a part of a take that begins in the middle has the same targets") {
    const RecordedPuppet take(PuppetMotion{});
    const auto done = take.export_it({.from_s = 0.295, .to_s = 0.5});
    REQUIRE(done);
    CHECK(done->morphs->basis == MorphBasis::functions);
    const Glb glb = take.read();
    CHECK(target_names(glb) == names);
    const double off = test::farthest(glb.vertices(0, 0.0), take.shapes[29]);
    CHECK(off < ControlMorphs::max_error * take.diagonal());
    CHECK(test::farthest(take.shapes[29], take.rest()) > 0.05 * take.diagonal());
  }
}

} // namespace puppet_export_test
