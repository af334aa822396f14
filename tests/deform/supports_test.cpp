#include <nendo/deform/supports.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

namespace supports_test {

using namespace nendo::deform;

TEST_SUITE("supports") {
  TEST_CASE("radii with weights are read from text") {
    using List = std::vector<Support>;
    CHECK(parse_supports("10") == List{{10.0, 1.0}});
    CHECK(parse_supports("10+40:0.5") == List{{10.0, 1.0}, {40.0, 0.5}});
    CHECK(parse_supports("1e-3:2+.5:1e2+7") == List{{1e-3, 2.0}, {0.5, 100.0}, {7.0, 1.0}});
    for (const char* bad :
         {"", "+", "10+", "+10", "10++40", "0", "-1", "10:0", "10:-1", "10:", ":1", "10:1:1", "nan",
          "inf", "10:nan", "1e101", "ten", "10 40", "10,40"})
      CHECK_MESSAGE(!parse_supports(bad), bad);
  }

  TEST_CASE("one radius is for all fingers, five are for those of each hand, ten for all in turn") {
    const auto all = parse_supports_by_point("10+40:0.5", 10);
    REQUIRE(all);
    CHECK(all->shared == std::vector<Support>{{10.0, 1.0}, {40.0, 0.5}});
    CHECK(all->own.empty());
    const auto five = parse_supports_by_point("5,6,7+70,8,9:2", 10);
    REQUIRE(five);
    CHECK(five->shared == std::vector<Support>{{5.0, default_common_weight}});
    CHECK(five->own.size() == 12);
    CHECK(five->own[2] == OwnSupport{2, {7.0, 1.0}});
    CHECK(five->own[3] == OwnSupport{2, {70.0, 1.0}});
    CHECK(five->own.back() == OwnSupport{9, {9.0, 2.0}});
    const auto ten = parse_supports_by_point("1,2,3,4,5,6,7,8,9,10", 10);
    REQUIRE(ten);
    CHECK(ten->own[9] == OwnSupport{9, {10.0, 1.0}});
    for (const char* bad : {"", ",", "1,2,3", "1,2,3,4,5,", "1,2,3,4,x", "1,2,3,4,5,6,7,8,9,10,11"})
      CHECK_MESSAGE(!parse_supports_by_point(bad, 10), bad);
    CHECK_FALSE(parse_supports_by_point("1,2,3,4,5,6,7,8,9,10", 5));
    CHECK_FALSE(parse_supports_by_point("1,2", 0));
  }

  TEST_CASE("supports reach all of a box if each start point's reaches its eight corners") {
    const Box box{Eigen::Vector3d(-1, 0, 2), Eigen::Vector3d(3, 1, 4)};
    Points starts(3, 2);
    starts << 0, 5, 0, 1, 3, 2;
    Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
    for (Eigen::Index at = 0; at < 2; ++at)
      for (const double x : {-1.0, 3.0})
        for (const double y : {0.0, 1.0})
          for (const double z : {2.0, 4.0})
            farthest[at] =
                std::max(farthest[at], (starts.col(at) - Eigen::Vector3d(x, y, z)).norm());
    const double all = farthest.maxCoeff();
    CHECK(reach_all_of(box, starts, one_radius(1.001 * all)));
    CHECK_FALSE(reach_all_of(box, starts, one_radius(0.999 * all)));
    CHECK(reach_all_of(box, starts, Supports{{{0.1, 1.0}, {1.001 * all, 0.5}}, {}}));
    CHECK(
        reach_all_of(box, starts,
                     Supports{{{0.1, 1.0}},
                              {{0, {1.001 * farthest[0], 1.0}}, {1, {1.001 * farthest[1], 1.0}}}}));
    CHECK_FALSE(reach_all_of(box, starts, Supports{{{0.1, 1.0}}, {{0, {100.0, 1.0}}}}));
    CHECK_FALSE(reach_all_of(box, Points(3, 0), one_radius(100.0)));
    CHECK_FALSE(reach_all_of({box.lowest, box.lowest}, starts, one_radius(100.0)));
    CHECK_FALSE(reach_all_of(finite_box_of(Points(3, 0)), starts, one_radius(100.0)));
  }

  TEST_CASE("the common radius is the least one, or the one given") {
    const Supports least = with_common({{0, {30.0, 1.0}}, {1, {20.0, 1.0}}, {1, {50.0, 2.0}}});
    REQUIRE(least.shared.size() == 1);
    CHECK(least.shared[0] == Support{20.0, default_common_weight});
    CHECK(least.own.size() == 3);
    CHECK(least.functions(10) == 13);
    const Supports given = with_common({{0, {30.0, 1.0}}, {1, {20.0, 1.0}}}, Support{10.0, 0.5});
    CHECK(given.shared[0] == Support{10.0, 0.5});
    CHECK(given.own.size() == 2);
  }

  TEST_CASE("one and the same radius everywhere is the one radius") {
    const Supports same = with_common({{0, {30.0, 1.0}}, {1, {30.0, 7.0}}});
    CHECK(same.shared == std::vector<Support>{{30.0, 1.0}});
    CHECK(same.own.empty());
    Supports assigned;
    assign_radii(assigned, Eigen::Vector3d(4.0, 5.0, 6.0));
    CHECK(assigned.shared[0].radius == 4.0);
    CHECK(assigned.own.size() == 3);
    assign_radii(assigned, Eigen::VectorXd());
    CHECK(assigned.functions(0) == 0);
  }

  TEST_CASE("only finite positive radii and weights are usable") {
    CHECK(Supports{{{1.0, 1.0}}, {{0, {2.0, 3.0}}}}.are_usable());
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {0.0, -1.0, infinity, -infinity, std::nan(""), 1e101}) {
      CHECK_FALSE(Supports{{{bad, 1.0}}, {}}.are_usable());
      CHECK_FALSE(Supports{{{1.0, bad}}, {}}.are_usable());
      CHECK_FALSE(Supports{{{1.0, 1.0}}, {{0, {bad, 1.0}}}}.are_usable());
      CHECK_FALSE(Supports{{{1.0, 1.0}}, {{0, {1.0, bad}}}}.are_usable());
    }
  }
}

} // namespace supports_test
