// nendo bench scale: how the deformation's cost grows with vertices and control points.

#include <cstdio>

#include <nlohmann/json.hpp>

#include "bench/bench.hpp"
#include "bench/plane_memory.hpp"
#include "bench/scale_trial.hpp"
#include "bench/simd_choice.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::scale_bench {
namespace {

struct Options {
  std::string simd;
  std::uint64_t repetitions = 20;
  bool short_form = false;
  bool json = false;
};

double per(double what, std::size_t count) {
  return what / static_cast<double>(count);
}

void print(const GrowthTimes& times, bool json) {
  if (json) {
    cli::print_line({{"measured", "vertices"},
                     {"vertices", times.vertices},
                     {"influences", times.influences},
                     {"type1_evaluated_us", times.type1_us},
                     {"type2_us", times.type2_us},
                     {"type1_bytes", times.type1_bytes},
                     {"type2_bytes", times.type2_bytes}});
    return;
  }
  cli::print("{:9} {:11} {:9.0f} {:9.0f} {:9.2f} {:9.2f} {:9.0f} {:9.0f}\n", times.vertices,
             times.influences, times.type1_us, times.type2_us,
             per(1e3 * times.type1_us, times.vertices), per(1e3 * times.type2_us, times.vertices),
             per(static_cast<double>(times.type1_bytes), times.vertices),
             per(static_cast<double>(times.type2_bytes), times.vertices));
  std::fflush(stdout);
}

void print(const CrowdTimes& times, bool json) {
  if (json) {
    cli::print_line(
        {{"measured", "centres"},
         {"vertices", times.vertices},
         {"centres", times.centres},
         {"influences", times.influences},
         {"build_us", times.build_us},
         {"solve_us", times.solve_us},
         {"list_us", times.list_us},
         {"evaluate_us", times.evaluate_us},
         {"influence_ns", times.ns_an_influence()},
         {"influence_of_ten_ns", times.ten_ns},
         {"ratio",
          {{"influence_to_ten", times.ns_an_influence() / times.ten_ns},
           {"list_to_evaluation", times.list_us / (times.evaluate_us - times.list_us)}}}});
    return;
  }
  cli::print("{:9} {:8} {:11.1f} {:9.0f} {:9.0f} {:9.0f} {:9.0f} {:9.3f} {:9.3f} {:6.2f} x\n",
             times.vertices, times.centres,
             per(static_cast<double>(times.influences), times.vertices), times.build_us,
             times.solve_us, times.list_us, times.evaluate_us, times.ns_an_influence(),
             times.ten_ns, times.ns_an_influence() / times.ten_ns);
  std::fflush(stdout);
}

void heading(const Options& options, const char* text) {
  if (!options.json) cli::print("{}", text);
}

void bench_growth(const Options& options, int repetitions) {
  heading(options,
          "ten supports of a fifth of the model, microseconds per frame; memory of a deformer and "
          "of its shape\n vertices  influences    type 1    type 2  ns/vert.  ns/vert.  B/vert.  "
          "  B/vert.\n");
  for (const int cells : {315, 999, 3161}) {
    if (options.short_form && cells > 315) break;
    if (has_memory_for_plane(cells, "bench scale"))
      print(measure_growth(cells, repetitions), options.json);
  }
}

int bench_scale(const Options& options) {
  if (options.repetitions == 0 || options.repetitions > 10'000)
    return cli::report({Errc::usage, "--repetitions: use 1 to 10000"});
  if (const auto chosen = choose_simd(options.simd); !chosen) return cli::report(chosen.error());
  const auto repetitions = static_cast<int>(options.repetitions);
  bench_growth(options, repetitions);
  heading(options,
          "\nmany small supports, microseconds; an influence beside one of ten supports "
          "that reach every vertex\n vertices  centres  infl./vert.    build     solve     "
          "lists  evaluate  ns/infl.   of ten    ratio\n");
  const int cells = options.short_form ? 199 : 999;
  for (const double overlap : {9.0, 26.0})
    print(measure_crowd(cells, 1000, overlap, repetitions), options.json);
  return 0;
}

} // namespace
} // namespace nendo::bench::scale_bench

void nendo::bench::add_scale(cli::Command& bench) {
  using namespace scale_bench;
  cli::Command command = bench.add_command(
      "scale",
      "Measures how the cost of the deformation grows: ten million vertices, a thousand centres");
  Options& options = command.on_chosen<Options>(bench_scale);
  add_simd_option(command, options.simd);
  command.add_option("--repetitions", options.repetitions,
                     "Number of repetitions, of which the best counts");
  command.add_flag("--short", options.short_form, "Measure at most a hundred thousand vertices");
  command.add_flag("--json", options.json, "One JSON object per line");
}
