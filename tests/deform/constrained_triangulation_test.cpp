#include "geometry/constrained_triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include <doctest/doctest.h>

namespace constrained_triangulation_test {

using namespace nendo::deform;
using Triangles = std::vector<ConstrainedTriangulation::Triangle>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

double area_of(const ConstrainedTriangulation& plane, const Triangles& triangles) {
  double twice = 0.0;
  for (const auto& t : triangles) {
    const PlanePoint &a = plane.point(t[0]), &b = plane.point(t[1]), &c = plane.point(t[2]);
    twice += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  }
  return twice / 2.0;
}

std::map<Edge, std::uint32_t> apexes_of(const Triangles& triangles) {
  std::map<Edge, std::uint32_t> apex;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      REQUIRE(apex.try_emplace({t[k], t[(k + 1) % 3]}, t[(k + 2) % 3]).second);
  return apex;
}

/// Each edge that is no segment passes Delaunay's test; each triangle turns to the left.
void check_delaunay(const ConstrainedTriangulation& plane, const Triangles& triangles,
                    const std::vector<Edge>& segments) {
  const auto apex = apexes_of(triangles);
  for (const auto& t : triangles)
    CHECK(orient_2d(plane.point(t[0]), plane.point(t[1]), plane.point(t[2])) == 1);
  for (const auto& [edge, here] : apex) {
    const Edge back{edge.second, edge.first};
    const auto there = apex.find(back);
    if (there == apex.end() || std::count(segments.begin(), segments.end(), edge) > 0 ||
        std::count(segments.begin(), segments.end(), back) > 0)
      continue;
    CHECK(in_circle(plane.point(edge.first), plane.point(edge.second), plane.point(here),
                    plane.point(there->second)) <= 0);
  }
  for (const auto& [from, to] : segments) {
    const bool there = apex.contains({from, to});
    CHECK((there || apex.contains({to, from})));
  }
}

std::vector<Edge> closed_loop(ConstrainedTriangulation& plane, std::uint32_t first,
                              std::uint32_t count) {
  std::vector<Edge> segments;
  for (std::uint32_t k = 0; k < count; ++k) {
    segments.push_back({first + k, first + (k + 1) % count});
    REQUIRE(plane.constrain(segments.back().first, segments.back().second) == PlaneFault::none);
  }
  return segments;
}

/// A star: its tips reach far beyond its dents, so many segments must be made by flips.
double add_star(ConstrainedTriangulation& plane, std::uint32_t tips, double radius, double dent) {
  for (std::uint32_t k = 0; k < 2 * tips; ++k) {
    const double turn = std::numbers::pi * k / tips;
    const double r = k % 2 == 0 ? radius : dent;
    REQUIRE(plane.add({r * std::cos(turn), r * std::sin(turn)}) == PlaneFault::none);
  }
  return tips * radius * dent * std::sin(std::numbers::pi / tips);
}

TEST_SUITE("constrained triangulation") {
  TEST_CASE("a star with a hole and points inside: its area, and Delaunay but for the segments") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
    for (const std::uint32_t tips : {3U, 7U, 40U, 200U}) {
      CAPTURE(tips);
      ConstrainedTriangulation plane({-1.0, -1.0}, {1.0, 1.0});
      double area = add_star(plane, tips, 1.0, 0.6);
      area -= add_star(plane, tips, 0.2, 0.1);
      std::vector<Edge> segments = closed_loop(plane, 0, 2 * tips);
      const std::vector<Edge> hole = closed_loop(plane, 2 * tips, 2 * tips);
      segments.insert(segments.end(), hole.begin(), hole.end());
      for (int k = 0; k < 300; ++k)
        REQUIRE(plane.add({coordinate(random), coordinate(random)}) == PlaneFault::none);
      plane.improve();
      const Triangles odd = plane.triangles(PlaneFill::odd);
      CHECK(area_of(plane, odd) == doctest::Approx(area).epsilon(1e-12));
      check_delaunay(plane, odd, segments);
      const Triangles enclosed = plane.triangles(PlaneFill::enclosed);
      CHECK(area_of(plane, enclosed) ==
            doctest::Approx(tips * 0.6 * std::sin(std::numbers::pi / tips)).epsilon(1e-12));
    }
  }

