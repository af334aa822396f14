#include "bench/deform_trial.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <random>
#include <vector>

#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>

#include "bench/plain_deform.hpp"
#include "bench/table1.hpp"

namespace nendo::app {
namespace {

using namespace nendo::deform;

constexpr std::size_t poses = 16; ///< different ones, so that nothing is learnt by heart
/// A stroke that end_at() applies in one piece, however long.
constexpr double one_piece = 1e9;

/// The best time of a block of frames, over repetitions that several measurements take in turn.
class Best {
public:
  /// frame(n) makes the n-th frame.
  template <class Frame>
  void measure(std::size_t vertices, const Frame& frame) {
    const std::size_t frames =
        std::clamp<std::size_t>(100'000 / std::max<std::size_t>(vertices, 1), 2, 64);
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t n = 0; n < frames; ++n)
      frame(n);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    us_ = std::min(us_, took.count() / static_cast<double>(frames));
  }
  double us() const noexcept { return us_ < 1e300 ? us_ : 0.0; }

private:
  double us_ = 1e300;
};

bool can_run_plain() noexcept {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return true;
#endif
}

struct Arrays {
  explicit Arrays(const Points& points) : x(static_cast<std::size_t>(points.cols())), y(x), z(x) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      x[at] = static_cast<float>(points(0, i));
      y[at] = static_cast<float>(points(1, i));
      z[at] = static_cast<float>(points(2, i));
    }
  }
  PlainPoints view() noexcept { return {x.data(), y.data(), z.data()}; }

  std::vector<float> x, y, z;
};

/// Both types by the plain loop, solved as the deformers do it.
class PlainDeformer {
public:
  PlainDeformer(const Points& mesh, const Points& starts, double radius)
      : starts_(starts), radii_(Eigen::VectorXd::Constant(starts.cols(), radius)), solver_({}),
        rest_(mesh), shape_(mesh), centres_(static_cast<std::size_t>(starts.cols())) {
    solver_.build(starts_, radii_);
  }
  void type1(const Points& ends) {
    step_ = ends - starts_;
    displace(rest_, shape_);
  }
  void type2(const Points& from, const Points& to) {
    solver_.build(from, radii_);
    step_ = to - from;
    displace(shape_, shape_);
  }

private:
  void displace(Arrays& from, Arrays& to) {
    solver_.solve(step_, field_);
    for (Eigen::Index i = 0; i < field_.centres.cols(); ++i) {
      const Eigen::Vector3f c = field_.centres.col(i).cast<float>();
      const Eigen::Vector3f a = (4.0 * field_.coefficients.col(i)).cast<float>();
      centres_[static_cast<std::size_t>(i)] = {
          c[0], c[1], c[2], static_cast<float>(1.0 / field_.radii[i]), a[0], a[1], a[2]};
    }
    plain_displace(centres_.data(), centres_.size(), from.view(), to.view(), from.x.size());
  }

  Points starts_, step_;
  Eigen::VectorXd radii_;
  CsrbfSolver solver_;
  CsrbfField field_;
  Arrays rest_, shape_;
  std::vector<PlainCentre> centres_;
};

std::array<Points, poses> random_ends(const Points& starts) {
  std::mt19937 random(1);
  std::array<Points, poses> ends;
  for (auto& end : ends)
    end = starts + table1_displacements(random);
  return ends;
}

/// There and back, so that the shape stays a plane more or less.
void stroke(Type2Deformer& deformer, const Points& starts, const std::array<Points, poses>& ends,
            std::size_t n) {
  deformer.end_at(n % 2 == 0 ? ends[n % poses] : starts);
}

/// What is measured side by side, the hands holding the mesh.
struct Deformers {
  Deformers(const Points& mesh, const Points& starts, double radius)
      : type1(mesh, 10, radius, {}), evaluated1(mesh, 10, radius, {}, {.weight_bytes = 0}),
        type2(mesh, 10, radius, one_piece, {}) {
    type1.grab(starts);
    evaluated1.grab(starts);
    type2.begin(starts);
  }

