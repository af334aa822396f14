#include <nendo/deform/injective_chain.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace injective_chain_test {

using namespace nendo::deform;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using nendo::test::random_points;

TEST_SUITE("injective chain") {
  constexpr double radius = 4.0;
  constexpr double infinity = std::numeric_limits<double>::infinity();

  static VectorXd radii(Eigen::Index count) {
    return VectorXd::Constant(count, radius);
  }

  static InjectiveChain grabbed(const Points& starts, InjectiveOptions options = {},
                                CsrbfOptions csrbf = {}) {
    InjectiveChain chain(starts.cols(), one_radius(radius), csrbf, options);
    REQUIRE(is_solved(chain.grab(starts)));
    return chain;
  }

  static Points applied(InjectiveChain & chain, Points shape) {
    while (chain.next())
      displace(chain.field(), shape, shape);
    return shape;
  }

  static Points applied_from_start(InjectiveChain & chain, const Points& ends,
                                   const Points& shape) {
    chain.from_start(ends);
    return applied(chain, shape);
  }

  /// Of x + s(x), by differences of displacements alone.
  static double determinant(const CsrbfField& field, const Vector3d& x) {
    constexpr double step = 1e-5;
    Matrix3d jacobian = Matrix3d::Identity();
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d by = step * Vector3d::Unit(axis);
      jacobian.col(axis) +=
          (field.displacement_at(x + by) - field.displacement_at(x - by)) / (2.0 * step);
    }
    return jacobian.determinant();
  }

  static double min_determinant(const CsrbfField& field, const Points& places) {
    double least = infinity;
    for (Eigen::Index i = 0; i < places.cols(); ++i)
      least = std::min(least, determinant(field, places.col(i)));
    return least;
  }

  static CsrbfField one_shot(const Points& starts, const Points& ends, CsrbfOptions csrbf = {}) {
    CsrbfSolver solver(csrbf);
    CsrbfField field;
    REQUIRE(is_solved(solver.build(starts, radii(starts.cols()))));
    REQUIRE(is_solved(solver.solve(ends - starts, field)));
    return field;
  }

  TEST_CASE("no link of a violent stroke folds anywhere, while one shot does") {
    std::mt19937 random(61);
    int folded_at_once = 0;
    for (const Wendland kernel : {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6})
      for (int stroke = 0; stroke < 8; ++stroke) {
        const Points starts = random_points(random, 10, 1.5 * radius);
        const Points ends = starts + random_points(random, 10, radius);
        if (min_determinant(one_shot(starts, ends, {kernel}),
                            random_points(random, 400, 2.0 * radius)) < 0)
          ++folded_at_once;
        InjectiveChain chain = grabbed(starts, {.max_links = 1000}, {kernel});
        Points places = random_points(random, 400, 2.0 * radius);
        REQUIRE(is_solved(chain.from_start(ends)));
        while (chain.next()) {
          CHECK(min_determinant(chain.field(), places) > 1e-3 * (1.0 - 1e-3)); // (1 - 0.9)^3
          displace(chain.field(), places, places);
        }
        CHECK(chain.report().reached);
        CHECK(chain.report().bound <= 0.9 * (1.0 + 1e-12));
        CHECK(chain.report().whole_bound > 0.9);
        CHECK(chain.report().min_determinant > 0.0);
      }
    CHECK(folded_at_once >= 24); // of 32
  }

  TEST_CASE("the ends are reached where no point is held") {
    std::mt19937 random(62);
    int free = 0;
    for (int stroke = 0; stroke < 20; ++stroke) {
      const Points starts = random_points(random, 6, 2.0 * radius);
      const Points ends = starts + random_points(random, 6, radius);
      InjectiveChain chain = grabbed(starts);
      const Points end = applied_from_start(chain, ends, starts);
      CHECK(chain.report().reached);
      if (chain.report().held_pairs > 0) continue;
      ++free;
      CHECK(chain.report().links > 1);
      CHECK(chain.places() == ends);
      CHECK((end - ends).cwiseAbs().maxCoeff() < 1e-6);
    }
    CHECK(free > 10);
  }

  TEST_CASE("what is short enough is one link, the plain solve bit for bit") {
    std::mt19937 random(63);
    const Points starts = random_points(random, 10, 2.0 * radius);
    const Points ends = starts + random_points(random, 10, 0.05);
    const Points shape = random_points(random, 300, 2.0 * radius);
    for (const Polynomial polynomial : {Polynomial::none, Polynomial::linear}) {
      InjectiveChain chain = grabbed(starts, {}, {.polynomial = polynomial});
      Points plain;
      displace(one_shot(starts, ends, {.polynomial = polynomial}), shape, plain);
      CHECK(applied_from_start(chain, ends, shape) == plain);
      CHECK(chain.report().links == 1);
      CHECK(chain.report().bound == chain.report().whole_bound);
    }
    InjectiveChain chain = grabbed(starts);
    CHECK(applied_from_start(chain, starts, shape) == shape);
    CHECK(chain.report().links == 0);
    CHECK(chain.report().min_determinant == 1.0);
  }

  TEST_CASE("a mirrored stroke gives the mirrored shape") {
    std::mt19937 random(64);
    const Vector3d mirror(-1, 1, 1);
    const Points starts = random_points(random, 10, radius);
    const Points ends = starts + random_points(random, 10, radius);
    const Points shape = random_points(random, 200, 2.0 * radius);
    InjectiveChain chain = grabbed(starts);
    InjectiveChain mirrored = grabbed(mirror.asDiagonal() * starts);
    const Points there = applied_from_start(chain, ends, shape);
    const Points here =
        applied_from_start(mirrored, mirror.asDiagonal() * ends, mirror.asDiagonal() * shape);
    CHECK(chain.report().links > 2);
    CHECK((here - mirror.asDiagonal() * there).cwiseAbs().maxCoeff() < 1e-9);
  }

  TEST_CASE("fingers that cross are held at the gap, and nothing folds") {
    std::mt19937 random(65);
    int held = 0;
    for (int stroke = 0; stroke < 40; ++stroke) {
      const Points starts = random_points(random, 5, 0.5 * radius);
      // Each to about where another was, the first two head on.
      Points ends = 0.02 * random_points(random, 5, radius);
      for (Eigen::Index i = 0; i < 5; ++i)
        ends.col(i) += starts.col(i < 2 ? 1 - i : 2 + (i - 1) % 3);
      ends.leftCols<2>() << starts.col(1), starts.col(0);
      InjectiveChain chain = grabbed(starts, {.max_links = 1000});
      Points places = random_points(random, 100, radius);
      chain.from_start(ends);
      while (chain.next()) {
        CHECK(min_determinant(chain.field(), places) > 0.9e-3);
        displace(chain.field(), places, places);
      }
      CHECK(chain.report().reached);
      CHECK(chain.report().held_pairs >= 1);
      held += chain.report().held_pairs;
      const double gap = std::min(0.05 * radius, 0.5 * (starts.col(0) - starts.col(1)).norm());
      CHECK((chain.places().col(0) - chain.places().col(1)).norm() > gap * (1.0 - 1e-3));
    }
    CHECK(held > 40);
  }

  /// The largest change of a shape while two fingers' ends go from `from` to `to` in so many steps.
  static double largest_change(const Points& starts, const Points& from, const Points& to,
                               int steps, bool& free, bool& held) {
    const Points shape = nendo::test::sphere(6, 8, 0.5 * radius).vertices;
    InjectiveChain chain = grabbed(starts);
    Points last;
    double largest = 0.0;
    for (int step = 0; step <= steps; ++step) {
      const double part = static_cast<double>(step) / steps;
      const Points now = applied_from_start(chain, from + part * (to - from), shape);
      (chain.report().held_pairs > 0 ? held : free) = true;
      if (last.cols() > 0) largest = std::max(largest, (now - last).cwiseAbs().maxCoeff());
      last = now;
    }
    return largest;
  }

  TEST_CASE("the shape does not jump when a pair begins or ceases to be held") {
    Points starts(3, 3);
    starts << -1.5, 1.5, 0.0, 0.0, 0.1, 1.0, 0.2, 0.0, 0.3;
    Points through = starts; // the first two change places
    through.leftCols<2>() << starts.col(1), starts.col(0);
    Points past = through; // or pass each other
    past(1, 0) += 1.0;
    for (const auto& [from, to] : {std::pair{starts, through}, std::pair{through, past}}) {
      bool free = false;
      bool held = false;
      const double coarse = largest_change(starts, from, to, 100, free, held);
      const double fine = largest_change(starts, from, to, 400, free, held);
      CHECK(free);
      CHECK(held);
      CHECK(fine < 0.3 * coarse);
    }
  }

  TEST_CASE("a stroke continues from where it is, and a pair that was held comes free") {
    Points starts(3, 2);
    starts << -1.5, 1.5, 0.0, 0.0, 0.0, 0.0;
    std::mt19937 random(66);
    const Points shape = random_points(random, 100, radius);
    InjectiveChain chain = grabbed(starts);
    Points current = shape;
    Points tips = starts;
    int held = 0;
    for (int tick = 1; tick <= 200; ++tick) {
      tips(0, 0) = -1.5 + 2.5 * std::sin(tick * 0.01 * 3.14159265358979);
      tips(1, 0) = 0.3 * std::sin(tick * 0.02 * 3.14159265358979);
      CHECK(is_solved(chain.from_here(tips)));
      while (chain.next()) {
        CHECK(min_determinant(chain.field(), current) > 0.9e-3);
        displace(chain.field(), current, current);
      }
      CHECK(chain.report().reached);
      if (chain.report().held_pairs > 0)
        ++held;
      else
        CHECK(chain.places() == tips);
    }
    CHECK(held == 0); // they come near, but not to the gap
    tips(0, 0) = 2.0;
    tips(1, 0) = 0.0;
    chain.from_here(tips);
    applied(chain, current);
    CHECK(chain.report().held_pairs == 1);
    CHECK(chain.places() != tips);
    chain.from_here(starts);
    applied(chain, current);
    CHECK(chain.report().held_pairs == 0);
    CHECK((chain.places() - starts).norm() < 1e-12);
  }

  TEST_CASE("start points that share their displacements neither fold nor exceed the bound") {
    std::mt19937 random(67);
    for (const double apart : {0.0, 1e-9, 0.01, 0.1}) {
      Points starts = random_points(random, 6, radius);
      starts.col(1) = starts.col(0) + Vector3d(apart, 0, 0);
      const Points ends = starts + random_points(random, 6, radius);
      InjectiveChain chain = grabbed(starts, {.max_links = 1000}, {.merge_fraction = 0.05});
      Points places = random_points(random, 200, radius);
      places.leftCols<6>() = starts;
      bool merged = false;
      chain.from_start(ends);
      while (chain.next()) {
        merged = merged || chain.report().status == FieldStatus::merged;
        CHECK(min_determinant(chain.field(), places) > 0.9e-3);
        displace(chain.field(), places, places);
      }
      CHECK(merged);
      CHECK(chain.report().reached);
      CHECK(chain.report().bound <= 0.9 * (1.0 + 1e-12));
      CHECK((places.col(0) - places.col(1)).norm() >= 0.0);
      CHECK((places.col(4) - ends.col(4)).norm() < 1e-6);
    }
  }

  TEST_CASE("a call makes no more links than it may, and the next one continues") {
    std::mt19937 random(68);
    const Points starts = random_points(random, 10, 2.0 * radius);
    const Points ends = starts + random_points(random, 10, radius);
    const Points shape = random_points(random, 100, radius);
    InjectiveChain chain = grabbed(starts, {.max_links = 1000});
    const Points whole = applied_from_start(chain, ends, shape);
    const int links = chain.report().links;
    REQUIRE(links > 4);
    InjectiveChain slow = grabbed(starts, {.max_links = 2});
    Points current = shape;
    int calls = 0;
    do {
      REQUIRE(is_solved(slow.from_here(ends)));
      current = applied(slow, current);
      CHECK(slow.report().links <= 2);
      ++calls;
    } while (!slow.report().reached && calls < 1000);
    CHECK(calls == (links + 1) / 2);
    CHECK((current - whole).cwiseAbs().maxCoeff() < 1e-9);
    slow.from_start(ends);
    applied(slow, shape);
    CHECK_FALSE(slow.report().reached);
  }

  TEST_CASE("what is not finite is refused, and the shape stays as it was") {
    std::mt19937 random(69);
    const Points starts = random_points(random, 10, radius);
    const Points ends = starts + random_points(random, 10, radius);
    const Points shape = random_points(random, 100, radius);
    InjectiveChain chain(10, one_radius(radius), {}, {});
    CHECK(chain.from_start(ends) == FieldStatus::singular); // before the first grab
    CHECK_FALSE(chain.next());
    REQUIRE(is_solved(chain.grab(starts)));
    const Points good = applied_from_start(chain, ends, shape);
    for (const double bad : {std::nan(""), infinity, -1e300}) {
      Points spoilt = ends;
      spoilt(1, 3) = bad;
      CHECK(chain.from_start(spoilt) == FieldStatus::not_finite);
      CHECK(applied(chain, shape) == good);
      CHECK(chain.report().status == FieldStatus::not_finite);
      CHECK(chain.from_here(spoilt) == FieldStatus::not_finite);
      CHECK_FALSE(chain.next());
      CHECK(chain.grab(spoilt) == FieldStatus::not_finite);
      CHECK(applied_from_start(chain, ends, shape) == good);
    }
    for (const double far : {1e12, 1e50, 1e99}) {
      chain.from_start(far * ends);
      CHECK(applied(chain, shape).allFinite());
      CHECK_FALSE(chain.report().reached);
      CHECK(std::isfinite(chain.report().min_determinant));
    }
  }

  TEST_CASE("a chain does not allocate") {
    std::mt19937 random(70);
    const Points starts = random_points(random, 10, 0.5 * radius);
    Points ends = starts + random_points(random, 10, radius);
    ends.leftCols<2>() << starts.col(1), starts.col(0);
    Points shape = random_points(random, 100, radius);
    InjectiveChain chain(10, one_radius(radius), {}, {});
    ChainReport report;
    nendo::test::RestraintCounts counts;
    {
      const nendo::test::Restraint restraint;
      chain.grab(starts);
      chain.from_start(ends);
      while (chain.next())
        displace(chain.field(), shape, shape);
      report = chain.report();
      chain.from_here(starts);
      while (chain.next())
        displace(chain.field(), shape, shape);
      counts = restraint.counts();
    }
    CHECK(report.links > 2);
    CHECK(report.held_pairs > 0);
    CHECK(counts.allocations == 0);
    CHECK(counts.locks == 0);
  }

  TEST_CASE("with a radius of its own for each finger nothing folds either, nor allocates") {
    std::mt19937 random(71);
    const Points starts = random_points(random, 10, radius);
    std::vector<OwnSupport> own;
    for (Eigen::Index i = 0; i < 10; ++i)
      own.push_back({i, {radius * (0.5 + 0.25 * static_cast<double>(i % 5)), 1.0}});
    InjectiveChain chain(10, with_common(own), {}, {.max_links = 1000});
    const Points dense = random_points(random, 300, 2.0 * radius);
    for (int stroke = 0; stroke < 10; ++stroke) {
      const Points ends = starts + random_points(random, 10, radius);
      Points shape = dense;
      DeterminantProbe probe;
      probe.start(dense);
      nendo::test::RestraintCounts counts;
      {
        const nendo::test::Restraint restraint;
        chain.grab(starts);
        chain.from_start(ends);
        while (chain.next()) {
          probe.advance(chain.field());
          displace(chain.field(), shape, shape);
        }
        counts = restraint.counts();
      }
      CHECK(counts.allocations == 0);
      CHECK(chain.report().reached);
      CHECK(chain.report().bound <= 0.9 + 1e-12);
      CHECK(probe.min_determinant() > 0.0);
      if (chain.report().held_pairs == 0) CHECK((chain.places() - ends).norm() < 1e-9);
    }
  }
}

} // namespace injective_chain_test
