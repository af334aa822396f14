// The laws of puppet files.

#include <doctest/doctest.h>

#include <array>
#include <string>

#include <nendo/base/units.hpp>
#include <nendo/puppet/puppet.hpp>

#include "support/test_meshes.hpp"

namespace puppet_file_test {

using namespace nendo;
using nendo::puppet::parse_puppet;

namespace {

const std::string head = "version = 1\nmodel = \"m.obj\"\nmirror = \"x\"\n";
const std::string points = "[points]\n"
                           "tip = { at = [0.0, 1.0, 0.0], radius = 2.0 }\n"
                           "cornerLeft = { vertex = 7, radius = 1.5 }\n"
                           "still = { at = [0.0, 0.0, 0.0], radius = 1.0, pin = true }\n";
const std::string smile =
    "[functions.smileLeft]\ninput = \"right.index_flexion\"\ntravel_deg = 90\n"
    "move = { cornerLeft = [1.0, 2.0, 3.0], tip = [0.5, 0.0, 0.0] }\n";
const std::string whole = head + points + smile;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

/// The message of a text that must be refused with one line that begins with the name.
std::string refusal(const std::string& text) {
  const auto parsed = parse_puppet(text, "p.toml");
  REQUIRE_FALSE(parsed);
  CHECK(parsed.error().code == Errc::bad_input);
  CHECK(parsed.error().message.starts_with("p.toml:"));
  CHECK(parsed.error().message.find('\n') == std::string::npos);
  return parsed.error().message;
}

bool refuses(const std::string& text, std::string_view with) {
  const std::string message = refusal(text);
  INFO(message);
  return message.find(with) != std::string::npos;
}

} // namespace

TEST_SUITE("puppet file") {
  TEST_CASE("a point may have several radii with weights, and so has its twin") {
    const std::string mixed =
        replaced(whole, "radius = 1.5", "radius = [0.5, 1.5], weights = [2, 0.25]");
    const auto parsed = parse_puppet(mixed, "p.toml");
    REQUIRE(parsed);
    for (const std::size_t at : {std::size_t{0}, std::size_t{3}}) // in the order of their names
    {
      CHECK(parsed->points[at].mix == std::vector<deform::Support>{{0.5, 2.0}, {1.5, 0.25}});
      CHECK(parsed->points[at].radius == 1.5);
    }
    const auto again = parse_puppet(text_of(*parsed), "p.toml");
    REQUIRE(again);
    CHECK(*again == *parsed);
    const auto alike = parse_puppet(replaced(whole, "radius = 1.5", "radius = [3, 1]"), "p.toml");
    REQUIRE(alike);
    CHECK(alike->points[0].mix == std::vector<deform::Support>{{3.0, 1.0}, {1.0, 1.0}});
    CHECK(*parse_puppet(text_of(*alike), "p.toml") == *alike);
    for (const char* const wrong :
         {"radius = []", "radius = [1, 0]", "radius = [1, nan]", "radius = [1, 2, 3, 4, 5]",
          "radius = [1, \"2\"]", "radius = 1, weights = [1]", "radius = [1, 2], weights = [1]",
          "radius = [1, 2], weights = [1, -1]"})
      CHECK(refuses(replaced(whole, "radius = 1.5", wrong), "p.toml:6"));
  }

  TEST_CASE("a mirrored file has twins of those named Left: other hand, other side") {
    const auto parsed = parse_puppet(whole, "p.toml");
    REQUIRE(parsed);
    REQUIRE(parsed->points.size() == 4);
    CHECK(parsed->points[3].name == "cornerRight");
    CHECK(parsed->points[3].is_mirrored);
    CHECK(parsed->points[3].radius == 1.5);
    REQUIRE(parsed->functions.size() == 2);
    const auto& left = parsed->functions[0];
    const auto& right = parsed->functions[1];
    CHECK(left.name == "smileLeft");
    CHECK(right.name == "smileRight");
    CHECK(left.input.name() == "right.index_flexion");
    CHECK(right.input.name() == "left.index_flexion");
    CHECK(right.travel == doctest::Approx(from_degrees(90.0)));
    REQUIRE(right.moves.size() == left.moves.size());
    for (std::size_t at = 0; at < left.moves.size(); ++at) {
      const Eigen::Vector3d flipped = left.moves[at].vector.cwiseProduct(Eigen::Vector3d(-1, 1, 1));
      CHECK(right.moves[at].vector == flipped);
      const bool is_middle = parsed->points[left.moves[at].point].name == "tip";
      CHECK((right.moves[at].point == left.moves[at].point) == is_middle);
    }
  }

  TEST_CASE("without mirror, there are no twins") {
    const auto parsed = parse_puppet(replaced(whole, "mirror = \"x\"\n", ""), "p.toml");
    REQUIRE(parsed);
    CHECK(parsed->points.size() == 3);
    CHECK(parsed->functions.size() == 1);
  }

  TEST_CASE("a twin that the file has itself stays as it is") {
    const auto parsed = parse_puppet(
        replaced(whole, "tip =", "cornerRight = { vertex = 9, radius = 4.0 }\ntip ="), "p.toml");
    REQUIRE(parsed);
    CHECK(parsed->points.size() == 4);
    for (const auto& point : parsed->points)
      if (point.name == "cornerRight") CHECK(point.radius == 4.0);
  }

  TEST_CASE("unknown keys are refused, wherever they are") {
    CHECK(refuses("colour = 1\n" + whole, "'colour'"));
    CHECK(refuses(replaced(whole, "radius = 2.0", "radius = 2.0, size = 1"), "'size'"));
    CHECK(refuses(replaced(whole, "travel_deg = 90", "travel_deg = 90\nspeed = 2"), "'speed'"));
  }

  TEST_CASE("values of a wrong type or range are refused by name") {
    CHECK(refuses(replaced(whole, "radius = 2.0", "radius = \"2\""), "radius"));
    CHECK(refuses(replaced(whole, "radius = 2.0", "radius = -2.0"), "radius"));
    CHECK(refuses(replaced(whole, "radius = 2.0", "radius = inf"), "radius"));
    CHECK(refuses(replaced(whole, "vertex = 7", "vertex = -7"), "vertex"));
    CHECK(refuses(replaced(whole, "[0.0, 1.0, 0.0]", "[0.0, 1.0]"), "at"));
    CHECK(refuses(replaced(whole, "travel_deg = 90", "travel_deg = 0"), "travel"));
    CHECK(refuses(replaced(whole, "travel_deg = 90", "travel_deg = 90\nleast = 0.5"), "least"));
    CHECK(refuses(replaced(whole, "travel_deg = 90", "travel_deg = 90\ncurve = \"x\""), "curve"));
    CHECK(refuses(replaced(whole, "version = 1", "version = 2"), "version"));
    CHECK(refuses(replaced(whole, "pin = true", "pin = 1"), "pin"));
    CHECK(refuses(replaced(whole, "travel_deg = 90", "travel_deg = 90\nmost = 1e300"), "most"));
    CHECK(refuses(whole + "turn = { degrees = 1e300, axis = [1, 0, 0], through = [0, 0, 0], "
                          "points = { tip = 1e300 } }\n",
                  "degrees"));
  }

  TEST_CASE("clutches are chosen by hand, and hostile bounds are refused") {
    const auto none = parse_puppet(whole, "p.toml");
    REQUIRE(none);
    CHECK(none->clutch.means == std::array<puppet::ClutchTrigger, 2>{});
    const auto parsed = parse_puppet(
        whole + "[clutch]\nleft = \"fist\"\nright = \"switch\"\nheld_s = 1\nfist_deg = 180\n",
        "p.toml");
    REQUIRE(parsed);
    CHECK(parsed->clutch.means ==
          std::array{puppet::ClutchTrigger::fist, puppet::ClutchTrigger::wrist_switch});
    CHECK(parsed->clutch.held_s == 1.0);
    CHECK(parsed->clutch.fist_deg == 180.0);
    CHECK(parsed->clutch.pinch_m == 0.02);
    CHECK(refuses(whole + "[clutch]\nleft = \"kick\"\n", "'kick'"));
    CHECK(refuses(whole + "[clutch]\nfoot = \"fist\"\n", "'foot'"));
    CHECK(refuses(whole + "[clutch]\nheld_s = 0.1\n", "held_s must be within 0.25 and 5"));
    CHECK(refuses(whole + "[clutch]\nheld_s = nan\n", "held_s"));
    CHECK(refuses(whole + "[clutch]\nfist_deg = 1e9\n", "fist_deg"));
    CHECK(refuses(whole + "[clutch]\npinch_m = -1\n", "pinch_m"));
    CHECK(refuses("clutch = 1\n" + whole, "clutch must be a table"));
  }

  TEST_CASE("what would take memory, stack or time without bound is refused in a sentence") {
    const auto many = [](const std::string& text, std::size_t count) {
      std::string all;
      for (std::size_t at = 0; at < count; ++at)
        all += text;
      return all;
    };
    CHECK(refuses(head + "points = " + many("[", 500000), "deep"));
    CHECK(refuses(head + "[points" + many(".a", 500000) + "]\n", "parts"));
    CHECK(refuses(whole + many("[[masks]]\n", 1001), "1000 masks"));
    CHECK(refuses(whole + many("[[parts]]\n", 1001), "1000 parts"));
    std::string crowded = head + "[points]\n";
    for (int at = 0; at < 30000; ++at)
      crowded += "p" + std::to_string(at) + " = { vertex = 1, radius = 1 }\n";
    CHECK(refuses(crowded + smile, "1000 points"));
  }

  TEST_CASE("without points it is a mask file, which is written and read as the same") {
    const std::string masks = "version = 1\ninverted = true\nmirror = \"x\"\nmirror_at = 0.25\n"
                              "[[masks]]\nat = [1, 2, 3]\nradius = 0.5\n";
    const auto parsed = parse_puppet(masks, "p.toml");
    REQUIRE(parsed);
    CHECK_FALSE(parsed->is_played());
    CHECK(parsed->inverted);
    CHECK(parsed->mirrors);
    CHECK(parsed->mirror_at == 0.25);
    REQUIRE(parsed->masks.size() == 1);
    const auto again = parse_puppet(puppet::text_of(*parsed), "again");
    REQUIRE(again);
    CHECK(*again == *parsed);
    CHECK(parse_puppet(puppet::text_of(puppet::Puppet{}), "nothing"));
    deform::Points places(3, 3);
    places << 1, 1, 9, 2, 2, 9, 3, 3.49, 9;
    const Eigen::VectorXd weights =
        puppet::mask_weights(*parsed, places); // inverted: the ball moves
    CHECK(weights[0] == 1.0);
    CHECK((weights[1] > 0.0 && weights[1] < 0.1));
    CHECK(weights[2] == 0.0);
    CHECK(puppet::mask_weights(puppet::Puppet{}, places).size() == 0);
    CHECK(refuses("version = 1\nclutch = {}\n", "needs [points]"));
    CHECK(refuses("version = 1\nmirror_at = nan\n", "mirror_at"));
    CHECK(refuses("version = 1\n[[masks]]\nat = [0, 0, 0]\n", "radius"));
    CHECK(refuses("mirror_at = 1\n" + whole, "mirror_at"));
  }

  TEST_CASE("the plane of symmetry is found in the middle of a model that is not at x = 0") {
    const deform::Points ball = test::sphere(12, 24, 2.0).vertices;
    CHECK(puppet::plane_of_symmetry(ball) == 0.0);
    deform::Points aside = ball;
    aside.row(0).array() += 3.0;
    CHECK(puppet::plane_of_symmetry(aside) == doctest::Approx(3.0));
    aside.row(1) += 0.3 * aside.row(0); // sheared, it has no such plane
    aside.row(2) += 0.2 * aside.row(0).cwiseAbs2();
    CHECK(puppet::plane_of_symmetry(aside) == 0.0);
  }

  TEST_CASE("points and signals that there are not are named") {
    CHECK(refuses(replaced(whole, "move = { cornerLeft", "move = { cornerLift"), "'cornerLift'"));
    CHECK(refuses(replaced(whole, "right.index_flexion", "right.toe_flexion"),
                  "'right.toe_flexion'"));
    CHECK(refuses(replaced(whole, "right.index_flexion", "index_flexion"), "'index_flexion'"));
  }

  TEST_CASE("nothing moves a pin") {
    CHECK(refuses(replaced(whole, "tip = [0.5", "still = [0.5"), "pin"));
  }

  TEST_CASE("names are plain, since they go into messages and captions") {
    CHECK(refuses(replaced(whole, "tip =", "\"a b\" ="), "letters"));
    CHECK(refuses(replaced(whole, "[functions.smileLeft]", "[functions.\"\\n\"]"), "letters"));
  }

  TEST_CASE("a file without points, functions or a model is refused") {
    CHECK(refuses(head + points, "functions"));
    CHECK(refuses(head + smile, "points"));
    CHECK(refuses(replaced(whole, "model = \"m.obj\"\n", ""), "model"));
    CHECK(refuses("[points", ""));
  }
}

} // namespace puppet_file_test
