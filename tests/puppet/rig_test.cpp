// The laws of rigs: hands that play a puppet, and the shapes that it makes.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/surface_graph.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/puppet/rig_check.hpp>

#include "support/rounds.hpp"
#include "support/test_meshes.hpp"

namespace rig_test {

using namespace nendo;
using namespace nendo::puppet;
using deform::Points;

namespace {

constexpr double radius = 1.0; // of the ball that is played

const std::string text = "version = 1\nmodel = \"ball\"\nmirror = \"x\"\n[points]\n"
                         "top = { at = [0.0, 1.0, 0.0], radius = 1.2 }\n"
                         "sideLeft = { at = [1.0, 0.0, 0.0], radius = 1.2 }\n"
                         "foot = { at = [0.0, -1.0, 0.0], radius = 1.0, pin = true }\n"
                         "[functions.up]\ninput = \"left.thumb_flexion\"\ntravel_deg = 50\n"
                         "least = -0.5\nmove = { top = [0.0, 0.2, 0.0] }\n"
                         "[functions.outLeft]\ninput = \"right.index_flexion\"\ntravel_deg = 50\n"
                         "curve = \"ease\"\nmove = { sideLeft = [0.2, 0.0, 0.1] }\n";

/// A ball that is its own mirror image about x = 0: of an even number of segments.
deform::Mesh ball() {
  deform::Mesh mesh = test::sphere(16, 32, radius);
  // Each vertex exactly: two that sin and cos leave some bits apart are made alike.
  const auto images = mirror_images(mesh.vertices, 1e-9);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    REQUIRE(images[static_cast<std::size_t>(v)].size() >= 1);
    const auto other = static_cast<Eigen::Index>(images[static_cast<std::size_t>(v)].front());
    if (other < v) continue;
    mesh.vertices.col(other) = mesh.vertices.col(v);
    mesh.vertices(0, other) = other == v ? 0.0 : -mesh.vertices(0, v);
  }
  return mesh;
}

std::shared_ptr<const Rig> rig_of(const std::string& file, const deform::Mesh& mesh) {
  const auto puppet = parse_puppet(file, "p.toml");
  REQUIRE_MESSAGE(puppet, (puppet ? "" : puppet.error().message));
  return std::make_shared<const Rig>(*puppet, mesh);
}

/// Both hands, with thumb and index finger bent by some radians.
struct TwoHands {
  std::array<HandState, 2> states;

  TwoHands(double thumb_rad, double index_rad) {
    for (HandState& state : states) {
      state.angles.thumb_mcp_flexion_rad = thumb_rad;
      state.angles.fingers[0].pip_flexion_rad = index_rad;
    }
  }
  RigPlayer::Hands hands() const {
    return {&states[static_cast<std::size_t>(Side::left)],
            &states[static_cast<std::size_t>(Side::right)]};
  }
};

std::size_t number_of(const Rig& rig, std::string_view name) {
  for (std::size_t at = 0; at < rig.puppet().functions.size(); ++at)
    if (rig.puppet().functions[at].name == name) return at;
  FAIL("no function ", std::string(name));
  return 0;
}

deform::SurfacePosition place_of(const Rig& rig, std::string_view name, const deform::Mesh& mesh) {
  const auto& points = rig.puppet().points;
  const auto at = std::find_if(points.begin(), points.end(),
                               [&](const auto& point) { return point.name == name; });
  REQUIRE(at != points.end());
  return positions_on(rig.puppet(), mesh)[static_cast<std::size_t>(at - points.begin())];
}

double asymmetry(const Points& shape, const Points& rest) {
  const auto images = mirror_images(rest, 1e-9);
  double most = 0.0;
  for (Eigen::Index v = 0; v < shape.cols(); ++v) {
    Eigen::Vector3d image = shape.col(images[static_cast<std::size_t>(v)].front());
    image.x() = -image.x();
    most = std::max(most, (image - shape.col(v)).norm());
  }
  return most;
}

} // namespace

