#include "bench/deform_trial.hpp"

#include <algorithm>
#include <vector>

#include <nendo/deform/type1.hpp>

#include "bench/deform_frames.hpp"
#include "bench/plain_deformer.hpp"
#include "field/block_evaluator.hpp"
#include "reference/table1.hpp"

namespace nendo::bench {
namespace {

using namespace nendo::deform;

/// What is measured side by side, the hands holding the mesh.
struct Deformers {
  Deformers(const Points& mesh, const Points& starts, double radius)
      : type1(mesh, 10, {one_radius(radius)}),
        evaluated1(mesh, 10, {one_radius(radius), {}, {.weight_bytes = 0}}),
        type2(mesh, starts, radius) {
    type1.grab(starts);
    evaluated1.grab(starts);
  }

  Type1Deformer type1;
  Type1Deformer evaluated1;
  Strokes type2;
  BlockShape out; ///< type1's
  BlockShape other;
};

double apart_from_double(Type1Deformer& deformer, const Points& ends) {
  BlockShape shape;
  Points in_blocks;
  Points in_double;
  deformer.apply(ends, shape);
  deformer.layout().unpack(shape, in_blocks);
  displace(deformer.fields().fields().front(), deformer.layout().original(), in_double);
  return (in_blocks - in_double).colwise().norm().maxCoeff() / deformer.layout().diagonal();
}

/// The second thread spins as long as its deformer lives, so that nothing else is measured then.
void measure_two_threads(const Points& mesh, double radius, int repetitions, CellTimes& times) {
  const Points starts = reference::table1_starts();
  const auto ends = random_ends(starts);
  const auto vertices = static_cast<std::size_t>(mesh.cols());
  Best best1;
  Best best2;
  {
    Type1Deformer type1(mesh, 10, {one_radius(radius), {}, {.threads = 2}});
    type1.grab(starts);
    BlockShape out;
    for (int n = 0; n < repetitions; ++n)
      best1.measure(vertices, [&](std::size_t k) { type1.apply(ends[k % poses], out); });
  }
  Strokes type2(mesh, starts, radius, 2);
  for (int n = 0; n < repetitions; ++n)
    type2.measure(best2);
  times.type1_2threads_us = best1.us();
  times.type2_2threads_us = best2.us();
}

} // namespace

CellTimes measure_cell(const Points& mesh, double radius, int repetitions) {
  const Points starts = reference::table1_starts();
  const auto ends = random_ends(starts);
  const auto vertices = static_cast<std::size_t>(mesh.cols());
  PlainDeformer plain1(mesh, starts, radius);
  PlainDeformer plain2(mesh, starts, radius);
  Deformers deformers(mesh, starts, radius);
  CellTimes times;
  times.apart = apart_from_double(deformers.type1, ends[0]);
  times.weight_bytes = deformers.type1.weight_bytes();
  Best p1, p2, t1, e1, t2, grab;
  for (int n = 0; n < repetitions; ++n) {
    if (can_run_plain()) {
      p1.measure(vertices, [&](std::size_t k) { plain1.type1(ends[k % poses]); });
      p2.measure(vertices, [&](std::size_t k) { plain2.stroke(ends, k); });
    }
    t1.measure(vertices,
               [&](std::size_t k) { deformers.type1.apply(ends[k % poses], deformers.out); });
    e1.measure(vertices, [&](std::size_t k) {
      deformers.evaluated1.apply(ends[k % poses], deformers.other);
    });
    deformers.type2.measure(t2);
    if (n % 8 == 0) grab.measure(vertices, [&](std::size_t) { deformers.type1.grab(starts); });
  }
  times.plain1_us = p1.us();
  times.plain2_us = p2.us();
  times.type1_us = t1.us();
  times.evaluated1_us = e1.us();
  times.type2_us = t2.us();
  times.grab_us = grab.us();
  measure_two_threads(mesh, radius, repetitions, times);
  return times;
}

namespace {

/// Ten supports over a plane of 289 vertices, which all of them contain.
double ns_an_influence(int repetitions) {
  const Points mesh = reference::table1_plane(16);
  const Points starts = reference::spread_starts();
  const auto ends = random_ends(starts);
  Type1Deformer deformer(mesh, 10, {one_radius(200.0), {}, {.weight_bytes = 0}});
  const BlockLayout& layout = deformer.layout();
  BoundedShape rest(layout.pack());
  BlockShape out = rest.shape;
  BlockEvaluator evaluator(layout, 10, {});
  CsrbfField field;
  field.centres = starts;
  field.radii = Eigen::VectorXd::Constant(10, 200.0);
  field.coefficients = ends[0] - starts;
  evaluator.set_field(field);
  Best best;
  for (int n = 0; n < repetitions; ++n)
    best.measure(1000, [&](std::size_t) { evaluator.displace(rest, out); });
  return 1e3 * best.us() / static_cast<double>(10 * layout.block_count() * block_size);
}

} // namespace

LargeTimes measure_large(int cells, int repetitions) {
  const double radius = 10.0;
  const Points mesh = reference::table1_plane(cells);
  const Points starts = reference::spread_starts();
  const auto ends = random_ends(starts);
  LargeTimes times;
  times.vertices = static_cast<std::size_t>(mesh.cols());
  times.influences = reference::count_evaluations(mesh, starts, radius);
  Deformers deformers(mesh, starts, radius);
  deformers.evaluated1.apply(ends[0], deformers.other);
  std::size_t reached = 0;
  for (std::size_t block = 0; block < deformers.other.block_count(); ++block)
    reached += deformers.other.stamp(block) != deformers.evaluated1.rest().stamp(block) ? 1U : 0U;
  times.reached = reached * block_size;
  std::vector<VertexBlock> from(reached);
  std::vector<VertexBlock> to(reached);
  Best t1, e1, t2, memory;
  for (int n = 0; n < repetitions; ++n) {
    t1.measure(times.vertices,
               [&](std::size_t k) { deformers.type1.apply(ends[k % poses], deformers.out); });
    e1.measure(times.vertices, [&](std::size_t k) {
      deformers.evaluated1.apply(ends[k % poses], deformers.other);
    });
    deformers.type2.measure(t2);
    memory.measure(times.vertices, [&](std::size_t k) {
      from[0].x[0] = static_cast<float>(k);
      std::copy(from.begin(), from.end(), to.begin());
    });
  }
  times.type1_us = t1.us();
  times.evaluated1_us = e1.us();
  times.type2_us = t2.us();
  times.memory_us = memory.us();
  times.arithmetic_us =
      1e-3 * ns_an_influence(4 * repetitions) * static_cast<double>(times.influences);
  return times;
}

namespace {

double ns_of_volume(const Points& mesh, const Points& starts, double radius, double keep_volume,
                    int repetitions) {
  const BlockLayout layout(mesh);
  const BoundedShape rest(layout.pack());
  BlockShape out = rest.shape;
  BlockEvaluator evaluator(layout, starts.cols(), {});
  CsrbfField field;
  field.keep_volume = keep_volume;
  field.centres = starts;
  field.radii = Eigen::VectorXd::Constant(starts.cols(), radius);
  field.coefficients = Points::Constant(3, starts.cols(), 0.01 * radius);
  evaluator.set_field(field);
  Best best;
  for (int n = 0; n < repetitions; ++n)
    best.measure(layout.vertex_count(), [&](std::size_t) { evaluator.displace(rest, out); });
  return 1e3 * best.us() /
         static_cast<double>(static_cast<std::size_t>(starts.cols()) * layout.vertex_count());
}

double us_of_type1(const Points& mesh, const Points& starts, const Points& way, double radius,
                   double keep_volume, std::size_t weight_bytes, int repetitions) {
  Type1Deformer deformer(
      mesh, starts.cols(),
      {one_radius(radius), {.keep_volume = keep_volume}, {.weight_bytes = weight_bytes}});
  BlockShape out = deformer.rest();
  deformer.grab(starts);
  Best best;
  for (int n = 0; n < repetitions; ++n)
    best.measure(static_cast<std::size_t>(mesh.cols()), [&](std::size_t k) {
      deformer.apply(starts + (1.0 - 0.01 * static_cast<double>(k % 10)) * way, out);
    });
  return best.us();
}

/// Back and forth, a piece a call.
double us_of_type2(const Points& mesh, const Points& starts, const Points& way, double radius,
                   double keep_volume, int repetitions) {
  const double longest = std::sqrt(way.colwise().squaredNorm().maxCoeff());
  const double piece = radius / 20.0;
  Type2Deformer deformer(mesh, starts.cols(), piece,
                         {one_radius(radius), {.keep_volume = keep_volume}});
  deformer.begin(starts);
  Best best;
  std::size_t step = 0;
  for (int n = 0; n < repetitions; ++n)
    best.measure(static_cast<std::size_t>(mesh.cols()), [&](std::size_t) {
      deformer.end_at(starts + (++step % 2 == 0 ? 0.0 : piece / longest) * way);
    });
  return best.us();
}

} // namespace

VolumeTimes measure_volume(int cells, int repetitions) {
  const Points mesh = reference::table1_plane(cells);
  const Points starts = reference::spread_starts();
  const double radius = 200.0; // the plane's is 50
  Points way(3, starts.cols());
  way.colwise() = radius / 3.0 * Eigen::Vector3d(0.6, 0.0, -0.8);
  VolumeTimes times;
  times.vertices = static_cast<std::size_t>(mesh.cols());
  times.air_ns = ns_of_volume(mesh, starts, radius, 0.0, repetitions);
  times.between_ns = ns_of_volume(mesh, starts, radius, 0.5, repetitions);
  times.clay_ns = ns_of_volume(mesh, starts, radius, 1.0, repetitions);
  const std::size_t weights = deform::EvaluationOptions{}.weight_bytes;
  times.type1_us = us_of_type1(mesh, starts, way, radius, 0.0, weights, repetitions);
  times.evaluated1_us = us_of_type1(mesh, starts, way, radius, 0.0, 0, repetitions);
  times.type1_clay_us = us_of_type1(mesh, starts, way, radius, 1.0, 0, repetitions);
  times.type2_us = us_of_type2(mesh, starts, way, radius, 0.0, repetitions);
  times.type2_clay_us = us_of_type2(mesh, starts, way, radius, 1.0, repetitions);
  return times;
}

} // namespace nendo::bench
