// joins COUNT SEED MODEL...: joins pairs of shapes that are turned and moved at random, or copies
// of themselves moved by edges, sharp and with a seam of a random width, COUNT pairs in all. CGAL
// judges each result: whether it is an oriented two-manifold, and which faces intersect. Volumes of
// union and intersection are compared with those of both. Prints a table in Markdown.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/join.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "evidence/intersection_count.hpp"
#include "join/mesh_surface.hpp"
#include "join/overlay.hpp"
#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/test_meshes.hpp"

namespace {

using namespace nendo;
using deform::Mesh;

struct Tally {
  int joins = 0, apart = 0, nested = 0, refused = 0;
  int open = 0, intersecting = 0;
  int seams = 0, narrower = 0, without_seam = 0, open_seams = 0, intersecting_seams = 0;
  double volumes = 0.0;     ///< the worst |V(union) + V(intersection) - V(a) - V(b)|, relative
  double seam_volume = 0.0; ///< the worst change by a seam, of its bound
  double total_ms = 0.0, worst_ms = 0.0;
};

/// The volumes' error, and -1 if there is no overlay.
double volume_error(const Mesh& a, const Mesh& b) {
  const Mesh* const both[] = {&a, &b};
  const deform::SharedSurfaces shared = deform::surfaces_of(both);
  const auto laid = deform::overlay(shared.surfaces[0], shared.surfaces[1]);
  if (!laid) return 1.0;
  double sum = 0.0;
  for (const auto choice : {deform::Choice::union_of_both, deform::Choice::intersection})
    sum += deform::volume_of(deform::mesh_of(
        deform::choose(shared.surfaces[0], shared.surfaces[1], *laid, choice).surface,
        shared.look));
  const double expected = deform::volume_of(a) + deform::volume_of(b);
  return std::abs(sum - expected) / expected;
}

void join_sharp(const Mesh& a, const Mesh& b, Tally& tally) {
  ++tally.joins;
  tally.volumes = std::max(tally.volumes, volume_error(a, b));
  const deform::JoinPart parts[] = {{&a, "a"}, {&b, "b"}};
  const auto begin = std::chrono::steady_clock::now();
  const auto joined = deform::join(parts, {});
  const double ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  tally.total_ms += ms;
  tally.worst_ms = std::max(tally.worst_ms, ms);
  if (!joined) {
    const bool is_apart = joined.error().message.find("do not touch") != std::string::npos;
    ++(is_apart ? tally.apart : tally.refused);
    return;
  }
  tally.nested += joined->steps[0].swallowed ? 1 : 0;
  tally.open += deform::check_closed_manifold(joined->mesh) ? 0 : 1;
  tally.intersecting += evidence::self_intersections(joined->mesh).empty() ? 0 : 1;
}

void join_smeared(const Mesh& a, const Mesh& b, double width, Tally& tally) {
  const deform::JoinPart parts[] = {{&a, "a"}, {&b, "b"}};
  const auto joined = deform::join(parts, {.seam_width = width});
  if (!joined || joined->steps[0].swallowed) return;
  const deform::JoinStep& step = joined->steps[0];
  ++tally.seams;
  if (step.seam_width < width) ++(step.seam_width > 0.0 ? tally.narrower : tally.without_seam);
  tally.open_seams += deform::check_closed_manifold(joined->mesh) ? 0 : 1;
  tally.intersecting_seams += evidence::self_intersections(joined->mesh).empty() ? 0 : 1;
  if (step.volume_bound > 0.0)
    tally.seam_volume =
        std::max(tally.seam_volume, std::abs(step.volume - step.sharp_volume) / step.volume_bound);
}

void print(const std::string& name, const Tally& t) {
  std::printf("| %s | %d | %d | %d | %d | %d | %d | %.1e | %.1f, %.1f | %d | %d | %d | %d | %d | "
              "%.2f |\n",
              name.c_str(), t.joins, t.apart, t.nested, t.refused, t.open, t.intersecting,
              t.volumes, t.total_ms / std::max(t.joins, 1), t.worst_ms, t.seams, t.narrower,
              t.without_seam, t.open_seams, t.intersecting_seams, t.seam_volume);
  std::fflush(stdout);
}

double first_edge(const Mesh& mesh) {
  return (mesh.vertices.col(mesh.face_corners[0]) - mesh.vertices.col(mesh.face_corners[1])).norm();
}

} // namespace

int main(int argc, char** argv) {
  const int count = argc > 2 ? std::atoi(argv[1]) : 0;
  if (count <= 0) {
    std::cerr << "usage: joins COUNT SEED MODEL...\n";
    return 2;
  }
  std::mt19937 random(static_cast<unsigned>(std::atoi(argv[2])));
  std::vector<std::pair<std::string, Mesh>> shapes{{"ball", test::sphere(40, 64, 1.0)},
                                                   {"torus", test::torus(60, 30)},
                                                   {"cube", test::cube_of_cells(8)},
                                                   {"comb", test::comb(13)}};
  for (int at = 3; at < argc; ++at) {
    auto mesh = deform::read_mesh(argv[at]);
    if (!mesh) {
      std::cerr << "joins: " << mesh.error().message << '\n';
      return 1;
    }
    shapes.emplace_back(std::filesystem::path(argv[at]).stem().string(), std::move(*mesh));
  }
  for (auto& [name, mesh] : shapes)
    mesh = test::normalised(mesh);
  std::puts("| pair | joins | apart | nested | refused | not closed | intersecting | volumes | ms: "
            "mean, worst | seams | narrower | none | not closed | intersecting | change of volume, "
            "of its bound |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  const int pairs = static_cast<int>(shapes.size() * (shapes.size() + 1));
  const int each = std::max(1, (count + pairs - 1) / pairs);
  std::uniform_real_distribution<double> way(-0.8, 0.8);
  std::uniform_real_distribution<double> width(0.03, 0.15);
  for (const auto& [first, a] : shapes) {
    for (const auto& [second, b] : shapes) {
      Tally tally;
      for (int at = 0; at < each; ++at) {
        const double x = way(random);
        const double y = way(random);
        const Mesh other = test::moved(test::turned(b, random), {x, y, way(random)});
        join_sharp(a, other, tally);
        join_smeared(a, other, width(random), tally);
      }
      print(first + " and " + second, tally);
    }
    Tally tally;
    for (int at = 0; at < each; ++at) {
      Eigen::Vector3d step = Eigen::Vector3d::Zero();
      step[at % 3] = first_edge(a) * (at % 5);
      if (at % 2 == 1) step[(at + 1) % 3] = 0.5 * first_edge(a);
      join_sharp(a, test::moved(a, step), tally);
      join_smeared(a, test::moved(a, step), width(random), tally);
    }
    print(first + " and its copy", tally);
  }
  return 0;
}
