#include <cstdio>
#include <string>

#include <doctest/doctest.h>

#include <nendo/puppet/puppet.hpp>
#include <nendo/puppet/rig.hpp>

#include "reference/icosphere.hpp"
#include "support/placed_meshes.hpp"

namespace offset_puppet_test {

using namespace nendo;
using Eigen::Vector3d;

namespace {

/// A puppet of a ball of radius 1 about a place. A mirror of x = 0 is only at zero.
std::string text_at(const Vector3d& at, bool mirrors) {
  const auto place = [&](double x, double y, double z) {
    const Vector3d moved = at + Vector3d(x, y, z);
    char text[120];
    std::snprintf(text, sizeof text, "[%.17g, %.17g, %.17g]", moved.x(), moved.y(), moved.z());
    return std::string(text);
  };
  return "version = 1\nmodel = \"ball.obj\"\ndistance = \"air\"\n" +
         std::string(mirrors ? "mirror = \"x\"\n" : "") +
         "[points]\nbrowLeft = { at = " + place(0.6, 0.8, 0.0) +
         ", radius = 0.5 }\nnose = { at = " + place(0.0, 0.0, 1.0) +
         ", radius = 0.5, pin = true }\n"
         "[functions.browLeft]\ninput = \"left.index_flexion\"\ntravel_deg = 60.0\n"
         "turn = { degrees = 20.0, axis = [1.0, 0.0, 0.5], through = " +
         place(0.3, 0.1, 0.2) + ", points = { browLeft = 1.0 } }\n[[parts]]\ninside = [" +
         place(-0.1, -0.1, -0.1) + ", " + place(0.1, 0.1, 0.1) +
         "]\n[[masks]]\nat = " + place(0.0, -1.0, 0.0) + "\nradius = 0.4\n";
}

} // namespace

TEST_SUITE("offset_puppet") {
  TEST_CASE("a puppet does far from zero what it does there") {
    const Vector3d away(500000.0, -4650000.0, 128.0);
    const deform::Mesh ball = reference::icosphere(2, 1.0);
    for (const bool mirrors : {false, true}) {
      auto near = puppet::parse_puppet(text_at(Vector3d::Zero(), mirrors), "near");
      CAPTURE(near ? "" : near.error().message);
      REQUIRE(near);
      auto far = puppet::parse_puppet(text_at(away, mirrors), "far");
      REQUIRE(far);
      const puppet::Puppet in_file = *far;
      puppet::count_from(away, *far);
      const puppet::Rig one(*near, ball), other(*far, ball);
      REQUIRE(one.starts().cols() == other.starts().cols());
      CHECK((one.starts() - other.starts()).cwiseAbs().maxCoeff() < 1e-8);
      REQUIRE(near->functions.size() == (mirrors ? 2 : 1));
      for (std::size_t at = 0; at < near->functions.size(); ++at)
        CHECK((one.vectors_of(at) - other.vectors_of(at)).cwiseAbs().maxCoeff() < 1e-8);
      const auto weights = puppet::mask_weights(*near, ball.vertices);
      CHECK((puppet::mask_weights(*far, ball.vertices) - weights).cwiseAbs().maxCoeff() < 1e-7);
      // What a recording has is what the rig was made of.
      const auto text = puppet::parse_puppet(far->text, "the recorded puppet");
      REQUIRE(text);
      CHECK(*text == *far);
      puppet::count_from(-away, *far);
      const auto saved = puppet::parse_puppet(far->text, "saved");
      REQUIRE(saved);
      CHECK((saved->points[0].at - in_file.points[0].at).norm() < 1e-8);
      CHECK((saved->masks[0].at - in_file.masks[0].at).norm() < 1e-8);
      CHECK((saved->functions[0].turn->through - in_file.functions[0].turn->through).norm() < 1e-8);
    }
  }

  TEST_CASE("a mask's plane of symmetry moves, and that of the middle stays") {
    const std::string masks = "version = 1\nmirror = \"x\"\n[[masks]]\nat = [1.0, 0.0, 0.0]\n"
                              "radius = 1.0\n";
    auto of_middle = puppet::parse_puppet(masks, "masks");
    REQUIRE(of_middle);
    puppet::count_from({1000.0, 0.0, 0.0}, *of_middle);
    CHECK(of_middle->mirror_at == 0.0);
    auto elsewhere = puppet::parse_puppet("mirror_at = 1001.0\n" + masks, "masks");
    REQUIRE(elsewhere);
    puppet::count_from({1000.0, 0.0, 0.0}, *elsewhere);
    CHECK(elsewhere->mirror_at == 1.0);
    const std::string text = elsewhere->text;
    puppet::count_from(Vector3d::Zero(), *elsewhere);
    CHECK(elsewhere->text == text);
  }
}

} // namespace offset_puppet_test
