#include "export/gltf_export.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "render/hand_skin.hpp"
#include "support/counted_frames.hpp"
#include "support/glb_reader.hpp"
#include "support/recorded_motion.hpp"

namespace gltf_export_test {

using namespace nendo;
using namespace nendo::exporting;
using namespace nendo::takes;
using nendo::test::Glb;
using nendo::test::Motion;
using nendo::test::RecordedMotion;

namespace {

Result<Exported> export_it(const RecordedMotion& motion, const Choice& choice = {},
                           const GltfOptions& options = {}) {
  return export_gltf(*motion.frames(), choice, options, motion.path("take.glb"));
}

Glb read(const RecordedMotion& motion) {
  return Glb(test::file_bytes(motion.path("take.glb")));
}

/// Of all frames, as an independent reader has them; parts of the diagonal.
double farthest_off(const RecordedMotion& motion, const Glb& glb) {
  double worst = 0.0;
  for (std::size_t at = 0; at < motion.shapes.size(); ++at)
    worst = std::max(worst, test::farthest(glb.vertices(0, motion.times_s[at] - motion.times_s[0]),
                                           motion.shapes[at]));
  return worst / motion.diagonal();
}

/// The reader adds in doubles what the exporter measured in floats: half a float's last place, in
/// parts of the ball's diagonal.
constexpr double readers_rounding = 3e-8;

double way(const RecordedMotion& motion) {
  double most = 0.0;
  for (const auto& shape : motion.shapes)
    most = std::max(most, test::farthest(shape, motion.played.test.model.vertices));
  return most / motion.diagonal();
}

/// The largest angle between two unit vectors of the same number.
double farthest_turn_deg(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  double farthest = 0.0;
  for (Eigen::Index at = 0; at < a.cols(); ++at)
    farthest =
        std::max(farthest, std::atan2(a.col(at).cross(b.col(at)).norm(), a.col(at).dot(b.col(at))));
  return farthest * 180.0 / 3.14159265358979;
}

} // namespace

TEST_SUITE("gltf_export") {
  TEST_CASE("where the model becomes finer another mesh is shown, and each is right in its time") {
    const RecordedMotion motion(Motion{.subdivide_at_tick = 24});
    const auto done = export_it(motion, {}, {.tolerance = 1e-4});
    REQUIRE(done);
    REQUIRE(done->morphs);
    CHECK(done->morphs->models == 2);
    CHECK(done->morphs->basis == MorphBasis::key_shapes);
    const Glb glb = read(motion);
    REQUIRE(glb.json["meshes"].size() == 4);           // with two hands
    CHECK(glb.json["scenes"][0]["nodes"].size() == 6); // two of each hand
    std::array<std::size_t, 2> frames{};
    for (std::size_t at = 0; at < motion.shapes.size(); ++at) {
      const double time_s = motion.times_s[at] - motion.times_s[0];
      const bool is_finer = motion.shapes[at].cols() > motion.shapes[0].cols();
      const Eigen::Vector3d hidden = Eigen::Vector3d::Zero();
      const auto scale = [&](std::size_t node) -> Eigen::Vector3d {
        return glb.animated(node, "scale", time_s + 1e-6, hidden);
      };
      CHECK(scale(is_finer ? 0 : 1) == hidden);
      CHECK(scale(is_finer ? 1 : 0).minCoeff() > 0.0);
      const auto shown = glb.vertices(is_finer ? 1 : 0, time_s);
      REQUIRE(shown.cols() == motion.shapes[at].cols());
      CHECK(test::farthest(shown, motion.shapes[at]) < 1.01e-4 * motion.diagonal());
      ++frames[is_finer ? 1 : 0];
    }
    CHECK(frames == std::array<std::size_t, 2>{25, 35});
  }

  TEST_CASE("a take of Type-1 is its control vectors, exact at every frame, and sparse") {
    const RecordedMotion motion(Motion{});
    const auto done = export_it(motion);
    REQUIRE(done);
    REQUIRE(done->morphs);
    CHECK(done->morphs->basis == MorphBasis::control_vectors);
    CHECK(done->morphs->targets >= 20);
    CHECK(done->morphs->targets <= 60);
    CHECK(done->frames == motion.shapes.size());
    CHECK(way(motion) > 0.005);
    const Glb glb = read(motion);
    const double off = farthest_off(motion, glb);
    CHECK(off < 1e-6);
    CHECK(off <= done->morphs->greatest_error + readers_rounding);
    for (const double time_s : {0.0, 0.1, 0.2, 0.3}) {
      const auto weights = glb.animated(0, "weights", time_s, {});
      CHECK(weights.minCoeff() >= 0.0); // some programs take no others
      CHECK(weights.maxCoeff() <= 1.0);
    }
    CHECK(done->morphs->greatest_error < 1e-6);
    std::size_t sparse = 0;
    for (const auto& accessor : glb.json["accessors"])
      sparse += accessor.contains("sparse") ? 1U : 0U;
    CHECK(sparse > 0);
    CHECK(done->bytes == std::filesystem::file_size(motion.path("take.glb")));
  }

  TEST_CASE(
      "with masks a take of Type-1 is its control vectors as exactly, and so it is mirrored") {
    const char* const held = "version = 1\n[[masks]]\nat = [0.8, 0.6, 0]\nradius = 1.2\n";
    const std::string mirrored = std::string("version = 1\nmirror = \"x\"\n") + (held + 12);
    const RecordedMotion free(Motion{});
    for (const char* const masks : {held, mirrored.c_str()}) {
      const RecordedMotion motion(Motion{.puppet = masks});
      const auto done = export_it(motion);
      REQUIRE(done);
      REQUIRE(done->morphs);
      CHECK(done->morphs->basis == MorphBasis::control_vectors);
      const double off = farthest_off(motion, read(motion));
      CHECK(off < 1e-6);
      CHECK(off <= done->morphs->greatest_error + readers_rounding);
      CHECK(way(motion) > 0.005);
      const auto puppet = puppet::parse_puppet(masks, "masks");
      REQUIRE(puppet);
      const deform::Points& model = motion.played.test.model.vertices;
      const Eigen::VectorXd weights = puppet::mask_weights(*puppet, model);
      int stopped = 0; // vertices that move without a mask
      for (Eigen::Index v = 0; v < model.cols(); ++v)
        if (weights[v] == 0.0) {
          CHECK(motion.shapes[30].col(v) == model.col(v));
          stopped += free.shapes[30].col(v) != model.col(v) ? 1 : 0;
        }
      CHECK(stopped > 10);
    }
  }

  TEST_CASE("commits and Type-2 become key shapes, as near as is asked for and as is said") {
    for (const Motion& motion : {Motion{.commit_at_tick = 20}, Motion{.mode = flow::Mode::type2},
                                 Motion{.mode = flow::Mode::type2, .injective = true}}) {
      const RecordedMotion recorded(motion);
      CHECK(way(recorded) > 0.005);
      for (const double tolerance : {1e-3, 1e-4}) {
        const auto done = export_it(recorded, {}, {.tolerance = tolerance});
        REQUIRE(done);
        CHECK(done->morphs->basis == MorphBasis::key_shapes);
        const double off = farthest_off(recorded, read(recorded));
        CHECK(off <= done->morphs->greatest_error + readers_rounding);
        CHECK(done->morphs->greatest_error <= tolerance + 1e-6);
        if (tolerance > 5e-4) CHECK(done->morphs->keys < recorded.shapes.size() / 2);
      }
    }
  }

  TEST_CASE("a take that is no sum of control vectors from the middle on is played once") {
    const RecordedMotion motion(Motion{.commit_at_tick = 20});
    // What was shaped before the commit is then known only from the control vectors.
    CHECK(test::farthest(motion.shapes[19], motion.shapes[0]) > 0.003 * motion.diagonal());
    for (const double tolerance : {1e-3, 1e-4}) {
      test::CountedFrames frames(motion.frames());
      const auto done = export_gltf(frames, {}, {.tolerance = tolerance}, motion.path("take.glb"));
      REQUIRE(done);
      CHECK(frames.made == motion.shapes.size());
      CHECK(done->frames == motion.shapes.size());
      CHECK(done->morphs->basis == MorphBasis::key_shapes);
      CHECK(farthest_off(motion, read(motion)) <= done->morphs->greatest_error + readers_rounding);
      CHECK(done->morphs->greatest_error <= tolerance + 1e-6);
    }
    test::CountedFrames part(motion.frames());
    const auto done = export_gltf(part, {.from_s = 0.095, .to_s = 0.405, .rate_hz = 50.0},
                                  {.tolerance = 1e-3}, motion.path("take.glb"));
    REQUIRE(done);
    CHECK(done->frames == 16);
    CHECK(done->morphs->basis == MorphBasis::key_shapes);
    CHECK(part.made < motion.shapes.size()); // what comes after --to is not made
    const Glb glb = read(motion);
    for (std::size_t at = 0; at < 16; ++at)
      CHECK(test::farthest(glb.vertices(0, static_cast<double>(at) / 50.0),
                           motion.shapes[9 + 2 * at]) < 1.01e-3 * motion.diagonal());
  }

  TEST_CASE("ways in several links are no control vectors, and are distinguished by their shapes") {
    const RecordedMotion motion(Motion{.injective = true, .bend_counts = 60.0});
    const auto done = export_it(motion);
    REQUIRE(done);
    const double off = farthest_off(motion, read(motion));
    CHECK(off <= done->morphs->greatest_error + readers_rounding);
    CHECK(off <= GltfOptions{}.tolerance + 1e-6);
  }

  TEST_CASE("a tolerance may be a length on the stage, and is kept to as such") {
    const RecordedMotion motion(Motion{.mode = flow::Mode::type2});
    const double diagonal_m = motion.diagonal() / motion.played.test.placement.units_per_metre;
    for (const double length_m : {1e-3, 1e-4}) {
      const auto done = export_it(motion, {}, {.tolerance_m = length_m});
      REQUIRE(done);
      CHECK(done->morphs->diagonal_m == doctest::Approx(diagonal_m));
      CHECK(done->morphs->tolerance == doctest::Approx(length_m / diagonal_m));
      CHECK(diagonal_m * farthest_off(motion, read(motion)) <= length_m + 1e-6 * diagonal_m);
      const auto same = export_it(motion, {}, {.tolerance = length_m / diagonal_m});
      REQUIRE(same);
      CHECK(same->morphs->keys == done->morphs->keys);
    }
  }

  TEST_CASE("a viewer that mixes the targets' normals lights the shape as its own normals do") {
    for (const auto& [mode, max_degrees] :
         {std::pair(flow::Mode::type1, 6.0), std::pair(flow::Mode::type2, 4.0)}) {
      const RecordedMotion motion(Motion{.mode = mode, .bend_counts = 60.0});
      REQUIRE(export_it(motion));
      const Glb glb = read(motion);
      const auto node = glb.node_named("model");
      deform::Mesh shape = motion.played.test.model;
      double worst = 0.0, worst_at_rest = 0.0;
      for (std::size_t at = 0; at < motion.shapes.size(); at += 5) {
        const double time_s = motion.times_s[at] - motion.times_s[0];
        const Eigen::Matrix3Xd mixed = glb.vertices(node, time_s, "NORMAL").colwise().normalized();
        shape.vertices = motion.shapes[at];
        const deform::Points wanted = deform::vertex_normals(shape);
        worst = std::max(worst, farthest_turn_deg(mixed, wanted));
        worst_at_rest =
            std::max(worst_at_rest, farthest_turn_deg(glb.vertices(node, 0.0, "NORMAL"), wanted));
      }
      MESSAGE(name_of(mode) << ": off by " << worst << " degrees, at rest by " << worst_at_rest);
      CHECK(worst < max_degrees);
      CHECK(worst_at_rest > 3.5 * worst); // otherwise the motion would prove nothing
    }
  }

  TEST_CASE("each hand hangs under a node of its own, and the model under none of them") {
    const RecordedMotion motion(Motion{.ticks = 5});
    REQUIRE(export_it(motion));
    const Glb glb = read(motion);
    const auto& nodes = glb.json["nodes"];
    std::vector<std::size_t> parent(nodes.size(), nodes.size());
    for (std::size_t at = 0; at < nodes.size(); ++at)
      for (const std::size_t child : nodes[at].value("children", std::vector<std::size_t>()))
        parent[child] = at;
    CHECK(parent[glb.node_named("model")] == nodes.size());
    for (const auto& skin : glb.json["skins"]) {
      // What importers make an armature of: the nearest common ancestor that is no joint.
      const std::string name = skin["name"];
      for (const std::size_t joint : skin["joints"]) {
        const std::size_t above = parent[joint];
        REQUIRE(above < nodes.size());
        const auto joints = skin["joints"].get<std::vector<std::size_t>>();
        const bool is_joint = std::find(joints.begin(), joints.end(), above) != joints.end();
        if (!is_joint) CHECK(nodes[above]["name"] == name);
        CHECK((is_joint || parent[above] == nodes.size()));
      }
      CHECK(parent[glb.node_named(name + " skin")] == nodes.size()); // as glTF wants of skins
    }
  }

  TEST_CASE("joints are where the hands' were, and the skin follows as the viewer's does") {
    const RecordedMotion motion(Motion{});
    REQUIRE(export_it(motion));
    const Glb glb = read(motion);
    for (const std::size_t at : {std::size_t{0}, std::size_t{17}, motion.shapes.size() - 1}) {
      const double time_s = motion.times_s[at] - motion.times_s[0];
      for (const Side side : {Side::left, Side::right}) {
        const auto& pose = motion.hands[at][flow::Placement::index_of(side)];
        std::vector<Eigen::Affine3d> worlds;
        for (std::size_t joint = 0; joint < hand::joint_count; ++joint) {
          const auto name = std::string(name_of(static_cast<hand::Joint>(joint))) +
                            (side == Side::left ? "_L" : "_R");
          worlds.push_back(glb.world(glb.node_named(name), time_s));
          CHECK((worlds.back().matrix() - pose.joints[joint].matrix()).norm() < 1e-5);
        }
        const auto node = glb.node_named(std::string(name_of(side)) + " hand skin");
        const auto& skin = glb.json["skins"][glb.json["nodes"][node]["skin"].get<std::size_t>()];
        const Eigen::MatrixXd inverses = glb.accessor(skin["inverseBindMatrices"]);
        const auto& attributes =
            glb.json["meshes"][glb.json["nodes"][node]["mesh"].get<std::size_t>()]["primitives"][0]
                    ["attributes"];
        const Eigen::MatrixXd places = glb.accessor(attributes["POSITION"]);
        const Eigen::MatrixXd joints = glb.accessor(attributes["JOINTS_0"]);
        const Eigen::MatrixXd weights = glb.accessor(attributes["WEIGHTS_0"]);
        render::Surface surface;
        render::HandSkin(side).drape(pose, Eigen::Vector3d::Zero(), surface,
                                     render::HandSkin::Mix::linear);
        REQUIRE(static_cast<std::size_t>(places.cols()) == surface.places.size());
        double worst = 0.0;
        for (Eigen::Index v = 0; v < places.cols(); ++v) {
          Eigen::Vector3d skinned = Eigen::Vector3d::Zero();
          for (int rank = 0; rank < 4; ++rank) {
            const auto joint = static_cast<Eigen::Index>(joints(rank, v));
            const Eigen::Matrix4d inverse = inverses.col(joint).reshaped(4, 4);
            skinned +=
                weights(rank, v) * (worlds[static_cast<std::size_t>(joint)].matrix() * inverse *
                                    Eigen::Vector4d(places(0, v), places(1, v), places(2, v), 1.0))
                                       .head<3>();
          }
          const Eigen::Vector3d draped = surface.places[static_cast<std::size_t>(v)].cast<double>();
          worst = std::max(worst, (skinned - draped).norm());
        }
        CHECK(worst < 1e-5);
      }
    }
  }

  TEST_CASE("the model is in metres by its node's scale, and the hands may be left out") {
    const RecordedMotion motion(Motion{.ticks = 20});
    REQUIRE(export_it(motion, {}, {.hands = false}));
    const Glb glb = read(motion);
    CHECK(glb.json["scenes"][0]["nodes"].size() == 1);
    CHECK_FALSE(glb.json.contains("skins"));
    CHECK(glb.world(0, 0.0).matrix()(0, 0) ==
          doctest::Approx(1.0 / motion.played.test.placement.units_per_metre));
    CHECK(glb.json["asset"]["version"] == "2.0");
    const auto& primitive = glb.json["meshes"][0]["primitives"][0];
    const Eigen::MatrixXd normals = glb.accessor(primitive["attributes"]["NORMAL"]);
    CHECK((normals.colwise().norm().array() - 1.0).abs().maxCoeff() < 1e-5);
    std::size_t triangles = 0;
    const auto& mesh = motion.played.test.model;
    for (std::size_t face = 0; face < mesh.face_count(); ++face)
      triangles += mesh.face_starts[face + 1] - mesh.face_starts[face] - 2;
    CHECK(glb.json["accessors"][primitive["indices"].get<std::size_t>()]["count"] == 3 * triangles);
  }

  TEST_CASE("a part of a take, at a rate, begins at time 0 and has the nearest frames' shapes") {
    const RecordedMotion motion(Motion{});
    const auto done = export_it(motion, {.from_s = 0.195, .to_s = 0.405, .rate_hz = 50.0});
    REQUIRE(done);
    CHECK(done->frames == 11);
    CHECK(done->first_s == doctest::Approx(0.2));
    const Glb glb = read(motion);
    for (std::size_t at = 0; at < 11; ++at)
      CHECK(test::farthest(glb.vertices(0, static_cast<double>(at) / 50.0),
                           motion.shapes[19 + 2 * at]) < 1e-6 * motion.diagonal());
  }

  TEST_CASE(
      "more weights of key shapes than readers can unpack are refused, and nothing is written") {
    const RecordedMotion motion(Motion{.mode = flow::Mode::type2});
    const auto done = export_it(motion);
    REQUIRE(done);
    const std::uint64_t weights = done->morphs->keys * done->morphs->targets;
    REQUIRE(weights > 4);
    test::write_bytes(motion.path("take.glb"), "old");
    for (const std::uint64_t most : {weights - 1, std::uint64_t{1}}) {
      const auto refused = export_it(motion, {}, {.max_weights = most});
      REQUIRE_FALSE(refused);
      CHECK(refused.error().code == Errc::failed);
      CHECK(refused.error().message.find("--tolerance") != std::string::npos);
      CHECK(test::file_bytes(motion.path("take.glb")) == "old");
    }
    CHECK(export_it(motion, {}, {.max_weights = weights}));
  }

  TEST_CASE("a stop leaves the file that was there") {
    const RecordedMotion motion(Motion{.ticks = 5});
    test::write_bytes(motion.path("take.glb"), "old");
    const std::atomic<bool> stop{true};
    const auto done = export_it(motion, {.stop = &stop});
    REQUIRE_FALSE(done);
    CHECK(done.error().code == Errc::failed);
    CHECK(test::file_bytes(motion.path("take.glb")) == "old");
  }
}

} // namespace gltf_export_test
