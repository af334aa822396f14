#include "clay/rigid_fit.hpp"

#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace rigid_fit_test {

using namespace nendo::deform;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

Vector3d random_vector(std::mt19937& random, double size) {
  return nendo::test::random_points(random, 1, size).col(0);
}

} // namespace

TEST_SUITE("rigid_fit") {
  TEST_CASE("what is held all round goes along as a rigid body") {
    std::mt19937 random(61);
    for (int trial = 0; trial < 20; ++trial) {
      const Vector3d middle = random_vector(random, 1.0);
      Isometry3d wanted = Isometry3d::Identity();
      wanted.linear() =
          Eigen::AngleAxisd(0.01, random_vector(random, 1.0).normalized()).toRotationMatrix();
      wanted.translation() = random_vector(random, 0.02);
      std::vector<Carrier> carriers(8);
      for (std::size_t at = 0; at < carriers.size(); ++at) {
        carriers[at].at = random_vector(random, 1.0);
        carriers[at].way = wanted * carriers[at].at - carriers[at].at;
        if (at % 2 == 0) continue; // held; the others stick, and are as deep as they go
        carriers[at].normal = random_vector(random, 1.0).normalized();
        carriers[at].depth = carriers[at].way.dot(carriers[at].normal);
        carriers[at].load = 1.0;
      }
      const Isometry3d found = fit_rigid_motion(carriers, middle, 0.5, 0.5);
      for (const Carrier& one : carriers)
        CHECK((found * one.at - one.at - one.way).norm() < 3e-4); // a turn is not linear
      CHECK((found.linear() * found.linear().transpose() - Eigen::Matrix3d::Identity()).norm() <
            1e-12);
    }
  }

  TEST_CASE("depths that face each other are shared, and no more is resisted than clay yields") {
    std::vector<Carrier> carriers(2);
    carriers[0] = {Vector3d(-1, 0, 0), Vector3d::UnitX(), Vector3d::Zero(), 0.3, 0.0};
    carriers[1] = {Vector3d(1, 0, 0), -Vector3d::UnitX(), Vector3d::Zero(), 0.1, 0.0};
    CHECK(fit_rigid_motion(carriers, Vector3d::Zero(), 0.5, 1.0).translation().x() ==
          doctest::Approx(0.1).epsilon(1e-3));
    // A part pressed from one side only moves altogether.
    carriers.pop_back();
    CHECK(fit_rigid_motion(carriers, Vector3d::Zero(), 0.5, 1.0).translation().x() ==
          doctest::Approx(0.3).epsilon(1e-3));
    // Two that yield against one that does not: the force of each is bounded.
    carriers[0].depth = 100.0;
    carriers.push_back({Vector3d(1, 0, 0), -Vector3d::UnitX(), Vector3d::Zero(), 0.1, 0.0});
    carriers.push_back(carriers.back());
    CHECK(fit_rigid_motion(carriers, Vector3d::Zero(), 0.5, 1.0).translation().x() < 1.0);
  }

  TEST_CASE("friction carries up to its limit, and nothing carries what is not touched") {
    std::vector<Carrier> carriers{
        {Vector3d::Zero(), Vector3d::UnitZ(), Vector3d(0.1, 0, 0), 0.0, 1.0},
        {Vector3d(0, 1, 0), Vector3d::UnitZ(), Vector3d(0.1, 0, 0), 0.0, 1.0}};
    CHECK(fit_rigid_motion(carriers, Vector3d::Zero(), 0.5, 1.0).translation().x() ==
          doctest::Approx(0.1).epsilon(1e-3));
    for (Carrier& carrier : carriers)
      carrier.load = 0.0;
    CHECK(fit_rigid_motion(carriers, Vector3d::Zero(), 0.5, 1.0).matrix().isIdentity(1e-12));
    CHECK(fit_rigid_motion({}, Vector3d::Zero(), 0.5, 1.0).matrix().isIdentity(1e-12));
  }

  TEST_CASE("fitting does not allocate") {
    const std::vector<Carrier> carriers(
        40, {Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d(0.1, 0, 0), 0.2, 1.0});
    const nendo::test::Restraint restraint;
    CHECK(fit_rigid_motion(carriers, Vector3d::Zero(), 0.5, 1.0).matrix().allFinite());
    CHECK(restraint.counts().allocations == 0);
  }
}

} // namespace rigid_fit_test
