// nendo bench solve: how long it takes to find the field of ten fingertips, and of thousands of
// control vectors by each order of elimination, beside a dense elimination.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/deform/csrbf.hpp>

#include "bench/bench.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"
#include "reference/bumpy_sheet.hpp"
#include "solver/solver_choices.hpp"

namespace nendo::bench::solve_bench {
namespace {

using namespace nendo::deform;

struct Options {
  std::uint64_t points = 0;
  std::uint64_t neighbours = 26;
  std::uint64_t rounds = 5;
  bool json = false;
};

/// Dense elimination, and one in no order, of more points than that would take minutes.
constexpr std::uint64_t max_slow_points = 2000;

template <class Work>
double seconds_of(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  return took.count();
}

struct Ten {
  double build_us = std::numeric_limits<double>::infinity();
  double solve_us = std::numeric_limits<double>::infinity();
};

/// Two hands' fingertips above a plane of 50 by 50, in 64 poses; the best of many rounds.
Ten measure_ten(const Eigen::VectorXd& radii, std::uint64_t rounds) {
  std::mt19937 random(1);
  std::normal_distribution<double> tremble(0.0, 1.0);
  std::vector<Points> poses;
  for (int pose = 0; pose < 64; ++pose) {
    Points& tips = poses.emplace_back(3, 10);
    for (Eigen::Index i = 0; i < 10; ++i) {
      const Eigen::Index row = i / 5;
      tips.col(i) << -15.0 + 20.0 * static_cast<double>(i % 5) + tremble(random),
          15.0 + 20.0 * static_cast<double>(row) + tremble(random), 2.0 + tremble(random);
    }
  }
  CsrbfSolver solver({.merge_fraction = 0.05});
  CsrbfField field;
  Ten best;
  const double each_us = 1e6 / static_cast<double>(poses.size());
  for (std::uint64_t round = 0; round < 50 * rounds; ++round) {
    best.build_us = std::min(best.build_us, each_us * seconds_of([&] {
                                              for (const Points& tips : poses)
                                                solver.build(tips, radii);
                                            }));
    best.solve_us = std::min(best.solve_us, each_us * seconds_of([&] {
                                              for (const Points& tips : poses)
                                                solver.solve(tips, field);
                                            }));
  }
  return best;
}

struct Method {
  const char* name;
  Storage storage;
  PointOrder order;
};
constexpr Method methods[] = {
    {"no order", Storage::sparse, PointOrder::as_given},
    {"octree", Storage::sparse, PointOrder::octree},
    {"minimum degree", Storage::sparse, PointOrder::minimum_degree},
    {"dense", Storage::dense, PointOrder::as_given},
};

struct Measured {
  std::string method;
  SolverEffort effort{};
  double build_s = std::numeric_limits<double>::infinity();
  double solve_s = std::numeric_limits<double>::infinity();
};

/// The best round of each, with the pieces of that round.
Measured measure(const Method& method, const Points& starts, double radius, std::uint64_t rounds) {
  CsrbfSolver solver = solver_with({}, {.order = method.order, .storage = method.storage});
  const Supports supports = one_radius(radius);
  CsrbfField field;
  Measured best{.method = method.name};
  for (std::uint64_t round = 0; round < rounds; ++round) {
    const double build_s = seconds_of([&] { solver.build(starts, supports); });
    best.solve_s = std::min(best.solve_s, seconds_of([&] { solver.solve(starts, field); }));
    if (build_s >= best.build_s) continue;
    best.build_s = build_s;
    best.effort = solver.effort();
  }
  return best;
}

void print_ten(const Ten& one, const Ten& several, bool json) {
  if (json) {
    cli::print_line({{"points", 10},
                     {"build_us", one.build_us},
                     {"solve_us", one.solve_us},
                     {"several_radii_build_us", several.build_us},
                     {"several_radii_solve_us", several.solve_us}});
    return;
  }
  cli::print("ten fingertips: assembly and factor {:.2f} us, each solution {:.2f} us; with a "
             "radius per finger {:.2f} and {:.2f} us\n",
             one.build_us, one.solve_us, several.build_us, several.solve_us);
}

void print_json(std::uint64_t points, std::uint64_t neighbours, const Measured& one) {
  cli::print_line({{"points", points},
                   {"neighbours", neighbours},
                   {"method", one.method},
                   {"build_ms", 1e3 * one.build_s},
                   {"order_ms", 1e3 * one.effort.order_s},
                   {"assembly_ms", 1e3 * one.effort.assembly_s},
                   {"analysis_ms", 1e3 * one.effort.analysis_s},
                   {"factor_ms", 1e3 * one.effort.factor_s},
                   {"solve_ms", 1e3 * one.solve_s},
                   {"matrix_entries", one.effort.matrix_entries},
                   {"factor_entries", one.effort.factor_entries}});
}

void print_text(std::uint64_t points, std::uint64_t neighbours,
                const std::vector<Measured>& measured) {
  cli::print("\n{} control vectors with {} in reach of each; in ms\n", points, neighbours);
  cli::print("{:15} {:>8} {:>9} {:>9} {:>9} {:>9} {:>8} {:>15} {:>6}\n", "", "octree", "assembly",
             "analysis", "factor", "all", "solve", "factor entries", "fill");
  const auto best =
      std::min_element(measured.begin(), measured.end(),
                       [](const Measured& a, const Measured& b) { return a.build_s < b.build_s; });
  for (const Measured& one : measured) {
    const SolverEffort& effort = one.effort;
    cli::print("{:15} {:8.2f} {:9.2f} {:9.2f} {:9.2f} {:9.2f} {:8.2f} {:15} {:6.1f}\n", one.method,
               1e3 * effort.order_s, 1e3 * effort.assembly_s, 1e3 * effort.analysis_s,
               1e3 * effort.factor_s, 1e3 * one.build_s, 1e3 * one.solve_s, effort.factor_entries,
               static_cast<double>(effort.factor_entries) /
                   static_cast<double>(effort.matrix_entries));
  }
  for (const Measured& one : measured)
    if (&one != &*best)
      cli::print("{} takes {:.1f} times as long as {}\n", one.method, one.build_s / best->build_s,
                 best->method);
}

void measure_many(std::uint64_t points, const Options& options) {
  std::mt19937 random(2);
  const Points starts = reference::bumpy_sheet(random, static_cast<Eigen::Index>(points));
  const double radius = std::sqrt(static_cast<double>(options.neighbours) /
                                  (std::numbers::pi * static_cast<double>(points)));
  std::vector<Measured> measured;
  for (const Method& method : methods) {
    const bool slow = method.order == PointOrder::as_given;
    if (slow && points > max_slow_points) continue;
    measured.push_back(measure(method, starts, radius, options.rounds));
    if (options.json) print_json(points, options.neighbours, measured.back());
  }
  if (!options.json) print_text(points, options.neighbours, measured);
}

int bench_solve(const Options& options) {
  const auto complain = [](const char* what) { return cli::report({Errc::usage, what}); };
  if (options.points > 100'000) return complain("--points: use at most 100000");
  if (options.neighbours == 0 || options.neighbours > 1000)
    return complain("--neighbours: use 1 to 1000");
  if (options.rounds == 0 || options.rounds > 1000) return complain("--rounds: use 1 to 1000");
  const Ten one = measure_ten(Eigen::VectorXd::Constant(10, 40.0), options.rounds);
  const Ten several = measure_ten(Eigen::VectorXd::LinSpaced(10, 20.0, 60.0), options.rounds);
  print_ten(one, several, options.json);
  if (options.points > 0) {
    measure_many(options.points, options);
  } else {
    measure_many(1000, options);
    measure_many(10'000, options);
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::solve_bench

void nendo::bench::add_solve(cli::Command& bench) {
  using namespace solve_bench;
  cli::Command command = bench.add_command(
      "solve",
      "Measures the solve for the field of ten fingertips, and of thousands of control vectors");
  Options& options = command.on_chosen<Options>(bench_solve);
  command.add_option("--points", options.points,
                     "Number of control vectors, in place of 1000 and then 10000");
  command.add_option("--neighbours", options.neighbours,
                     "Number of control vectors in reach of each");
  command.add_option("--rounds", options.rounds, "Number of rounds, of which the best counts");
  command.add_flag("--json", options.json, "One JSON object per line");
}
