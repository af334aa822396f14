// nendo bench deform: both types of deformation beside a plain loop that the compiler vectorises,
// on the meshes and radii of the paper's Table 1; clay beside air; and models of a million and ten
// million vertices beside two floors.

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "bench/bench.hpp"
#include "bench/deform_trial.hpp"
#include "bench/plane_memory.hpp"
#include "bench/simd_choice.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"
#include "reference/table1.hpp"

namespace nendo::bench::deform_bench {
namespace {

struct Options {
  std::string simd;
  bool short_form = false;
  bool json = false;
};

/// 0 where there is no plain loop to compare with.
double ratio(double plain_us, double us) {
  return us > 0.0 ? plain_us / us : 0.0;
}

void print_cell_json(Eigen::Index vertices, double radius, const CellTimes& times) {
  cli::print_line({{"vertices", vertices},
                   {"radius", radius},
                   {"plain_type1_us", times.plain1_us},
                   {"plain_type2_us", times.plain2_us},
                   {"type1_us", times.type1_us},
                   {"type1_evaluated_us", times.evaluated1_us},
                   {"type2_us", times.type2_us},
                   {"type1_two_threads_us", times.type1_2threads_us},
                   {"type2_two_threads_us", times.type2_2threads_us},
                   {"grab_us", times.grab_us},
                   {"weight_bytes", times.weight_bytes},
                   {"apart_of_diagonal", times.apart},
                   {"ratio",
                    {{"type1", ratio(times.plain1_us, times.type1_us)},
                     {"type1_evaluated", ratio(times.plain1_us, times.evaluated1_us)},
                     {"type2", ratio(times.plain2_us, times.type2_us)}}}});
}

void print_cell_text(Eigen::Index vertices, double radius, const CellTimes& times) {
  cli::print("{:8} {:6.0f} {:9.1f} {:9.1f} {:9.1f} {:9.1f} {:9.1f} {:8.1f} x {:6.1f} x {:6.1f} x "
             "{:9.0f} {:7.1f}\n",
             vertices, radius, times.plain1_us, times.type1_us, times.type1_2threads_us,
             times.type2_us, times.type2_2threads_us, ratio(times.plain1_us, times.type1_us),
             ratio(times.plain1_us, times.evaluated1_us), ratio(times.plain2_us, times.type2_us),
             times.grab_us, static_cast<double>(times.weight_bytes) / 1024.0);
  std::fflush(stdout);
}

void print_large(const LargeTimes& times, bool json) {
  const double floor_us = std::max(times.memory_us, times.arithmetic_us);
  if (json) {
    cli::print_line({{"vertices", times.vertices},
                     {"reached", times.reached},
                     {"influences", times.influences},
                     {"type1_us", times.type1_us},
                     {"type1_evaluated_us", times.evaluated1_us},
                     {"type2_us", times.type2_us},
                     {"memory_floor_us", times.memory_us},
                     {"arithmetic_floor_us", times.arithmetic_us},
                     {"of_floor",
                      {{"type1", times.type1_us / floor_us},
                       {"type1_evaluated", times.evaluated1_us / floor_us},
                       {"type2", times.type2_us / floor_us}}}});
    return;
  }
  cli::print("\n{} vertices, ten supports of a fifth of the model: {} vertices reached, {} "
             "influences\n",
             times.vertices, times.reached, times.influences);
  cli::print("  floors: memory {:.0f} us (24 bytes per reached vertex), arithmetic {:.0f} us\n",
             times.memory_us, times.arithmetic_us);
  cli::print("  type 1 {:.0f} us, {:.2f} of the larger floor; evaluated {:.0f} us, {:.2f}; type 2 "
             "{:.0f} us, "
             "{:.2f}\n",
             times.type1_us, times.type1_us / floor_us, times.evaluated1_us,
             times.evaluated1_us / floor_us, times.type2_us, times.type2_us / floor_us);
}

void bench_large(int cells, int repetitions, bool json) {
  if (has_memory_for_plane(cells, "bench deform"))
    print_large(measure_large(cells, repetitions), json);
}

void print_volume(const VolumeTimes& times, bool json) {
  if (json) {
    cli::print_line({{"vertices", times.vertices},
                     {"air_ns_an_influence", times.air_ns},
                     {"between_ns_an_influence", times.between_ns},
                     {"clay_ns_an_influence", times.clay_ns},
                     {"type1_us", times.type1_us},
                     {"type1_evaluated_us", times.evaluated1_us},
                     {"type1_clay_us", times.type1_clay_us},
                     {"type2_us", times.type2_us},
                     {"type2_clay_us", times.type2_clay_us}});
    return;
  }
  cli::print(
      "\n{} vertices, ten supports that reach all of them, displacements of a third of a radius\n"
      "  per influence: air {:.3f} ns, half of each {:.3f} ns, clay {:.3f} ns, {:.2f} times air\n"
      "  type 1: air {:.0f} us, evaluated {:.0f} us, clay {:.0f} us\n"
      "  type 2, steps of a twentieth of a radius: air {:.0f} us, clay {:.0f} us\n",
      times.vertices, times.air_ns, times.between_ns, times.clay_ns, times.clay_ns / times.air_ns,
      times.type1_us, times.evaluated1_us, times.type1_clay_us, times.type2_us,
      times.type2_clay_us);
}

int bench_deform(const Options& options) {
  if (const auto chosen = choose_simd(options.simd); !chosen) return cli::report(chosen.error());
  const int repetitions = options.short_form ? 3 : 60;
  if (!options.json) {
    cli::print(
        "microseconds per frame, the best of many; x: how many times as fast as the plain loop\n"
        "vertices radius     plain    type 1  2 threads   type 2  2 threads   type 1 "
        "evaluated  type 2      grab kB kept\n");
  }
  for (const reference::Table1Plane& mesh : reference::table1_planes) {
    if (options.short_form && mesh.cells > 64) continue;
    const deform::Points plane = reference::table1_plane(mesh.cells, mesh.with_middles);
    for (const double radius : reference::table1_radii) {
      const CellTimes times = measure_cell(plane, radius, repetitions);
      options.json ? print_cell_json(plane.cols(), radius, times)
                   : print_cell_text(plane.cols(), radius, times);
    }
  }
  print_volume(measure_volume(options.short_form ? 63 : 223, repetitions), options.json);
  if (options.short_form) {
    bench_large(150, repetitions, options.json);
  } else {
    bench_large(1000, repetitions, options.json);
    bench_large(3161, repetitions / 6, options.json);
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::deform_bench

void nendo::bench::add_deform(cli::Command& bench) {
  using namespace deform_bench;
  cli::Command command = bench.add_command(
      "deform", "Measures both types of deformation, beside a plain loop and the machine's floors");
  Options& options = command.on_chosen<Options>(bench_deform);
  add_simd_option(command, options.simd);
  command.add_flag("--short", options.short_form,
                   "Measure only the two smaller meshes, with few repetitions");
  command.add_flag("--json", options.json, "One JSON object per line");
}
