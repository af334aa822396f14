// The laws of written puppet files, and of edits.

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <string>

#include <nendo/base/units.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/puppet/puppet_edit.hpp>

#include "support/test_meshes.hpp"

namespace puppet_edit_test {

using namespace nendo;
using namespace nendo::puppet;
using Eigen::Vector3d;

namespace {

/// As a file has it: lists in the order of their names.
class RandomPuppet {
public:
  explicit RandomPuppet(unsigned seed) : random_(seed) {}

  Puppet make() {
    Puppet puppet;
    puppet.model = "a \"model\"\\\n.obj";
    puppet.distance = one_in(2) ? Distance::euclidean : Distance::surface;
    for (int at = 0; at < 6; ++at)
      puppet.points.push_back(point(std::string(1, static_cast<char>('a' + at)), at < 4));
    for (int at = 0; at < 4; ++at)
      puppet.functions.push_back(function("f" + std::to_string(at)));
    for (std::size_t at = 0; at < 3; ++at)
      puppet.masks.push_back({vector(), size()});
    puppet.parts.push_back({deform::Box{vector(), vector()}, 3, 77, {0, 1, 2, 5}, true});
    puppet.parts.push_back({{}, 0, 0xFFFFFFFF, {4}, false});
    puppet.parts.push_back({});
    return puppet;
  }

private:
  bool one_in(unsigned n) { return random_() % n == 0; }
  double number() {
    const double wide = std::uniform_real_distribution(-3.0, 3.0)(random_);
    return one_in(3) ? std::round(wide)
                     : wide * std::pow(10.0, static_cast<int>(random_() % 6) - 4);
  }
  double size() { return std::abs(number()) + 1e-3; }
  Vector3d vector() { return {number(), number(), number()}; }
  PuppetPoint point(const std::string& name, bool may_move) {
    PuppetPoint made;
    made.name = name;
    if (one_in(2))
      made.vertex = static_cast<std::uint32_t>(random_());
    else
      made.at = vector();
    made.radius = size();
    if (one_in(3)) {
      made.mix = {{made.radius, size()}, {0.5 * made.radius, one_in(2) ? 1.0 : size()}};
      if (one_in(2)) std::swap(made.mix[0], made.mix[1]);
    }
    made.is_pin = !may_move;
    return made;
  }
  Function function(const std::string& name) {
    Function made;
    made.name = name;
    made.input = *HandSignal::named(one_in(2)   ? "left.thumb_tip_y"
                                    : one_in(2) ? "right.index_flexion"
                                                : "left.wrist_yaw");
    made.travel = made.input.is_angle() ? from_degrees(number() + 5.0) : number() + 5.0;
    made.least = one_in(2) ? 0.0 : -size();
    made.most = one_in(2) ? 1.0 : size();
    made.eases = one_in(2);
    if (one_in(2)) {
      made.turn = AxisTurn{100.0 * size() / 300.0, vector() + Vector3d(9, 0, 0), vector()};
      made.turn->degrees = std::min(made.turn->degrees, 360.0);
      for (std::size_t at = 0; at < 3; ++at)
        made.moves.push_back({at, Vector3d::Zero(), number()});
    }
    if (!made.turn || one_in(2))
      for (std::size_t at = 1; at < 4; ++at)
        made.moves.push_back({at, vector(), {}});
    return made;
  }

  std::mt19937 random_;
};

const std::string models = NENDO_MODELS "/";

struct Shipped {
  explicit Shipped(const std::string& name)
      : puppet(*read_puppet(models + name + ".puppet.toml")),
        mesh(*deform::read_mesh(models + puppet.model)), rig(puppet, mesh) {}
  Puppet puppet;
  deform::Mesh mesh;
  Rig rig;
};

/// A ball of radius 1.
struct Ball {
  deform::Mesh mesh = test::sphere(24, 48, 1.0);
  Rig rig{empty_puppet("ball.obj"), mesh};