TEST_SUITE("rig") {
  TEST_CASE("hands that mirror each other have the same signals, all of them") {
    std::array<HandState, 2> states;
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      for (HandState& state : states)
        state.angles[hand::angle_at(at)] = 0.05 + 0.01 * static_cast<double>(at);
    const Eigen::Isometry3d wrist = Eigen::Translation3d(0.3, 0.1, -0.2) *
                                    Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized());
    Eigen::Isometry3d mirrored = wrist; // about x = 0
    mirrored.translation().x() = -mirrored.translation().x();
    mirrored.matrix().block<1, 2>(0, 1) *= -1.0;
    mirrored.matrix().block<2, 1>(1, 0) *= -1.0;
    states[0].T_world_wrist = wrist;
    states[1].T_world_wrist = mirrored;
    for (const Side side : {Side::left, Side::right}) {
      HandState& state = states[static_cast<std::size_t>(side)];
      state.pose = hand::HandSkeleton(side).pose(state.angles, state.T_world_wrist);
    }
    int sideways = 0;
    for (std::uint8_t number = 0; const auto left = HandSignal::numbered(Side::left, number);
         ++number) {
      const auto right = left->mirrored();
      CAPTURE(right.name());
      CHECK(left->of(states[0]) == doctest::Approx(right.of(states[1])));
      sideways += right.name().ends_with("_tip_x") && std::abs(right.of(states[1])) > 1e-3 ? 1 : 0;
    }
    CHECK(sideways >= 4);
    for (const Side side : {Side::left, Side::right}) { // it grows to the side of the little finger
      const HandState& state = states[static_cast<std::size_t>(side)];
      const std::string hand(name_of(side));
      CHECK(HandSignal::named(hand + ".thumb_tip_x")->of(state) <
            HandSignal::named(hand + ".little_tip_x")->of(state));
    }
  }

  TEST_CASE("hands that stay as they grabbed leave the model as it is") {
    const deform::Mesh mesh = ball();
    const auto rig = rig_of(text, mesh);
    RigPlayer player(rig);
    const TwoHands relaxed(0.3, 0.4);
    player.regrab(relaxed.hands());
    player.follow(relaxed.hands());
    Points places;
    player.write(places);
    CHECK(places == rig->starts());
    auto shapes = RigShapes::make(rig, mesh);
    REQUIRE(shapes);
    CHECK((*shapes)->at(player.values()) == mesh.vertices);
  }

  TEST_CASE("values are linear in the signals, and stay within the limits") {
    const deform::Mesh mesh = ball();
    const auto rig = rig_of(text, mesh);
    RigPlayer player(rig);
    player.regrab(TwoHands(0.0, 0.0).hands());
    const std::size_t up = number_of(*rig, "up"), out = number_of(*rig, "outLeft");
    const double travel = 50.0 * 3.14159265358979 / 180.0;
    player.follow(TwoHands(0.5 * travel, 0.4 * travel).hands());
    CHECK(player.values()[up] == doctest::Approx(0.5));
    CHECK(player.values()[out] == doctest::Approx(0.4));
    for (const double turns : {-3.0, -1.0, 1.0, 3.0}) {
      player.follow(TwoHands(turns * travel, turns * travel).hands());
      CHECK(player.values()[up] == doctest::Approx(turns < 0.0 ? -0.5 : 1.0));
      CHECK(player.values()[out] >= 0.0);
      CHECK(player.values()[out] <= 1.0);
    }
  }

  TEST_CASE("a release and a grab elsewhere keep the values") {
    const deform::Mesh mesh = ball();
    RigPlayer player(rig_of(text, mesh));
    player.regrab(TwoHands(0.0, 0.0).hands());
    player.follow(TwoHands(0.3, 0.2).hands());
    const std::vector<double> before(player.values().begin(), player.values().end());
    const TwoHands elsewhere(1.0, -0.4);
    player.regrab(elsewhere.hands());
    player.follow(elsewhere.hands());
    for (std::size_t at = 0; at < before.size(); ++at)
      CHECK(player.values()[at] == doctest::Approx(before[at]));
  }

  TEST_CASE("a hand that is not there keeps its functions where they are") {
    const deform::Mesh mesh = ball();
    const auto rig = rig_of(text, mesh);
    RigPlayer player(rig);
    player.regrab(TwoHands(0.0, 0.0).hands());
    player.follow(TwoHands(0.2, 0.2).hands());
    const double held = player.values()[number_of(*rig, "up")];
    const TwoHands bent(0.6, 0.6);
    player.follow({nullptr, bent.hands()[static_cast<std::size_t>(Side::right)]});
    CHECK(player.values()[number_of(*rig, "up")] == held);
    CHECK(player.values()[number_of(*rig, "outLeft")] > 0.2);
  }

  TEST_CASE("points arrive where the functions send them, pins stay") {
    const deform::Mesh mesh = ball();
    const auto rig = rig_of(text, mesh);
    auto shapes = RigShapes::make(rig, mesh);
    REQUIRE(shapes);
    const auto places = positions_on(rig->puppet(), mesh);
    for (std::size_t function = 0; function < rig->puppet().functions.size(); ++function) {
      const Points shape = (*shapes)->at(function, 0.7);
      for (std::size_t at = 0; at < places.size(); ++at) {
        const auto column = static_cast<Eigen::Index>(at);
        const Eigen::Vector3d wanted =
            rig->starts().col(column) + 0.7 * rig->vectors_of(function).col(column);
        CHECK((places[at].in(shape)-wanted).norm() < 1e-5 * radius);
      }
    }
  }

  TEST_CASE("twins at the same value make a symmetric shape") {
    const deform::Mesh mesh = ball();
    for (const char* const distance : {"surface", "air"}) {
      std::string file = text;
      file.insert(file.find("[points]"), "distance = \"" + std::string(distance) + "\"\n");
      const auto rig = rig_of(file, mesh);
      auto shapes = RigShapes::make(rig, mesh);
      REQUIRE(shapes);
      std::vector<double> values(3, 0.0);
      values[number_of(*rig, "outLeft")] = 0.8;
      values[number_of(*rig, "outRight")] = 0.8;
      values[number_of(*rig, "up")] = 0.5;
      const Points shape = (*shapes)->at(values);
      CHECK((shape - mesh.vertices).colwise().norm().maxCoeff() > 0.1);
      CHECK(asymmetry(shape, mesh.vertices) < 1e-6 * deform::diagonal_of(mesh.vertices));
    }
  }

  TEST_CASE(
      "in 10,000 poses at random pins stay, masked vertices do not move by a bit, twins at the "
      "same value stay symmetric, and at rest the model is as it is") {
    const deform::Mesh mesh = ball();
    const Eigen::Vector3d middle(0.0, 0.6, 0.8); // of the mask, half of whose radius is 0
    for (const char* const distance : {"surface", "air"}) {
      CAPTURE(std::string(distance));
      std::string file = text + "[[masks]]\nat = [0.0, 0.6, 0.8]\nradius = 0.6\n";
      file.insert(file.find("[points]"), "distance = \"" + std::string(distance) + "\"\n");
      const auto rig = rig_of(file, mesh);
      auto shapes = RigShapes::make(rig, mesh);
      REQUIRE(shapes);
      const double diagonal = deform::diagonal_of(mesh.vertices);
      const auto foot = place_of(*rig, "foot", mesh);
      const std::size_t left = number_of(*rig, "outLeft"), right = number_of(*rig, "outRight");
      const Points rest = (*shapes)->at(std::vector<double>(3, 0.0));
      CHECK((rest - mesh.vertices).cwiseAbs().maxCoeff() < 1e-6 * diagonal);
      std::mt19937 random(41);
      std::uniform_real_distribution<double> any(-0.5, 1.0);
      double pinned = 0.0, apart = 0.0, farthest = 0.0;
      int masked = 0;
      for (int pose = 0; pose < test::rounds(5'000); ++pose) {
        std::vector<double> values{any(random), any(random), any(random)};
        const bool is_symmetric = pose % 10 == 0;
        if (is_symmetric) values[right] = values[left];
        const Points shape = (*shapes)->at(values);
        pinned = std::max(pinned, (foot.in(shape)-foot.in(rest)).norm());
        farthest = std::max(farthest, (shape - rest).colwise().norm().maxCoeff());
        if (is_symmetric) apart = std::max(apart, asymmetry(shape, mesh.vertices));
        for (Eigen::Index v = 0; v < shape.cols(); ++v)
          if ((mesh.vertices.col(v) - middle).norm() < 0.29)
            masked += shape.col(v) == rest.col(v) ? 1 : -1'000'000;
      }
      CHECK(pinned < 1e-6 * diagonal);
      CHECK(apart < 1e-6 * diagonal);
      CHECK(masked > test::rounds(5'000));
      CHECK(farthest > 0.1);
    }
  }

  TEST_CASE("a puppet of another model, or of one without faces, does not fit") {
    deform::Mesh mesh = ball();
    const auto last = static_cast<std::uint32_t>(mesh.vertices.cols() - 1);
    auto puppet = parse_puppet(text, "test");
    REQUIRE(puppet);
    puppet->points[1].vertex = last;
    CHECK(check_fits(*puppet, mesh));
    puppet->points[1].vertex = last + 1;
    const auto other = check_fits(*puppet, mesh);
    REQUIRE_FALSE(other);
    CHECK(other.error().code == Errc::bad_input);
    CHECK(other.error().message.find("no vertex " + std::to_string(last + 1)) != std::string::npos);
    CHECK(other.error().message.find("'" + puppet->points[1].name + "'") != std::string::npos);
    puppet->points[1].vertex = last;
    mesh.face_corners.clear();
    mesh.face_starts = {0};
    CHECK_FALSE(check_fits(*puppet, mesh));
  }

  TEST_CASE("a mix of radii is the mean of their functions along the surface, exactly linear") {
    const deform::Mesh mesh = ball();
    const std::string file = "version = 1\nmodel = \"ball\"\n[points]\n"
                             "top = { at = [0.0, 1.0, 0.0], radius = [0.4, 1.6], weights = [3, 1] "
                             "}\n[functions.up]\ninput = \"left.thumb_flexion\"\n"
                             "travel_deg = 50\nmove = { top = [0.0, 0.2, 0.1] }\n";
    auto shapes = RigShapes::make(rig_of(file, mesh), mesh);
    REQUIRE(shapes);
    const auto place = deform::nearest_position(mesh, {0.0, 1.0, 0.0});
    const Eigen::VectorXd distances = deform::SurfaceGraph(mesh).distances(place, 2.0);
    const auto psi = [](double t) { // Wendland's, from the paper
      return t >= 1.0 ? 0.0 : std::pow(1.0 - t, 4) * (4.0 * t + 1.0);
    };
    const Points half = (*shapes)->at(0, 0.5), full = (*shapes)->at(0, 1.0);
    double top = 0.0; // of the function, at the point's own place in its face
    const auto mixed = [&](double d) { return 0.75 * psi(d / 0.4) + 0.25 * psi(d / 1.6); };
    for (std::size_t k = 0; k < 3; ++k)
      top += place.weights[k] * mixed(distances[place.corners[k]]);
    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      const Eigen::Vector3d wanted = mixed(distances[v]) / top * Eigen::Vector3d(0.0, 0.2, 0.1);
      CHECK((full.col(v) - mesh.vertices.col(v) - wanted).norm() < 1e-6);
      CHECK((full.col(v) + mesh.vertices.col(v) - 2.0 * half.col(v)).norm() < 1e-6);
    }
  }

  TEST_CASE("a mix of radii also interpolates through the air, narrower than its widest radius") {
    const deform::Mesh mesh = ball();
    const auto moved = [&](const char* radius) {
      std::string file = "version = 1\nmodel = \"ball\"\ndistance = \"air\"\n[points]\n"
                         "top = { vertex = 0, radius = RADIUS }\n"
                         "side = { at = [1.0, 0.0, 0.0], radius = 0.7 }\n"
                         "[functions.up]\ninput = \"left.thumb_flexion\"\n"
                         "travel_deg = 50\nmove = { top = [0.0, 0.2, 0.0] }\n";
      file.replace(file.find("RADIUS"), 6, radius);
      auto shapes = RigShapes::make(rig_of(file, mesh), mesh);
      REQUIRE(shapes);
      const Points all = (*shapes)->at(0, 1.0) - mesh.vertices;
      CHECK((all.col(0) - Eigen::Vector3d(0.0, 0.2, 0.0)).norm() < 1e-6);
      return all.norm();
    };
    const double narrow = moved("0.4"), wide = moved("1.6"), mixed = moved("[0.4, 1.6]");
    CHECK(narrow < mixed);
    CHECK(mixed < wide);
  }

  TEST_CASE("points that are too near to each other are named") {
    std::string file = text;
    file.insert(file.find("foot ="), "crown = { at = [0.0, 1.0, 0.0], radius = 1.2 }\n");
    const deform::Mesh mesh = ball();
    const auto shapes = RigShapes::make(rig_of(file, mesh), mesh);
    REQUIRE_FALSE(shapes);
    CHECK(shapes.error().code == Errc::bad_input);
    CHECK(shapes.error().message.find("crown") != std::string::npos);
    CHECK(shapes.error().message.find("top") != std::string::npos);
  }

  TEST_CASE("the check counts what turns over, of one function and of two") {
    const deform::Mesh mesh = ball();
    auto mild = RigShapes::make(rig_of(text, mesh), mesh);
    REQUIRE(mild);
    const RigCheck fine = check_rig(**mild, mesh);
    CHECK(fine.passes());
    CHECK(fine.alone.size() == 4); // up has two limits, and each side one
    CHECK(fine.pairs.size() == 5); // up with either side, twice, and the sides
    CHECK(fine.twins.size() == 1);
    CHECK(fine.twins.front().apart < RigCheck::symmetric_within);
    CHECK(fine.lone_vertices == 0);
    for (const LimitCheck& limit : fine.alone) {
      CHECK(limit.moved > 0);
      CHECK(limit.turned == 0);
    }
    std::string wild = text; // the top goes through the ball, and comes out below it
    wild.replace(wild.find("[0.0, 0.2, 0.0]"), 15, "[0.0, -3.0, 0.0]");
    auto shapes = RigShapes::make(rig_of(wild, mesh), mesh);
    REQUIRE(shapes);
    CHECK_FALSE(check_rig(**shapes, mesh).passes());
  }
}

} // namespace rig_test
