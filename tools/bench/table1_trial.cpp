#include "bench/table1_trial.hpp"

#include <nendo/deform/type1.hpp>

#include "bench/deform_frames.hpp"
#include "bench/plain_deformer.hpp"
#include "bench/whole_frame.hpp"
#include "reference/table1.hpp"

namespace nendo::bench {
namespace {

using namespace nendo::deform;

class Trial {
public:
  Trial(const Points& plane, const Points& starts, double radius)
      : plane_(plane), starts_(starts), radius_(radius), ends_(random_ends(starts)),
        vertices_(static_cast<std::size_t>(plane.cols())) {}

  /// The plain loop and one thread take turns.
  void measure_alone(double seconds, Table1Cell& cell) {
    PlainDeformer plain1(plane_, starts_, radius_);
    PlainDeformer plain2(plane_, starts_, radius_);
    Type1Deformer type1(plane_, starts_.cols(), {one_radius(radius_)});
    Strokes type2(plane_, starts_, radius_);
    type1.grab(starts_);
    BlockShape out;
    Best p1, p2, t1, t2;
    for_seconds(seconds, [&] {
      if (can_run_plain()) {
        p1.measure(vertices_, [&](std::size_t n) { plain1.type1(ends_[n % poses]); });
        p2.measure(vertices_, [&](std::size_t n) { plain2.stroke(ends_, n); });
      }
      t1.measure(vertices_, [&](std::size_t n) { type1.apply(ends_[n % poses], out); });
      type2.measure(t2);
    });
    cell.plain_loop = {p1.per_second(), p2.per_second()};
    cell.one_thread = {t1.per_second(), t2.per_second()};
  }

  /// The second thread spins as long as its deformer lives, so that nothing else is measured then.
  double type1_by_two(double seconds) {
    Type1Deformer type1(plane_, starts_.cols(), {one_radius(radius_), {}, {.threads = 2}});
    type1.grab(starts_);
    BlockShape out;
    Best best;
    for_seconds(seconds, [&] {
      best.measure(vertices_, [&](std::size_t n) { type1.apply(ends_[n % poses], out); });
    });
    return best.per_second();
  }
  double type2_by_two(double seconds) {
    Strokes type2(plane_, starts_, radius_, 2);
    Best best;
    for_seconds(seconds, [&] { type2.measure(best); });
    return best.per_second();
  }

private:
  const Points& plane_;
  const Points& starts_;
  double radius_;
  std::array<Points, poses> ends_;
  std::size_t vertices_;
};

} // namespace

Table1Cell measure_table1_cell(const Mesh& plane, const Points& starts, double radius,
                               double seconds) {
  Table1Cell cell;
  cell.evaluations = reference::count_evaluations(plane.vertices, starts, radius);
  Trial trial(plane.vertices, starts, radius);
  trial.measure_alone(0.5 * seconds, cell);
  cell.two_threads = {trial.type1_by_two(0.15 * seconds), trial.type2_by_two(0.15 * seconds)};
  cell.whole_frame = WholeFrame(plane, starts, radius).measure(0.2 * seconds);
  return cell;
}

} // namespace nendo::bench
