// clay_strokes STROKES LEVEL: presses balls of clay with violent random strokes of a finger, of a
// rod and of a whole hand, each stroke on a fresh ball, and has CGAL count the pairs of faces that
// intersect then. Prints a table in Markdown, and fails if there is any.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/flow/hand_contact.hpp>

#include "evidence/intersection_count.hpp"
#include "reference/icosphere.hpp"
#include "support/contact_parts.hpp"

namespace {

using namespace nendo;
using deform::ContactPart;
using Eigen::Vector3d;
using Parts = std::vector<ContactPart>;

constexpr double ball_mm = 60.0;
constexpr double mm_a_m = 1000.0;

Vector3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

/// Begins outside of the ball, at the end of +z.
Parts finger() {
  return {test::cone({0, 0, 71}, {0, 0, 130}, 8.0, 9.0)};
}
Parts rod() {
  return {test::cone({-50, 0, 74}, {50, 0, 74}, 9.0, 9.0)};
}
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

/// At up to 1.5 m/s, 90 Hz: to the ball from any side, into it, on to any side, and away.
Outcome stroke(std::mt19937& random, Parts parts, int level) {
  deform::Mesh ball = reference::icosphere(level, ball_mm);
  deform::SculptedShape shape(ball.vertices, {});
  deform::ClayDeformer clay(shape, deform::corners_of_triangles(ball), 1, parts.size(),
                            {.radius_mm = 30.0});
  const Vector3d from = random_direction(random);
  parts = test::moved(
      parts, Eigen::Isometry3d(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), from)));
  std::uniform_real_distribution<double> share(0.2, 1.0);
  const double speed = 16.7 * share(random);
  const Vector3d in = -(10.0 + 30.0 * share(random)) * from;
  const Vector3d aside = 40.0 * share(random) * from.cross(random_direction(random));
  const Vector3d out = 60.0 * from;
  clay.begin(parts);
  Outcome outcome;
  const double whole = volume_of(ball);
  const auto note = [&](const deform::ClayReport& report) {
    outcome.penetration_mm = std::max(outcome.penetration_mm, report.penetration_mm);
    shape.layout().unpack(clay.shape(), ball.vertices);
    outcome.last_volume = std::abs(volume_of(ball) / whole - 1.0);
    outcome.volume = std::max(outcome.volume, outcome.last_volume);
  };
  for (const Vector3d& way : {in, aside, out}) {
    const int calls = std::max(1, static_cast<int>(way.norm() / speed));
    for (int call = 0; call < calls; ++call) {
      parts = test::moved(parts, Vector3d(way / calls));
      note(clay.press_to(parts));
    }
  }
  for (int wait = 0; wait < 20; ++wait)
    note(clay.press_to(parts));
  outcome.pairs = evidence::self_intersections(ball).size();
  return outcome;
}

} // namespace

int main(int argc, char** argv) {
  const int strokes = argc > 2 ? std::atoi(argv[1]) : 0;
  const int level = argc > 2 ? std::atoi(argv[2]) : 0;
  if (strokes < 1 || level < 3 || level > 7) {
    std::fputs("usage: clay_strokes STROKES LEVEL (3 to 7)\n", stderr);
    return 2;
  }
  std::puts(
      "| body | strokes | with pairs | pairs | left, mm: worst | volume, %: worst | at the end |\n"
      "|---|---|---|---|---|---|---|");
  bool is_any = false;
  const std::vector<std::pair<const char*, Parts>> bodies{
      {"finger", finger()}, {"rod", rod()}, {"hand", whole_hand()}};
  for (const auto& body : bodies) {
    std::mt19937 random(2004);
    int folded = 0;
    Outcome all;
    for (int at = 0; at < strokes; ++at) {
      const Outcome one = stroke(random, body.second, level);
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
  return is_any ? 1 : 0;
}
