// nendo bench table1: the paper's Table 1 on this machine, beside the paper's figures and a plain
// loop that the compiler vectorises.

#include <cstdio>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/base/files.hpp>

#include "bench/bench.hpp"
#include "bench/figure4_picture.hpp"
#include "bench/simd_choice.hpp"
#include "bench/table1_paper.hpp"
#include "bench/table1_picture.hpp"
#include "bench/whole_frame.hpp"
#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"
#include "reference/table1.hpp"

namespace nendo::bench::table1_bench {
namespace {

struct Options {
  std::string simd;
  std::string picture;
  std::string figure4;
  double seconds_per_cell = 1.0;
  bool json = false;
};

/// One mesh of one layout.
struct Place {
  const reference::Table1Layout& layout;
  std::size_t plane;
  std::size_t vertices, triangles;
};

void print_json(const Place& place, const Table1Entry& entry) {
  const Table1Cell& cell = entry.cell;
  for (std::size_t type = 0; type < 2; ++type)
    for (const int threads : {1, 2}) {
      nlohmann::ordered_json object{
          {"layout", place.layout.name},
          {"vertices", place.vertices},
          {"triangles", place.triangles},
          {"radius", reference::table1_radii.at(entry.radius)},
          {"type", type + 1},
          {"threads", threads},
          {"frames_per_second", threads == 1 ? cell.one_thread[type] : cell.two_threads[type]},
          {"evaluations", cell.evaluations},
          {"paper_frames_per_second",
           (type == 0 ? paper_type1 : paper_type2).at(entry.plane).at(entry.radius)},
          {"paper_evaluations", paper_evaluations.at(entry.plane).at(entry.radius)},
          {"plain_loop_frames_per_second", nullptr},
          {"whole_frames_per_second", nullptr}};
      if (cell.plain_loop[type] > 0.0)
        object["plain_loop_frames_per_second"] = cell.plain_loop[type];
      if (threads == 1) object["whole_frames_per_second"] = cell.whole_frame[type];
      cli::print_line(object);
    }
}

void print_heading() {
  cli::print("The paper's Table 1 in frames per second. The paper: Athlon 64 3400+; p(x), normals "
             "and drawing included.\nHere, the best of many. whole: the same in the frame, one "
             "thread, {}.\nOthers only solve and move all vertices, without p(x). plain: a loop "
             "that the compiler vectorises; 2 thr: two threads.\n",
             whole_frame_drawing);
}

void print_layout(const reference::Table1Layout& layout) {
  cli::print("\nlayout {}: ten control points at z = {:.0f}\n", layout.name, layout.height);
  cli::print("{:>25} {:>17}  {:>42}  {:>42}\n", "", "evaluations",
             "---------------- Type-1 ------------------",
             "---------------- Type-2 ------------------");
  cli::print("{:>9} {:>8} {:>6} {:>8} {:>8}", "triangles", "vertices", "radius", "here", "paper");
  for (int type = 0; type < 2; ++type)
    cli::print("  {:>6} {:>6} {:>8} {:>9} {:>9}", "paper", "whole", "plain", "1 thread", "2 thr");
  cli::print("\n");
}

void print_text(const Place& place, const Table1Entry& entry) {
  const Table1Cell& cell = entry.cell;
  cli::print("{:9} {:8} {:6.0f} {:8} {:8}", place.triangles, place.vertices,
             reference::table1_radii.at(entry.radius), cell.evaluations,
             paper_evaluations.at(entry.plane).at(entry.radius));
  for (std::size_t type = 0; type < 2; ++type)
    cli::print("  {:6.1f} {:6.0f} {:8.0f} {:9.0f} {:9.0f}",
               (type == 0 ? paper_type1 : paper_type2).at(entry.plane).at(entry.radius),
               cell.whole_frame[type], cell.plain_loop[type], cell.one_thread[type],
               cell.two_threads[type]);
  cli::print("\n");
  std::fflush(stdout);
}

std::vector<Table1Entry> measure_layout(const reference::Table1Layout& layout,
                                        const Options& options) {
  const deform::Points starts = reference::table1_starts(layout.height);
  std::vector<Table1Entry> entries;
  for (std::size_t plane = 0; plane < reference::table1_planes.size(); ++plane) {
    const deform::Mesh mesh = reference::table1_mesh(reference::table1_planes.at(plane));
    const Place place{layout, plane, static_cast<std::size_t>(mesh.vertices.cols()),
                      mesh.face_count()};
    for (std::size_t radius = 0; radius < reference::table1_radii.size(); ++radius) {
      const Table1Cell cell = measure_table1_cell(mesh, starts, reference::table1_radii.at(radius),
                                                  options.seconds_per_cell);
      entries.push_back({plane, radius, cell});
      options.json ? print_json(place, entries.back()) : print_text(place, entries.back());
    }
  }
  return entries;
}

Result<void> draw_pictures(const Options& options, const std::vector<Table1Entry>& entries,
                           const char* layout) {
  if (!options.picture.empty()) {
    const auto written = replace_file(options.picture, table1_picture(entries, layout));
    if (!written) return written;
  }
  if (options.figure4.empty()) return {};
  return replace_file(options.figure4, figure4_picture(entries, layout));
}

int bench_table1(const Options& options) {
  constexpr double longest_s = 600.0;
  if (!(options.seconds_per_cell > 0.0 && options.seconds_per_cell <= longest_s))
    return cli::report({Errc::usage, "--seconds-per-cell: use more than 0, at most 600"});
  if (const auto fine = cli::check_place("--picture", options.picture); !fine)
    return cli::report(fine.error());
  if (const auto fine = cli::check_place("--figure4", options.figure4); !fine)
    return cli::report(fine.error());
  if (const auto chosen = choose_simd(options.simd); !chosen) return cli::report(chosen.error());
  if (!options.json) print_heading();
  for (const reference::Table1Layout& layout : reference::table1_layouts) {
    if (!options.json) print_layout(layout);
    const auto entries = measure_layout(layout, options);
    if (&layout != reference::table1_layouts.data()) continue;
    if (const auto drawn = draw_pictures(options, entries, layout.name); !drawn)
      return cli::report(drawn.error());
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::table1_bench

void nendo::bench::add_table1(cli::Command& bench) {
  using namespace table1_bench;
  cli::Command command = bench.add_command(
      "table1",
      "Measures the paper's Table 1 on this machine, beside the paper's figures and a plain loop");
  Options& options = command.on_chosen<Options>(bench_table1);
  command.add_duration("--seconds-per-cell", options.seconds_per_cell,
                       "Seconds per mesh, radius and layout, of which there are forty");
  command.add_option("--picture", options.picture,
                     "Also draw the layout 'near' beside the paper's figures, as FILE.svg");
  command.add_option("--figure4", options.figure4,
                     "Also draw the time of a whole frame over its evaluations, as the paper's "
                     "figure 4 does, beside the paper's, as FILE.svg");
  add_simd_option(command, options.simd);
  command.add_flag("--json", options.json, "One JSON object per line");
}
