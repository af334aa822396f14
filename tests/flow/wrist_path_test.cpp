#include <nendo/flow/wrist.hpp>

#include <limits>
#include <numbers>

#include <doctest/doctest.h>

namespace wrist_path_test {

using nendo::flow::WristPath;

namespace {

/// At x metres, turned about z.
Eigen::Isometry3d pose(double x, double angle_rad) {
  return Eigen::Translation3d(x, 0.0, 0.0) * Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ());
}

} // namespace

TEST_SUITE("wrist_path") {
  TEST_CASE("between two poses a path is a line and the shortest turn, and outside it stays") {
    const WristPath path({pose(0.0, 3.0), pose(1.0, -3.0), pose(3.0, -2.0)}, 0.5);
    CHECK(path.length_s() == 1.0);
    CHECK(path.at(0.0).isApprox(pose(0.0, 3.0)));
    CHECK(path.at(0.25).isApprox(pose(0.5, std::numbers::pi)));
    CHECK(path.at(0.75).isApprox(pose(2.0, -2.5)));
    CHECK(path.at(1.0).isApprox(pose(3.0, -2.0)));
    CHECK(path.at(9.0).isApprox(pose(3.0, -2.0)));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double time_s :
         {-1.0, -infinity, infinity, std::numeric_limits<double>::quiet_NaN()})
      CHECK(path.at(time_s).isApprox(pose(0.0, 3.0)));
    CHECK(path.place(0.75).first == 1);
    CHECK(path.place(0.75).part == doctest::Approx(0.5));
    CHECK(path.place(1.0).first == 1);
    CHECK(path.place(1.0).part == 1.0);
  }
}

} // namespace wrist_path_test
