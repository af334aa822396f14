// self_intersections STROKES SUBDIVISIONS LONGEST EDGE MODEL...: deforms spheres, a plane and the
// models named by violent random strokes of up to LONGEST radii, with and without injective chains,
// and has CGAL count the pairs of faces that intersect then and did not before. A mesh with an edge
// longer than EDGE radii is subdivided (midpoints: the same surface, edges half as long) until it
// has none. Where any pair is left with chains, it is subdivided further and the strokes that left
// it are repeated. Prints a table in Markdown.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>

#include <nendo/deform/mesh_file.hpp>

#include "evidence/intersection_count.hpp"
#include "evidence/strokes.hpp"
#include "support/test_meshes.hpp"

namespace {

using namespace nendo;
using deform::Mesh;
using evidence::Stroke;

/// Of the model's diagonal: the reach of a fingertip.
constexpr double radius_part = 0.25;

Mesh triangulated(const Mesh& mesh) {
  Mesh triangles;
  triangles.vertices = mesh.vertices;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (std::uint32_t at = mesh.face_starts[face] + 1; at + 1 < mesh.face_starts[face + 1]; ++at)
      test::add_face(triangles, {mesh.face_corners[mesh.face_starts[face]], mesh.face_corners[at],
                                 mesh.face_corners[at + 1]});
  return triangles;
}

/// Every triangle becomes four.
Mesh subdivided(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  auto next = static_cast<std::uint32_t>(mesh.vertices.cols());
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), next);
    if (is_new) ++next;
    return at->second;
  };
  Mesh fine;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t* corner = &mesh.face_corners[3 * face];
    const std::uint32_t ab = middle(corner[0], corner[1]);
    const std::uint32_t bc = middle(corner[1], corner[2]);
    const std::uint32_t ca = middle(corner[2], corner[0]);
    test::add_face(fine, {corner[0], ab, ca});
    test::add_face(fine, {ab, corner[1], bc});
    test::add_face(fine, {ca, bc, corner[2]});
    test::add_face(fine, {ab, bc, ca});
  }
  fine.vertices.resize(3, next);
  fine.vertices.leftCols(mesh.vertices.cols()) = mesh.vertices;
  for (const auto& [ends, at] : middles)
    fine.vertices.col(at) = 0.5 * (mesh.vertices.col(ends.first) + mesh.vertices.col(ends.second));
  return fine;
}

struct Edges {
  double mean = 0.0;
  double longest = 0.0;
};

Edges edges_of(const Mesh& mesh) {
  Edges edges;
  for (std::size_t at = 0; at < mesh.face_corners.size(); ++at) {
    const std::size_t after = at % 3 == 2 ? at - 2 : at + 1;
    const double length =
        (mesh.vertices.col(mesh.face_corners[at]) - mesh.vertices.col(mesh.face_corners[after]))
            .norm();
    edges.mean += length / static_cast<double>(mesh.face_corners.size());
    edges.longest = std::max(edges.longest, length);
  }
  return edges;
}

struct Tally {
  int strokes = 0; ///< with at least one new pair
  std::size_t pairs = 0;
};

class Trial {
public:
  Trial(std::string name, Mesh mesh) : name_(std::move(name)), mesh_(std::move(mesh)) {
    radius_ = radius_part * deform::diagonal_of(mesh_.vertices);
  }

  /// Until no edge is longer, in radii.
  void subdivide_to(double longest_edge) {
    while (edges_of(mesh_).longest > longest_edge * radius_)
      mesh_ = subdivided(mesh_);
  }

  void run(const char* type, const std::vector<Stroke>& all, int subdivisions) {
    std::vector<Stroke> strokes = all;
    Mesh mesh = mesh_;
    for (int level = 0; level <= subdivisions && !strokes.empty(); ++level) {
      if (level > 0) mesh = subdivided(mesh);
      strokes = run_once(type, strokes, mesh);
    }
  }

