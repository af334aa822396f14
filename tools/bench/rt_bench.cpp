// nendo bench rt: what real time rests on, part by part.

#include "bench/rt_bench.hpp"

#include <array>
#include <string>

#include "bench/bench.hpp"
#include "cli/cli.hpp"

namespace nendo::bench::rt_bench {
namespace {

struct Part {
  const char* name;
  Result<void> (*measure)(const RtOptions& options);
};
constexpr std::array parts{Part{"rings", measure_rings}, Part{"handoff", measure_handoff},
                           Part{"loop", measure_loop}};

struct Options {
  RtOptions rt;
  std::string part = "all";
};

int bench_rt(const Options& options) {
  if (options.rt.rounds == 0 || options.rt.rounds > 10'000)
    return cli::report({Errc::usage, "--rounds: use 1 to 10000"});
  if (options.rt.seconds < 1 || options.rt.seconds > 3600)
    return cli::report({Errc::usage, "--seconds: use 1 to 3600"});
  cli::install_stop_signals();
  for (const Part& part : parts) {
    if (options.part != "all" && options.part != part.name) continue;
    const auto done = part.measure(options.rt);
    if (!done) return cli::report(done.error());
  }
  return 0;
}

} // namespace
} // namespace nendo::bench::rt_bench

void nendo::bench::add_rt(cli::Command& bench) {
  using namespace rt_bench;
  cli::Command command =
      bench.add_command("rt", "Measures rings, the hand-off of frames and the loop, beside other "
                              "implementations in the same run");
  Options& options = command.on_chosen<Options>(bench_rt);
  command.add_option("--part", options.part, "The part to measure")
      .one_of({"all", "rings", "handoff", "loop"});
  command.add_option("--rounds", options.rt.rounds,
                     "Number of measurements of each ring and hand-off");
  command.add_option("--seconds", options.rt.seconds, "Seconds per measurement of the loop");
  command.add_flag("--json", options.rt.json, "One JSON object per line");
}