  void take(Result<Puppet> edited) {
    REQUIRE_MESSAGE(edited, (edited ? "" : edited.error().message));
    rig = Rig(*std::move(edited), mesh);
  }
  std::string refusal(const Result<Puppet>& edited) const {
    REQUIRE_FALSE(edited);
    CHECK(edited.error().message.find('\n') == std::string::npos);
    return edited.error().message;
  }
  const Puppet& puppet() const { return rig.puppet(); }
  std::size_t point(std::string_view name) const { return find(puppet().points, name); }
  std::size_t function(std::string_view name) const { return find(puppet().functions, name); }
  template <class List>
  static std::size_t find(const List& list, std::string_view name) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
    REQUIRE_MESSAGE(found != list.end(), name);
    return static_cast<std::size_t>(found - list.begin());
  }
};

const HandSignal index_bends = *HandSignal::named("right.index_flexion");
const double travel = from_degrees(70.0);

Ball with_two_points(bool mirrors = false) {
  Ball ball;
  ball.take(with_function(ball.rig, {{0, 1, 0}, 0.5}, {0, 0.2, 0}, index_bends, travel));
  if (mirrors) ball.take(with_mirror(ball.rig, true));
  ball.take(with_function(ball.rig, {{1, 0, 0}, 0.5}, {0.2, 0.1, 0}, index_bends, travel));
  return ball;
}

} // namespace

TEST_SUITE("puppet text") {
  TEST_CASE("what is written is read as the same puppet: the shipped ones") {
    for (const char* name : {"face", "moai", "spot"}) {
      const auto puppet = read_puppet(models + name + ".puppet.toml");
      REQUIRE(puppet);
      const std::string text = text_of(*puppet);
      const auto again = parse_puppet(text, name);
      REQUIRE_MESSAGE(again, again.error().message);
      CHECK(*again == *puppet);
      CHECK(text_of(*again) == text);
      CHECK(again->mirrors);
      CHECK(text.find("Right = { at") == std::string::npos); // twins are left to `mirror`
      CHECK(text.substr(0, 2) == "# ");                      // the comments at the beginning stay
    }
  }

  TEST_CASE("what is written is read as the same puppet: random ones") {
    for (unsigned seed = 0; seed < 300; ++seed) {
      const Puppet puppet = RandomPuppet(seed).make();
      const std::string text = text_of(puppet);
      const auto again = parse_puppet(text, "random");
      INFO(text);
      REQUIRE_MESSAGE(again, again.error().message);
      CHECK(*again == puppet);
    }
  }

  TEST_CASE("a random puppet that differs in anything is another one") {
    const Puppet puppet = RandomPuppet(1).make();
    Puppet other = puppet;
    other.masks.back().radius *= 1.0 + 1e-15;
    CHECK_FALSE(other == puppet);
    other = puppet;
    other.parts.front().inside.reset();
    CHECK_FALSE(other == puppet);
    other = puppet;
    other.text = "something else";
    CHECK(other == puppet);
  }
}

