#include "bench/scale_trial.hpp"

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include <unistd.h>

#include <nendo/deform/type1.hpp>

#include "bench/deform_frames.hpp"
#include "field/block_evaluator.hpp"
#include "reference/table1.hpp"

namespace nendo::bench {
namespace {

using namespace nendo::deform;

std::size_t resident_bytes() {
  std::size_t all = 0;
  std::size_t resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

/// Of which `overlap` reach a place within, on average.
double radius_for(double overlap, std::size_t centres) {
  constexpr double area = 50.0 * 50.0;
  return std::sqrt(overlap * area / (std::numbers::pi * static_cast<double>(centres)));
}

} // namespace

GrowthTimes measure_growth(int cells, int repetitions) {
  const Points mesh = reference::table1_plane(cells);
  const Points starts = reference::spread_starts();
  const double radius = 10.0;
  const auto ends = random_ends(starts);
  GrowthTimes times;
  times.vertices = static_cast<std::size_t>(mesh.cols());
  times.influences = reference::count_evaluations(mesh, starts, radius);
  {
    const std::size_t before = resident_bytes();
    Type1Deformer type1(mesh, 10, {one_radius(radius), {}, {.weight_bytes = 0}});
    BlockShape out;
    type1.grab(starts);
    type1.apply(ends[0], out);
    times.type1_bytes = resident_bytes() - before;
    BestOfThread best;
    for (int n = 0; n < repetitions; ++n)
      best.measure(times.vertices, [&](std::size_t k) { type1.apply(ends[k % poses], out); });
    times.type1_us = best.us();
  }
  {
    const std::size_t before = resident_bytes();
    Type2Deformer type2(mesh, 10, one_piece, {one_radius(radius)});
    type2.begin(starts);
    type2.end_at(ends[0]);
    times.type2_bytes = resident_bytes() - before;
  }
  Strokes type2(mesh, starts, radius);
  BestOfThread best;
  for (int n = 0; n < repetitions; ++n)
    type2.measure(best);
  times.type2_us = best.us();
  return times;
}

CrowdTimes measure_crowd(int cells, std::size_t centres, double overlap, int repetitions) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 50.0);
  std::normal_distribution<double> move(0.0, 0.1);
  const double radius = radius_for(overlap, centres);
  Points starts(3, static_cast<Eigen::Index>(centres));
  Points moves(3, starts.cols());
  for (Eigen::Index i = 0; i < starts.cols(); ++i) {
    starts.col(i) << place(random), place(random), 0.0;
    moves.col(i) << move(random), move(random), move(random);
  }
  const Points mesh = reference::table1_plane(cells);
  const BlockLayout layout(mesh);
  const BoundedShape rest(layout.pack());
  BlockShape out = rest.shape;
  BlockEvaluator evaluator(layout, starts.cols(), {});
  CsrbfSolver solver({.merge_fraction = 0.05});
  CsrbfField field;
  const Eigen::VectorXd radii = Eigen::VectorXd::Constant(starts.cols(), radius);

  CsrbfField ten;
  ten.centres = reference::spread_starts();
  ten.radii = Eigen::VectorXd::Constant(10, 80.0);
  ten.coefficients = random_ends(ten.centres)[0] - ten.centres;

  CrowdTimes times{.vertices = layout.vertex_count(),
                   .centres = centres,
                   .influences = reference::count_evaluations(mesh, starts, radius)};
  BestOfThread build, solve, list, evaluate, by_ten;
  for (int n = 0; n < repetitions; ++n) {
    build.measure(times.vertices, [&](std::size_t) { solver.build(starts, radii); });
    solve.measure(times.vertices, [&](std::size_t) { solver.solve(moves, field); });
    evaluator.set_field(field);
    std::size_t pairs = 0;
    list.measure(times.vertices, [&](std::size_t) { pairs += evaluator.count_pairs(rest); });
    evaluate.measure(times.vertices, [&](std::size_t) { evaluator.displace(rest, out); });
    evaluator.set_field(ten);
    by_ten.measure(times.vertices, [&](std::size_t) { evaluator.displace(rest, out); });
  }
  times.build_us = build.us();
  times.solve_us = solve.us();
  times.list_us = list.us();
  times.evaluate_us = evaluate.us();
  times.ten_ns = 1e3 * by_ten.us() / static_cast<double>(10 * times.vertices);
  return times;
}

} // namespace nendo::bench