  const Mesh& mesh() const { return mesh_; }
  double radius() const { return radius_; }

private:
  static bool count(const Mesh& mesh, const deform::Points& shape,
                    const std::set<std::pair<std::uint32_t, std::uint32_t>>& before, Tally& tally) {
    Mesh deformed = mesh;
    deformed.vertices = shape;
    std::size_t fresh = 0;
    for (const auto& pair : evidence::self_intersections(deformed))
      if (before.count(pair) == 0) ++fresh;
    tally.pairs += fresh;
    tally.strokes += fresh > 0 ? 1 : 0;
    return fresh > 0;
  }

  /// The strokes after which faces still intersect with chains.
  std::vector<Stroke> run_once(const char* type, const std::vector<Stroke>& strokes,
                               const Mesh& mesh) const {
    const auto before = evidence::self_intersections(mesh);
    Tally off;
    Tally on;
    std::vector<Stroke> left;
    double min_determinant = 1.0;
    int links = 0;
    int held = 0;
    int unreached = 0;
    for (const Stroke& stroke : strokes) {
      count(mesh, at_once(stroke, mesh.vertices), before, off);
      const evidence::Followed followed = in_chains(stroke, mesh.vertices);
      if (count(mesh, followed.shape, before, on)) left.push_back(stroke);
      min_determinant = std::min(min_determinant, followed.min_determinant);
      links += followed.links;
      held += followed.held ? 1 : 0;
      unreached += followed.reached ? 0 : 1;
    }
    const Edges edges = edges_of(mesh);
    std::printf(
        "| %s | %zu | %zu | %.4f | %.4f | %s | %zu | %d | %zu | %d | %zu | %.1f | %d | %d | "
        "%.1e |\n",
        name_.c_str(), mesh.face_count(), before.size(), edges.mean / radius_,
        edges.longest / radius_, type, strokes.size(), off.strokes, off.pairs, on.strokes, on.pairs,
        static_cast<double>(links) / static_cast<double>(strokes.size()), held, unreached,
        min_determinant);
    std::fflush(stdout);
    return left;
  }

  std::string name_;
  Mesh mesh_;
  double radius_ = 0.0;
};

std::vector<Trial> trials(const std::vector<std::string>& models) {
  std::vector<Trial> trials;
  trials.emplace_back("sphere", triangulated(test::sphere(63, 96, 1.0)));
  trials.emplace_back("plane", triangulated(test::grid(72, 1.0)));
  trials.emplace_back("coarse sphere", triangulated(test::sphere(9, 14, 1.0)));
  trials.emplace_back("coarse plane", triangulated(test::grid(9, 1.0)));
  for (const std::string& path : models) {
    const auto mesh = deform::read_mesh(path);
    if (!mesh) {
      std::cerr << "self_intersections: " << mesh.error().message << '\n';
      std::exit(1);
    }
    trials.emplace_back(std::filesystem::path(path).stem().string(), triangulated(*mesh));
  }
  return trials;
}

} // namespace

int main(int argc, char** argv) {
  const int strokes = argc > 4 ? std::atoi(argv[1]) : 0;
  const double longest = argc > 4 ? std::atof(argv[3]) : 0.0;
  const double longest_edge = argc > 4 ? std::atof(argv[4]) : 0.0;
  if (strokes <= 0 || !(longest > 0.0) || !(longest_edge >= 0.01)) {
    std::cerr << "usage: self_intersections STROKES SUBDIVISIONS LONGEST EDGE MODEL...\n"
                 "LONGEST > 0, EDGE >= 0.01: radii; 0.01 is a million faces and more\n";
    return 2;
  }
  std::puts(
      "| mesh | faces | before | mean edge / r | longest / r | type | strokes | off: strokes | "
      "off: pairs | on: strokes | on: pairs | links | held | not reached | least det |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (Trial& trial : trials({argv + 5, argv + argc})) {
    std::mt19937 random(2004);
    std::vector<Stroke> type1;
    std::vector<Stroke> type2;
    for (int stroke = 0; stroke < strokes; ++stroke) {
      type1.push_back(
          evidence::type1_stroke(random, trial.mesh().vertices, trial.radius(), longest));
      type2.push_back(
          evidence::type2_stroke(random, trial.mesh().vertices, trial.radius(), longest));
    }
    trial.subdivide_to(longest_edge); // the strokes are those of the mesh as it was
    trial.run("1", type1, std::atoi(argv[2]));
    trial.run("2", type2, std::atoi(argv[2]));
  }
}