TEST_SUITE("puppet edit") {
  TEST_CASE("a puppet begins with a point and a function that moves it") {
    const Ball ball = with_two_points();
    REQUIRE(ball.puppet().points.size() == 2);
    REQUIRE(ball.puppet().functions.size() == 2);
    CHECK(ball.puppet().model == "ball.obj");
    const std::size_t second = ball.function("move2");
    CHECK(ball.rig.vectors_of(second).col(static_cast<Eigen::Index>(ball.point("point2"))) ==
          Vector3d(0.2, 0.1, 0));
    CHECK(ball.rig.vectors_of(second).col(static_cast<Eigen::Index>(ball.point("point1"))) ==
          Vector3d::Zero());
    CHECK((ball.rig.starts().col(0) - Vector3d(0, 1, 0)).norm() < 0.02);
    CHECK(ball.puppet().functions[second].input == index_bends);
    CHECK(ball.puppet().text == text_of(ball.puppet()));
  }

  TEST_CASE("what the mouse gives is written with few digits, near enough") {
    for (const double scale : {1e-6, 1.0, 300.0, 1e7}) {
      Ball ball;
      ball.mesh.vertices *= scale;
      const Vector3d at = scale * Vector3d(1.0 / 3, 2.0 / 3, 2.0 / 3), move = at / 7.0;
      const double radius = scale * 0.5 / 0.97;
      ball.take(with_function(ball.rig, {at, radius}, move, index_bends, travel));
      const PuppetPoint& point = ball.puppet().points[0];
      CHECK((point.at - at).norm() < 1e-3 * radius);
      CHECK((ball.puppet().functions[0].moves[0].vector - move).norm() < 1e-3 * radius);
      CHECK(std::abs(point.radius - radius) < 1e-3 * radius);
      std::size_t digits = 0, longest = 0;
      for (const char letter : ball.puppet().text) {
        digits = letter >= '0' && letter <= '9' ? digits + 1 : 0;
        longest = std::max(longest, digits);
      }
      CHECK(longest <= 11); // of 0.0000003333, too
    }
  }

  TEST_CASE("points that are too near, or too many, and pins before all else are refused") {
    Ball ball;
    CHECK(ball.refusal(with_pin(ball.rig, {{0, 1, 0}, 0.5})).find("begins") != std::string::npos);
    ball.take(with_function(ball.rig, {{0, 1, 0}, 0.5}, {0, 0.2, 0}, index_bends, travel));
    const Puppet before = ball.puppet();
    CHECK(ball.refusal(with_pin(ball.rig, {{0.01, 1, 0}, 0.5})).find("'point1'") !=
          std::string::npos);
    CHECK_FALSE(with_pin(ball.rig, {{0, -1, 0}, 0.0}));
    CHECK_FALSE(with_pin(ball.rig, {{0, -1, 0}, std::nan("")}));
    CHECK_FALSE(with_radius(ball.rig, 0, -1.0));
    CHECK_FALSE(with_radius(ball.rig, 0, std::nan("")));
    CHECK_FALSE(with_move(ball.rig, 0, 0, {0, std::nan(""), 0}));
    CHECK_FALSE(with_name(ball.rig, 0, "not a name"));
    CHECK_FALSE(with_name(ball.rig, 0, ""));
    CHECK(ball.puppet() == before); // a refused edit leaves the puppet as it is
    CHECK(ball.puppet().text == before.text);
    Puppet full = before;
    for (std::size_t at = 1; at < Puppet::max_functions; ++at) {
      full.functions.push_back(full.functions.front());
      full.functions.back().name = "more" + std::to_string(at);
    }
    const Rig rig(full, ball.mesh);
    CHECK(ball.refusal(with_function(rig, {{0, -1, 0}, 0.5}, {0, 1, 0}, index_bends, travel))
              .find("64") != std::string::npos);
  }

  TEST_CASE("pins stay: what moves cannot be pinned, and a pin cannot be moved") {
    Ball ball = with_two_points();
    CHECK(ball.refusal(with_pinned(ball.rig, ball.point("point1"), true)).find("move1") !=
          std::string::npos);
    ball.take(with_pin(ball.rig, {{0, -1, 0}, 0.5}));
    const std::size_t pin = ball.point("pin1");
    CHECK(ball.puppet().points[pin].is_pin);
    CHECK_FALSE(with_move(ball.rig, 0, pin, {0, 1, 0}));
    ball.take(with_pinned(ball.rig, pin, false));
    ball.take(with_move(ball.rig, 0, ball.point("pin1"), {0, 1, 0}));
    CHECK(ball.puppet().functions[0].moves.size() == 2);
  }

  TEST_CASE("a removed point takes along the functions that move nothing else") {
    Ball ball = with_two_points();
    ball.take(with_move(ball.rig, 0, ball.point("point2"), {1, 2, 3}));
    ball.take(without_point(ball.rig, ball.point("point1")));
    REQUIRE(ball.puppet().points.size() == 1);
    CHECK(ball.puppet().points[0].name == "point2");
    REQUIRE(ball.puppet().functions.size() == 2); // both move the other point
    ball.take(with_function(ball.rig, {{0, 1, 0}, 0.5}, {0, 0.2, 0}, index_bends, travel));
    ball.take(without_point(ball.rig, ball.point("point1")));
    CHECK(ball.puppet().functions.size() == 2);
    CHECK(ball.refusal(without_point(ball.rig, 0)).find("'point2'") != std::string::npos);
  }

  TEST_CASE("in a mirrored puppet, what is clicked on one side is on both") {
    for (const double side : {1.0, -1.0}) {
      Ball ball = with_two_points(true);
      ball.take(with_function(ball.rig, {{side * 0.6, 0, 0.8}, 0.5}, {side * 0.3, 0.1, 0},
                              index_bends, travel));
      const std::size_t clicked = ball.point(side > 0 ? "point3Left" : "point3Right");
      const std::size_t function = ball.function(side > 0 ? "move3Left" : "move3Right");
      CHECK(ball.rig.starts()(0, static_cast<Eigen::Index>(clicked)) * side > 0.5);
      CHECK(ball.puppet().functions[function].input == index_bends); // that finger plays that side
      CHECK(ball.rig.vectors_of(function).col(static_cast<Eigen::Index>(clicked)) ==
            Vector3d(side * 0.3, 0.1, 0));
      // An edit of either twin is one of both, each on its side.
      ball.take(with_move(ball.rig, function, clicked, {side * 0.5, 0, 0}));
      const std::size_t other = ball.function(side > 0 ? "move3Right" : "move3Left");
      const std::size_t beside = ball.point(side > 0 ? "point3Right" : "point3Left");
      CHECK(ball.rig.vectors_of(other).col(static_cast<Eigen::Index>(beside)) ==
            Vector3d(-side * 0.5, 0, 0));
      ball.take(with_radius(ball.rig, clicked, 0.25));
      CHECK(ball.puppet().points[beside].radius == 0.25);
      ball.take(with_input(ball.rig, other, index_bends, 1.0));
      CHECK(ball.puppet().functions[function].input == index_bends.mirrored());
      ball.take(without_point(ball.rig, beside));
      for (const PuppetPoint& point : ball.puppet().points)
        CHECK_FALSE(point.name.starts_with("point3"));
    }
  }

  TEST_CASE("mirror on and off: sides follow from names, and twins become points of their own") {
    Ball ball = with_two_points();
    ball.take(with_function(ball.rig, {{-0.6, 0, 0.8}, 0.5}, {-0.3, 0.1, 0}, index_bends, travel));
    ball.take(with_mirror(ball.rig, true));
    CHECK(ball.puppet().mirrors);
    // One in the middle, and two sides of each of the others, where they were.
    CHECK(ball.puppet().points.size() == 5);
    CHECK(ball.puppet().functions.size() == 5);
    const auto place = [&](std::string_view name) -> Vector3d {
      return ball.rig.starts().col(static_cast<Eigen::Index>(ball.point(name)));
    };
    CHECK((place("point2Left") - Vector3d(1, 0, 0)).norm() < 0.02);
    CHECK((place("point3Right") - Vector3d(-0.6, 0, 0.8)).norm() < 0.02);
    const std::size_t third = ball.function("move3Right");
    CHECK(ball.puppet().functions[third].input == index_bends);
    CHECK(ball.rig.vectors_of(third).col(static_cast<Eigen::Index>(ball.point("point3Right"))) ==
          Vector3d(-0.3, 0.1, 0));
    const deform::Points starts = ball.rig.starts();
    ball.take(with_mirror(ball.rig, false));
    CHECK_FALSE(ball.puppet().mirrors);
    CHECK(ball.puppet().points.size() == 5);
    CHECK(ball.puppet().functions.size() == 5);
    for (const PuppetPoint& point : ball.puppet().points)
      CHECK_FALSE(point.is_mirrored);
    CHECK((place("point3Right") - Vector3d(-0.6, 0, 0.8)).norm() < 0.02);
    CHECK(ball.puppet().text.find("mirror") == std::string::npos);
  }

  TEST_CASE("shipped puppets without their mirror move the same points in the same way") {
    for (const char* name : {"face", "moai", "spot"}) {
      const Shipped shipped(name);
      const auto flat = with_mirror(shipped.rig, false);
      REQUIRE(flat);
      const Rig rig(*flat, shipped.mesh);
      REQUIRE(flat->functions.size() == shipped.puppet.functions.size());
      const double size = deform::diagonal_of(shipped.mesh.vertices);
      for (std::size_t at = 0; at < flat->functions.size(); ++at) {
        const std::size_t of = Ball::find(shipped.puppet.functions, flat->functions[at].name);
        for (std::size_t point = 0; point < flat->points.size(); ++point) {
          const std::size_t was = Ball::find(shipped.puppet.points, flat->points[point].name);
          const Vector3d now = rig.vectors_of(at).col(static_cast<Eigen::Index>(point));
          const Vector3d before = shipped.rig.vectors_of(of).col(static_cast<Eigen::Index>(was));
          CHECK((now - before).norm() < 1e-6 * size);
        }
      }
    }
  }

  TEST_CASE("a stroke of the brush leaves few masks, which the eraser takes away") {
    Ball ball = with_two_points();
    std::vector<Vector3d> stroke;
    for (int step = 0; step < 1000; ++step)
      stroke.emplace_back(std::sin(step / 1000.0), -std::cos(step / 1000.0), 0.0);
    ball.take(with_masks(ball.rig, stroke, 0.2));
    const std::size_t count = ball.puppet().masks.size();
    CHECK(count >= 10);
    CHECK(count <= 16);                           // a radian of way, a mask each 0.07
    ball.take(with_masks(ball.rig, stroke, 0.2)); // again: all of it is there
    CHECK(ball.puppet().masks.size() == count);
    for (const Vector3d& place : stroke)
      CHECK(std::any_of(ball.puppet().masks.begin(), ball.puppet().masks.end(),
                        [&](const Mask& mask) { return (mask.at - place).norm() < 0.1; }));
    CHECK_FALSE(with_masks(ball.rig, stroke, 1e-5));
    ball.take(without_masks(ball.rig, std::span(stroke).first(1), 0.1));
    CHECK(ball.puppet().masks.size() < count);
    ball.take(without_masks(ball.rig, stroke, 0.2));
    CHECK(ball.puppet().masks.empty());
  }

  TEST_CASE("a turn takes the place of ways, and a turned function's angle is changed") {
    Ball ball = with_two_points();
    const std::size_t point = ball.point("point2"), function = ball.function("move2");
    const AxisTurn turn{30.0, {0, 0, 2}, {0.0, 0.5, 0.0}};
    const deform::Points preview = vectors_with_turn(ball.rig, function, point, turn);
    ball.take(with_turn(ball.rig, function, point, turn));
    CHECK((ball.rig.vectors_of(function) - preview).norm() < 1e-12);
    const Vector3d start = ball.rig.starts().col(static_cast<Eigen::Index>(point));
    const double x = start.x(), y = start.y() - 0.5, c = std::cos(from_degrees(30.0)), s = 0.5;
    const Vector3d end(c * x - s * y, s * x + c * y + 0.5, start.z());
    CHECK(
        (ball.rig.vectors_of(function).col(static_cast<Eigen::Index>(point)) - end + start).norm() <
        1e-9);
    // Another point turns with it, and its way goes.
    const std::size_t other = ball.point("point1");
    ball.take(with_turn(ball.rig, function, other, {-45.0, {0, 0, 1}, {0, 0.5, 0}}));
    CHECK(ball.puppet().functions[function].moves.size() == 2);
    CHECK(ball.puppet().functions[function].turn->degrees == -45.0);
    CHECK(ball.rig.vectors_of(function).col(static_cast<Eigen::Index>(other)).norm() > 0.1);
    CHECK_FALSE(with_turn(ball.rig, function, point, {10.0, {0, 0, 0}, {0, 0, 0}}));
    CHECK_FALSE(with_turn(ball.rig, function, point, {400.0, {0, 0, 1}, {0, 0, 0}}));
    CHECK_FALSE(with_turn(ball.rig, function, point, {std::nan(""), {0, 0, 1}, {0, 0, 0}}));
  }

  TEST_CASE("a turn of a twin is the mirrored turn of the other side") {
    Ball ball = with_two_points(true);
    const auto& functions = ball.puppet().functions;
    const auto twin = std::find_if(functions.begin(), functions.end(),
                                   [](const Function& one) { return one.is_twin; });
    REQUIRE(twin != functions.end());
    const auto number = static_cast<std::size_t>(twin - functions.begin());
    const std::size_t point = twin->moves.front().point;
    const AxisTurn turn{20.0, {0.1, 0.2, 1.0}, {-0.1, 0.3, 0.2}};
    const deform::Points preview = vectors_with_turn(ball.rig, number, point, turn);
    const std::string source = twin_of(twin->name);
    ball.take(with_turn(ball.rig, number, point, turn));
    CHECK((ball.rig.vectors_of(number).col(static_cast<Eigen::Index>(point)) -
           preview.col(static_cast<Eigen::Index>(point)))
              .norm() < 1e-9);
    Vector3d image =
        ball.rig.vectors_of(ball.function(source))
            .col(static_cast<Eigen::Index>(ball.point(twin_of(ball.puppet().points[point].name))));
    image.x() = -image.x();
    CHECK((image - preview.col(static_cast<Eigen::Index>(point))).norm() < 1e-2);
    CHECK(image.norm() > 0.05);
  }

  TEST_CASE("edits of a shipped puppet keep all that they do not change") {
    const Shipped face("face");
    const std::size_t nose = Ball::find(face.puppet.points, "nose");
    const auto edited = with_radius(face.rig, nose, 2.75);
    REQUIRE(edited);
    Puppet expected = face.puppet;
    expected.points[nose].radius = 2.75;
    CHECK(*edited == expected);
    const std::size_t jaw = Ball::find(face.puppet.functions, "jawOpen");
    const std::size_t chin = Ball::find(face.puppet.points, "chin");
    const auto turned = with_move(face.rig, jaw, chin, {0, 1, 0});
    REQUIRE_FALSE(turned);
    CHECK(turned.error().message.find("turns 'chin'") != std::string::npos);
    CHECK_FALSE(with_name(face.rig, jaw, "mouthPucker"));
    const auto named = with_name(face.rig, jaw, "jawDown");
    REQUIRE(named);
    CHECK(std::any_of(named->functions.begin(), named->functions.end(),
                      [](const auto& function) { return function.name == "jawDown"; }));
  }
}