  TEST_CASE("points of a lattice, with four on each circle and many on each line") {
    ConstrainedTriangulation plane({0.0, 0.0}, {20.0, 20.0});
    for (int y = 0; y <= 20; ++y)
      for (int x = 0; x <= 20; ++x)
        REQUIRE(plane.add({1.0 * x, 1.0 * y}) == PlaneFault::none);
    const auto at = [](std::uint32_t x, std::uint32_t y) { return 21 * y + x; };
    std::vector<Edge> segments;
    for (std::uint32_t k = 0; k < 20; ++k)
      for (const Edge& edge : {Edge{at(k, 0), at(k + 1, 0)}, Edge{at(20, k), at(20, k + 1)},
                               Edge{at(k + 1, 20), at(k, 20)}, Edge{at(0, k + 1), at(0, k)}})
        segments.push_back(edge);
    segments.push_back({at(0, 1), at(20, 4)}); // crosses 20 columns, through no point
    for (const auto& [from, to] : segments) {
      if (from == at(0, 1) && to == at(20, 4)) continue;
      REQUIRE(plane.constrain(from, to) == PlaneFault::none);
    }
    CHECK(plane.constrain(at(0, 1), at(20, 4)) == PlaneFault::none);
    plane.improve();
    const Triangles inside = plane.triangles(PlaneFill::enclosed);
    CHECK(inside.size() == 800);
    CHECK(area_of(plane, inside) == 400.0);
    check_delaunay(plane, inside, segments);
    CHECK(plane.constrain(at(0, 0), at(7, 7)) == PlaneFault::on_point);
    CHECK(plane.constrain(at(1, 0), at(1, 9)) == PlaneFault::on_point);
    CHECK(plane.constrain(at(10, 0), at(11, 20)) == PlaneFault::crossing);
    CHECK(plane.add({3.0, 5.0}) == PlaneFault::same_point);
    CHECK(plane.add({0.5, 0.0}) == PlaneFault::on_segment);
    CHECK(plane.add({1e9, 0.0}) == PlaneFault::outside);
    CHECK(plane.triangles(PlaneFill::enclosed).size() == 800);
  }

  TEST_CASE("points within rounding of a line") {
    // Rims of cuts through flat faces are such chains.
    ConstrainedTriangulation plane({0.0, 0.0}, {1.0, 1.0});
    std::mt19937 random(5);
    std::uniform_real_distribution<double> along(0.0, 1.0);
    std::vector<double> places{0.0, 1.0};
    for (int k = 0; k < 200; ++k)
      places.push_back(along(random));
    std::sort(places.begin(), places.end());
    for (const double t : places)
      REQUIRE(plane.add({t / 3.0 + 0.1, t / 7.0 + 0.1}) == PlaneFault::none);
    REQUIRE(plane.add({0.2, 0.9}) == PlaneFault::none);
    const auto count = static_cast<std::uint32_t>(plane.point_count());
    const std::vector<Edge> segments = closed_loop(plane, 0, count);
    plane.improve();
    const Triangles inside = plane.triangles(PlaneFill::odd);
    CHECK(inside.size() == count - 2);
    check_delaunay(plane, inside, segments);
  }

  TEST_CASE("the same calls give the same triangles, and a random order the same area") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> coordinate(0.0, 1.0);
    std::vector<PlanePoint> points{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
    for (int k = 0; k < 2000; ++k)
      points.push_back({coordinate(random), coordinate(random)});
    const auto made = [&] {
      ConstrainedTriangulation plane({0.0, 0.0}, {1.0, 1.0});
      plane.reserve(points.size());
      for (const PlanePoint& point : points)
        REQUIRE(plane.add(point) == PlaneFault::none);
      closed_loop(plane, 0, 4);
      return plane.triangles(PlaneFill::odd);
    };
    const Triangles first = made();
    CHECK(first == made());
    CHECK(first.size() == 2 * (points.size() - 4) + 2);
  }
}

} // namespace constrained_triangulation_test
