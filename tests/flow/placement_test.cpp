#include <nendo/flow/placement.hpp>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"

namespace placement_test {

using namespace nendo;
using namespace nendo::flow;
using nendo::test::ball;
using nendo::test::bent_sample;

namespace {

std::array<std::optional<Fingertips>, 2> relaxed_tips() {
  std::array<std::optional<Fingertips>, 2> tips;
  for (const Side side : {Side::left, Side::right}) {
    const auto angles = hand::joint_angles(bent_sample(side, 10, {}), hand::default_calibration());
    tips[Placement::index_of(side)] =
        hand::HandSkeleton(side).pose(angles, Eigen::Isometry3d::Identity()).fingertip_positions();
  }
  return tips;
}

Fingertips on_stage(const Placement& placement,
                    const std::array<std::optional<Fingertips>, 2>& tips, Side side) {
  const auto& T = placement.T_stage_wrist[Placement::index_of(side)];
  return (T.linear() * *tips[Placement::index_of(side)]).colwise() + T.translation();
}

} // namespace

TEST_SUITE("placement") {
  TEST_CASE("all ten fingertips touch the model's surface") {
    const auto tips = relaxed_tips();
    const Placement placement = place_hands(ball(48), tips);
    // On a ball of 80 cm vertices are up to 2.6 cm apart; the surface itself is known exactly.
    for (const Side side : {Side::left, Side::right}) {
      const Fingertips placed = on_stage(placement, tips, side);
      for (Eigen::Index i = 0; i < 5; ++i) {
        CHECK(placed.col(i).norm() == doctest::Approx(0.4).epsilon(0.015));
      }
    }
  }

  TEST_CASE("the right hand is at the operator's right, palms inwards, fingers forward") {
    const auto tips = relaxed_tips();
    const Placement placement = place_hands(ball(48), tips);
    for (const Side side : {Side::left, Side::right}) {
      const double outwards = side == Side::right ? 1.0 : -1.0;
      const auto& T = placement.T_stage_wrist[Placement::index_of(side)];
      CHECK(outwards * T.translation().x() > 0.1);
      CHECK(outwards * T.linear().col(1).x() > 0.3); // the back of the hand looks outwards
      CHECK(T.linear().col(2).z() > 0.5);            // the fingers point away from the operator
    }
  }

  TEST_CASE("a model in other units or elsewhere is held in the same way") {
    const auto tips = relaxed_tips();
    deform::Mesh model = ball(24);
    const Placement here = place_hands(model, tips);
    const Eigen::Vector3d offset(700.0, -300.0, 50.0);
    model.vertices = (1000.0 * model.vertices).colwise() + offset;
    const Placement there = place_hands(model, tips);
    CHECK(there.units_per_metre == doctest::Approx(1000.0 * here.units_per_metre));
    for (std::size_t at = 0; at < 2; ++at) {
      const Eigen::Vector3d shift = offset / there.units_per_metre;
      CHECK((there.T_stage_wrist[at].translation() - shift - here.T_stage_wrist[at].translation())
                .norm() < 1e-6);
      CHECK((there.T_stage_wrist[at].linear() - here.T_stage_wrist[at].linear()).norm() < 1e-6);
    }
  }

  TEST_CASE("an absent hand is left alone, and a model without extent does no harm") {
    auto tips = relaxed_tips();
    tips[0].reset();
    deform::Mesh point;
    point.vertices = deform::Points::Zero(3, 1);
    const Placement placement = place_hands(point, tips);
    CHECK(placement.units_per_metre == 1.0);
    CHECK(placement.T_stage_wrist[0].matrix() == Eigen::Matrix4d::Identity());
    CHECK(placement.T_stage_wrist[1].matrix().allFinite());
  }
}

} // namespace placement_test