TEST_SUITE("bend watch") {
  TEST_CASE("the finger that bends farthest is chosen, and none of relaxed hands") {
    std::mt19937 random(7);
    for (const Side side : {Side::left, Side::right}) {
      for (std::size_t finger = 0; finger < 5; ++finger) {
        std::array<HandState, 2> hands;
        BendWatch watch;
        const auto angle = [&](std::size_t which) -> double& {
          auto& angles = hands[static_cast<std::size_t>(side)].angles;
          return which == 0 ? angles.thumb_mcp_flexion_rad
                            : angles.fingers[which - 1].mcp_flexion_rad;
        };
        for (std::size_t which = 0; which < 5; ++which)
          angle(which) = std::uniform_real_distribution(0.0, 0.5)(random); // relaxed
        const auto follow = [&] { return watch.follow({&hands[0], &hands[1]}); };
        watch.begin();
        CHECK_FALSE(follow());
        const std::size_t beside = finger == 4 ? 3 : finger + 1;
        const double far = BendWatch::usual_rad(finger) * BendWatch::min_bend_fraction;
        angle(finger) += 0.9 * far;
        CHECK_FALSE(follow());
        angle(finger) += 0.2 * far;
        angle(beside) += 0.4 * BendWatch::usual_rad(beside) * BendWatch::min_bend_fraction;
        const auto bend = follow();
        REQUIRE(bend);
        CHECK(bend->input.side() == side);
        CHECK(bend->input.number() == finger);
        CHECK(bend->travel == BendWatch::usual_rad(finger));
        angle(beside) += 0.7 * BendWatch::usual_rad(beside) * BendWatch::min_bend_fraction;
        CHECK_FALSE(follow()); // two bend alike
        watch.begin();
        CHECK_FALSE(follow()); // from where they are now
        angle(finger) -= 1.1 * far;
        const auto straight = follow();
        REQUIRE(straight);
        CHECK(straight->travel == -BendWatch::usual_rad(finger));
      }
    }
    BendWatch watch;
    CHECK_FALSE(watch.follow({}));
  }
}

} // namespace puppet_edit_test
