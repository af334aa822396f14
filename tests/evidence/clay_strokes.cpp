// clay_strokes STROKES LEVEL: presses balls of clay with violent random strokes of a finger, of a
// rod and of a whole hand, each stroke on a fresh ball, and has CGAL count the pairs of faces that
// intersect then. Prints a table in Markdown, and fails if there is any.
// clay_strokes --one-ball STROKES LEVEL: all strokes of a body on one ball, whose triangles are
// refined ten times a second, or are not. Prints what became of them.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/refinement.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/flow/clay_hands.hpp>

#include "bench/refined_clay.hpp"
#include "evidence/intersection_count.hpp"
#include "reference/icosphere.hpp"
#include "support/clay_strokes.hpp"
#include "support/triangle_angles.hpp"

namespace {

using namespace nendo;
using Parts = test::StrokeParts;

constexpr double ball_mm = test::stroked_ball_mm;
constexpr double mm_a_m = 1000.0;

/// As the others begin.
Parts whole_hand() {
  const hand::HandSkeleton skeleton(Side::right);
  hand::HandBody body(skeleton);
  hand::JointAngles angles;
  for (auto& bent : angles.fingers)
    bent = {0.3, 0.0, 0.3, 0.2};
  Eigen::Isometry3d wrist = Eigen::Isometry3d::Identity();
  wrist.linear() << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  wrist.translation() << -0.07, 0.0, 0.082;
  Parts parts(hand::HandBody::part_count);
  flow::contact_parts(body, skeleton.pose(angles, wrist), mm_a_m, parts);
  return parts;
}

double volume_of(const deform::Mesh& mesh) {
  double sum = 0.0;
  deform::for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    sum += mesh.vertices.col(corners[0])
               .dot(mesh.vertices.col(corners[1]).cross(mesh.vertices.col(corners[2])));
  });
  return sum / 6.0;
}

struct Outcome {
  std::size_t pairs = 0;
  double penetration_mm = 0.0;
  double volume = 0.0, last_volume = 0.0; ///< relative; the worst, and at the end
};

/// A ball of clay, and what presses it.
class Trial {
public:
  Trial(int level, std::size_t parts, bool refines)
      : refines_(refines), clay_(reference::icosphere(level, ball_mm), 1, parts,
                                 deform::ClayOptions{.radius_mm = 30.0}),
        whole_(volume_of(clay_.shown())) {}
  void stroke(std::mt19937& random, const Parts& parts) {
    test::violent_stroke(
        random, parts, [this](const Parts& first) { clay_.begin(first); },
        [this](const Parts& next) { press(next); });
    outcome_.pairs = evidence::self_intersections(clay_.shown()).size();
  }
  const Outcome& outcome() const { return outcome_; }
  const deform::Mesh& shown() { return clay_.shown(); }

private:
  void press(const Parts& parts) {
    outcome_.penetration_mm =
        std::max(outcome_.penetration_mm, clay_.press_to(parts).penetration_mm);
    outcome_.last_volume = std::abs(volume_of(clay_.shown()) / whole_ - 1.0);
    outcome_.volume = std::max(outcome_.volume, outcome_.last_volume);
    if (refines_ && ++calls_ % 9 == 0) clay_.refine(parts);
  }

  bool refines_;
  bench::RefinedClay clay_;
  double whole_;
  Outcome outcome_;
  int calls_ = 0;
};

/// The lengths of all edges, mm, the shortest first, those of two triangles twice.
std::vector<double> edges_of(const deform::Mesh& mesh) {
  std::vector<double> edges;
  deform::for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back(
          (mesh.vertices.col(corners[k]) - mesh.vertices.col(corners[(k + 1) % 3])).norm());
  });
  std::sort(edges.begin(), edges.end());
  return edges;
}

const std::vector<std::pair<const char*, Parts>>& bodies() {
  static const std::vector<std::pair<const char*, Parts>> all{
      {"finger", test::stroking_finger()}, {"rod", test::stroking_rod()}, {"hand", whole_hand()}};
  return all;
}

bool strokes_on_fresh_balls(int strokes, int level) {
  std::puts(
      "| body | strokes | with pairs | pairs | left, mm: worst | volume, %: worst | at the end |\n"
      "|---|---|---|---|---|---|---|");
  bool is_any = false;
  for (const auto& body : bodies()) {
    std::mt19937 random(2004);
    int folded = 0;
    Outcome all;
    for (int at = 0; at < strokes; ++at) {
      Trial trial(level, body.second.size(), false);
      trial.stroke(random, body.second);
      const Outcome& one = trial.outcome();
      folded += one.pairs > 0 ? 1 : 0;
      all.pairs += one.pairs;
      all.penetration_mm = std::max(all.penetration_mm, one.penetration_mm);
      all.volume = std::max(all.volume, one.volume);
      all.last_volume = std::max(all.last_volume, one.last_volume);
    }
    std::printf("| %s | %d | %d | %zu | %.3f | %.4f | %.4f |\n", body.first, strokes, folded,
                all.pairs, all.penetration_mm, 100.0 * all.volume, 100.0 * all.last_volume);
    std::fflush(stdout);
    is_any = is_any || folded > 0;
  }
  return !is_any;
}

bool strokes_on_one_ball(int strokes, int level) {
  std::puts("| body | refined | strokes | first with pairs | pairs at the end | vertices | least "
            "angle, p5 | edges, mm: p1, p99 | volume at the end, % |\n"
            "|---|---|---|---|---|---|---|---|---|");
  bool is_any = false;
  for (const auto& body : bodies())
    for (const bool refines : {false, true}) {
      std::mt19937 random(2004);
      Trial trial(level, body.second.size(), refines);
      int first = 0;
      for (int at = 1; at <= strokes; ++at) {
        trial.stroke(random, body.second);
        if (first == 0 && trial.outcome().pairs > 0) first = at;
      }
      const deform::Mesh mesh = trial.shown();
      const std::vector<double> angles = test::min_angles(mesh);
      const std::vector<double> edges = edges_of(mesh);
      std::printf("| %s | %s | %d | %s | %zu | %td | %.1f | %.2f, %.2f | %.3f |\n", body.first,
                  refines ? "yes" : "no", strokes, first > 0 ? std::to_string(first).c_str() : "-",
                  trial.outcome().pairs, mesh.vertices.cols(), angles[angles.size() / 20],
                  edges[edges.size() / 100], edges[edges.size() - edges.size() / 100 - 1],
                  100.0 * trial.outcome().last_volume);
      std::fflush(stdout);
      is_any = is_any || first > 0;
    }
  return !is_any;
}

} // namespace

int main(int argc, char** argv) {
  const bool one_ball = argc == 4 && std::string_view(argv[1]) == "--one-ball";
  const int strokes = argc > 2 ? std::atoi(argv[argc - 2]) : 0;
  const int level = argc > 2 ? std::atoi(argv[argc - 1]) : 0;
  if ((argc != 3 && !one_ball) || strokes < 1 || level < 3 || level > 7) {
    std::fputs("usage: clay_strokes [--one-ball] STROKES LEVEL (3 to 7)\n", stderr);
    return 2;
  }
  return (one_ball ? strokes_on_one_ball : strokes_on_fresh_balls)(strokes, level) ? 0 : 1;
}
