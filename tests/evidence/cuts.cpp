// cuts CUTS MODEL...: cuts nasty shapes and the models named by CUTS random planes, wires and
// knives each, and judges every part: closed and two-manifold, sum of volumes, sum of Euler
// numbers, old vertices' bits, faces that meet by the own exact test, and, if it was built with
// CGAL, pairs of faces that intersect by that. Prints a table in Markdown. Exits with 1 if anything
// is wrong.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nendo/deform/mesh_file.hpp>

#ifdef NENDO_CGAL
#include "evidence/intersection_count.hpp"
#endif
#include "support/cut_laws.hpp"
#include "support/nasty_meshes.hpp"
#include "support/random_blades.hpp"

namespace {

using namespace nendo;
using deform::Mesh;

struct Tally {
  std::size_t cuts = 0, beside = 0, refused = 0, again = 0, open = 0, meeting = 0, pairs = 0,
              moved = 0, euler = 0;
  double volume = 0.0, total_ms = 0.0, worst_ms = 0.0;
  std::uint32_t max_parts = 0;

  bool is_clean() const {
    return refused == 0 && open == 0 && meeting == 0 && pairs == 0 && moved == 0 && euler == 0 &&
           volume < 1e-11;
  }
};

std::size_t judged_pairs([[maybe_unused]] const Mesh& part) {
#ifdef NENDO_CGAL
  Mesh triangles;
  triangles.vertices = part.vertices;
  deform::for_each_triangle(part, [&](const std::array<std::uint32_t, 3>& corners) {
    test::add_face(triangles, {corners[0], corners[1], corners[2]});
  });
  return evidence::self_intersections(triangles).size();
#else
  return 0;
#endif
}

void judge(const Mesh& mesh, const deform::CutModel& cut, Tally& tally) {
  const test::CutFaults faults = test::faults_of(mesh, cut);
  tally.open += faults.open_parts > 0 ? 1U : 0U;
  tally.meeting += faults.meetings > 0 ? 1U : 0U;
  tally.moved += faults.moved + faults.infinite > 0 ? 1U : 0U;
  tally.euler += faults.euler != 0 ? 1U : 0U;
  tally.volume = std::max(tally.volume, faults.volume);
  tally.again += cut.attempts > 1 ? 1U : 0U;
  tally.max_parts = std::max(tally.max_parts, cut.parts);
  for (const Mesh& part : deform::separate(cut))
    tally.pairs += judged_pairs(part);
}

Tally cut_often(const Mesh& mesh, std::uint32_t cuts, std::uint32_t kind,
                test::RandomBlades& blades) {
  Tally tally;
  for (std::uint32_t number = 0; number < cuts; ++number) {
    const test::AnyBlade blade = blades.next(4 * number + kind);
    const std::clock_t begin = std::clock(); // the program's own time: others may be at work here
    const auto cut = test::cut_by(mesh, blade);
    const double ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    tally.total_ms += ms;
    tally.worst_ms = std::max(tally.worst_ms, ms);
    if (cut) {
      ++tally.cuts;
      judge(mesh, *cut, tally);
    } else if (cut.error().message == "is not touched by the blade") {
      ++tally.beside;
    } else {
      ++tally.refused;
      std::fprintf(stderr, "refused: %s\n", cut.error().message.c_str());
    }
  }
  return tally;
}

bool cut_by_all_kinds(const std::string& name, const Mesh& mesh, std::uint32_t cuts) {
  test::RandomBlades blades(mesh, 1);
  bool clean = true;
  const char* kinds[] = {"planes", "planes in vertices, edges, faces", "wires", "knives"};
  for (std::uint32_t kind = 0; kind < 4; ++kind) {
    const std::uint32_t own = cuts / 4 + (kind < cuts % 4 ? 1U : 0U);
    const Tally tally = cut_often(mesh, own, kind, blades);
    clean = clean && tally.is_clean();
    std::printf("| %s | %zu | %s | %zu | %zu | %zu | %zu | %zu | %zu | %zu | %.0e | %zu | %u | "
                "%.1f, %.0f |\n",
                name.c_str(), mesh.face_count(), kinds[kind], tally.cuts, tally.beside,
                tally.refused, tally.again, tally.open, tally.meeting, tally.pairs, tally.volume,
                tally.euler + tally.moved, tally.max_parts, own > 0 ? tally.total_ms / own : 0.0,
                tally.worst_ms);
    std::fflush(stdout);
  }
  return clean;
}

} // namespace

int main(int argc, char** argv) {
  const int cuts = argc > 1 ? std::atoi(argv[1]) : 0;
  if (cuts < 1) {
    std::fputs("usage: cuts CUTS MODEL...\n", stderr);
    return 2;
  }
  std::vector<std::pair<std::string, Mesh>> shapes;
  shapes.emplace_back("torus", test::torus(80, 40));
  shapes.emplace_back("thin shell (0.97)", test::shell(50, 0.97));
  shapes.emplace_back("cube of 8^3 cells", test::cube_of_cells(8));
  shapes.emplace_back("cube of squares", test::cube_of_cells(8, true));
  shapes.emplace_back("comb, 11 teeth", test::comb(21));
  shapes.emplace_back("sponge, level 3", test::sponge(3));
  for (int at = 2; at < argc; ++at) {
    auto mesh = deform::read_mesh(argv[at]);
    if (!mesh) {
      std::fprintf(stderr, "cuts: %s\n", mesh.error().message.c_str());
      return 5;
    }
    shapes.emplace_back(std::filesystem::path(argv[at]).stem().string(), std::move(*mesh));
  }
  std::puts(
      "| shape | faces | blades | cut | beside | refused | second try | open | meeting | pairs "
      "by CGAL | volume | Euler, bits | parts, most | ms, worst |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  bool clean = true;
  for (const auto& shape : shapes)
    clean = cut_by_all_kinds(shape.first, shape.second, static_cast<std::uint32_t>(cuts)) && clean;
  return clean ? 0 : 1;
}