  Type1Deformer type1;
  Type1Deformer evaluated1;
  Type2Deformer type2;
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
  const Points starts = table1_starts();
  const auto ends = random_ends(starts);
  const auto vertices = static_cast<std::size_t>(mesh.cols());
  Best best1;
  Best best2;
  {
    Type1Deformer type1(mesh, 10, radius, {}, {.threads = 2});
    type1.grab(starts);
    BlockShape out;
    for (int n = 0; n < repetitions; ++n)
      best1.measure(vertices, [&](std::size_t k) { type1.apply(ends[k % poses], out); });
  }
  Type2Deformer type2(mesh, 10, radius, one_piece, {}, {.threads = 2});
  type2.begin(starts);
  for (int n = 0; n < repetitions; ++n)
    best2.measure(vertices, [&](std::size_t k) { stroke(type2, starts, ends, k); });
  times.type1_2threads_us = best1.us();
  times.type2_2threads_us = best2.us();
}

} // namespace

CellTimes measure_cell(const Points& mesh, double radius, int repetitions) {
  const Points starts = table1_starts();
  const auto ends = random_ends(starts);
  const auto vertices = static_cast<std::size_t>(mesh.cols());
  PlainDeformer plain1(mesh, starts, radius);
  PlainDeformer plain2(mesh, starts, radius);
  Deformers deformers(mesh, starts, radius);
  auto& [type1, evaluated1, type2, out, other] = deformers;
  CellTimes times;
  times.apart = apart_from_double(type1, ends[0]);
  times.weight_bytes = type1.weight_bytes();
  Best p1, p2, t1, e1, t2, grab;
  for (int n = 0; n < repetitions; ++n) {
    if (can_run_plain()) {
      p1.measure(vertices, [&](std::size_t k) { plain1.type1(ends[k % poses]); });
      p2.measure(vertices, [&](std::size_t k) {
        const Points& end = ends[k / 2 % poses];
        k % 2 == 0 ? plain2.type2(starts, end) : plain2.type2(end, starts);
      });
    }
    t1.measure(vertices, [&](std::size_t k) { type1.apply(ends[k % poses], out); });
    e1.measure(vertices, [&](std::size_t k) { evaluated1.apply(ends[k % poses], other); });
    t2.measure(vertices, [&](std::size_t k) { stroke(type2, starts, ends, k); });
    if (n % 8 == 0) grab.measure(vertices, [&](std::size_t) { type1.grab(starts); });
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

/// Within the plane, each support a fifth of it.
Points spread_starts() {
  Points starts(3, 10);
  for (Eigen::Index i = 0; i < 10; ++i)
    starts.col(i) << 5.0 + 10.0 * static_cast<double>(i % 5), i < 5 ? 15.0 : 35.0, 2.0;
  return starts;
}

std::size_t influences_of(const Points& mesh, const Points& starts, double radius) {
  std::size_t count = 0;
  for (Eigen::Index i = 0; i < starts.cols(); ++i)
    count += static_cast<std::size_t>(
        ((mesh.colwise() - starts.col(i)).colwise().squaredNorm().array() < radius * radius)
            .count());
  return count;
}

/// Ten supports over a plane of 289 vertices, which all of them contain.
double ns_an_influence(int repetitions) {
  const Points mesh = table1_plane(16);
  const Points starts = spread_starts();
  const auto ends = random_ends(starts);
  Type1Deformer deformer(mesh, 10, 200.0, {}, {.weight_bytes = 0});
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
  const Points mesh = table1_plane(cells);
  const Points starts = spread_starts();
  const auto ends = random_ends(starts);
  LargeTimes times;
  times.vertices = static_cast<std::size_t>(mesh.cols());
  times.influences = influences_of(mesh, starts, radius);
  Deformers deformers(mesh, starts, radius);
  auto& [type1, evaluated1, type2, out, other] = deformers;
  evaluated1.apply(ends[0], other);
  std::size_t reached = 0;
  for (std::size_t block = 0; block < other.block_count(); ++block)
    reached += other.stamp(block) != evaluated1.rest().stamp(block) ? 1U : 0U;
  times.reached = reached * block_size;
  std::vector<VertexBlock> from(reached);
  std::vector<VertexBlock> to(reached);
  Best t1, e1, t2, memory;
  for (int n = 0; n < repetitions; ++n) {
    t1.measure(times.vertices, [&](std::size_t k) { type1.apply(ends[k % poses], out); });
    e1.measure(times.vertices, [&](std::size_t k) { evaluated1.apply(ends[k % poses], other); });
    t2.measure(times.vertices, [&](std::size_t k) { stroke(type2, starts, ends, k); });
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

} // namespace nendo::app
