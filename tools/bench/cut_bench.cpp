// nendo bench cut: how long cuts take.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/deform/cut.hpp>

#include "bench/bench.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::cut_bench {
namespace {

using namespace nendo::deform;

struct Options {
  unsigned repetitions = 5;
  bool json = false;
};

/// A bumpy ball of 2 * rings * segments triangles, with texture coordinates, colours, and two
/// materials.
Mesh bumpy_ball(std::uint32_t rings, std::uint32_t segments) {
  Mesh mesh;
  const auto count = 2 + std::size_t{rings} * segments;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(count));
  mesh.vertices.col(0) << 0.0, 0.0, 1.0;
  mesh.vertices.col(1) << 0.0, 0.0, -1.0;
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t segment = 0; segment < segments; ++segment) {
      const double polar = 3.14159265358979 * (ring + 1) / (rings + 1);
      const double turn = 2.0 * 3.14159265358979 * segment / segments;
      const Eigen::Vector3d at(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                               std::cos(polar));
      mesh.vertices.col(2 + ring * segments + segment) =
          at * (1.0 + 0.1 * std::sin(7.0 * at.x()) * std::sin(9.0 * at.y() + 1.0));
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.face_corners.insert(mesh.face_corners.end(), {a, b, c});
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
    mesh.look.face_materials.push_back(a % 2);
  };
  for (std::uint32_t segment = 0; segment < segments; ++segment) {
    const std::uint32_t next = (segment + 1) % segments;
    const std::uint32_t last = 2 + (rings - 1) * segments;
    add(0, 2 + segment, 2 + next);
    for (std::uint32_t from = 2; from < last; from += segments) {
      add(from + segment, from + segments + segment, from + segments + next);
      add(from + segment, from + segments + next, from + next);
    }
    add(last + segment, 1, last + next);
  }
  mesh.texcoords = mesh.vertices.topRows(2);
  mesh.corner_texcoords = mesh.face_corners;
  mesh.look.vertex_colours = Eigen::Matrix4Xf::Ones(4, mesh.vertices.cols());
  mesh.look.materials.resize(2);
  return mesh;
}

CutWire bent_wire() {
  CutWire wire;
  for (int k = 0; k <= 40; ++k) {
    const double t = k / 40.0;
    wire.places.push_back({{-1.5 + 3.0 * t, -1.6, 0.3 * std::sin(4.0 * t)},
                           {-1.5 + 3.0 * t, 1.6, 0.3 * std::cos(3.0 * t) - 0.2}});
  }
  return wire;
}

struct Timing {
  double best_ms = 0.0, median_ms = 0.0;
  std::size_t cut_faces = 0;
};

template <class Blade>
Timing time_of(const Mesh& mesh, const Blade& blade, unsigned repetitions) {
  std::vector<double> times;
  Timing timing;
  for (unsigned at = 0; at < repetitions && !cli::stop_requested(); ++at) {
    // The program's own time: others may be at work on the machine.
    const std::clock_t begin = std::clock();
    const auto cut = cut_model(mesh, blade);
    times.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    if (cut) timing.cut_faces = cut->mesh.face_count() - cut->first_cut_face;
  }
  std::sort(times.begin(), times.end());
  if (times.empty()) return timing;
  timing.best_ms = times.front();
  timing.median_ms = times[times.size() / 2];
  return timing;
}

int run(const Options& options) {
  const CutPlane plane{{0.1, 0.05, 0.02}, {0.3, 0.5, 0.8}};
  const CutWire wire = bent_wire();
  cli::install_stop_signals();
  if (!options.json)
    cli::print("Cuts of a bumpy ball with texture coordinates, colours and materials: processor "
               "time, best (median) in ms\n");
  for (const std::uint32_t rings : {87U, 287U}) {
    const Mesh mesh = bumpy_ball(rings, 2 * rings);
    const Timing by_plane = time_of(mesh, plane, options.repetitions);
    const Timing by_wire = time_of(mesh, wire, options.repetitions);
    if (options.json) {
      const auto figures = [](const Timing& timing) {
        return nlohmann::ordered_json{{"best_ms", timing.best_ms},
                                      {"cut_faces", timing.cut_faces},
                                      {"median_ms", timing.median_ms}};
      };
      cli::print_line({{"plane", figures(by_plane)},
                       {"triangles", mesh.face_count()},
                       {"wire", figures(by_wire)}});
      continue;
    }
    cli::print(
        "{:7} triangles: plane {:.1f} ({:.1f}), {} cut faces; bent wire {:.1f} ({:.1f}), {} cut "
        "faces\n",
        mesh.face_count(), by_plane.best_ms, by_plane.median_ms, by_plane.cut_faces,
        by_wire.best_ms, by_wire.median_ms, by_wire.cut_faces);
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::cut_bench

void nendo::bench::add_cut(cli::Command& bench) {
  using namespace cut_bench;
  cli::Command command =
      bench.add_command("cut", "Measures the time to cut models of 30,000 and 330,000 triangles");
  Options& options = command.on_chosen<Options>(run);
  command.add_option("--repetitions", options.repetitions, "Number of cuts of each kind");
  command.add_flag("--json", options.json, "One JSON object per line");
}
