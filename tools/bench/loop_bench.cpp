// nendo bench rt, the loop: beside cyclictest, with its spin tail, and with all of its work.

#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <tuple>

#include <nlohmann/json.hpp>

#include "bench/cyclictest.hpp"
#include "bench/rt_bench.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"
#include "stress/stress_session.hpp"

namespace nendo::bench {
namespace {

constexpr unsigned interval_us = 1000;

/// A ball with 33,025 vertices, the greatest of the paper's meshes: 129 rings of 256, and a pole.
deform::Mesh paper_sized_ball() {
  constexpr Eigen::Index rings = 129;
  constexpr Eigen::Index around = 256;
  deform::Mesh ball;
  ball.vertices.resize(3, rings * around + 1);
  for (Eigen::Index ring = 0; ring < rings; ++ring) {
    const double down =
        std::numbers::pi * static_cast<double>(ring + 1) / static_cast<double>(rings + 1);
    for (Eigen::Index k = 0; k < around; ++k) {
      const double turn =
          2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(around);
      ball.vertices.col(ring * around + k) << std::sin(down) * std::cos(turn), std::cos(down),
          std::sin(down) * std::sin(turn);
    }
  }
  ball.vertices.col(rings * around) << 0.0, 1.0, 0.0;
  constexpr auto side = static_cast<std::uint32_t>(around);
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t k = 0; k < side; ++k) {
      const std::uint32_t a = ring * side + k;
      const std::uint32_t b = ring * side + (k + 1) % side;
      ball.face_corners.insert(ball.face_corners.end(), {a, b, b + side, a + side});
      ball.face_starts.push_back(static_cast<std::uint32_t>(ball.face_corners.size()));
    }
  }
  return ball;
}

/// What is measured: the wait alone, or all of a tick.
stress::StressArguments arguments_for(const RtOptions& options, const char* stages,
                                      const char* spin, const char* load) {
  stress::StressArguments arguments;
  arguments.interval_us = interval_us;
  arguments.duration = std::to_string(options.seconds);
  arguments.stages = stages;
  arguments.load = load;
  arguments.floor_s = 0.0;
  arguments.loop.lock_memory = true;
  arguments.loop.spin = spin;
  return arguments;
}

Result<std::unique_ptr<stress::StressOutcome>> measure(const stress::StressArguments& arguments,
                                                       const deform::Mesh& model) {
  auto wanted = stress::parse(arguments);
  if (!wanted) return wanted.error();
  auto outcome =
      stress::run_stress(*std::move(wanted), model, [](const stress::TickTally&, double) {});
  if (!outcome) return outcome;
  if ((*outcome)->stopped) return Error{Errc::failed, "stopped before all was measured"};
  const auto refused = flow::refusals((*outcome)->grants);
  if (!refused.empty()) return Error{Errc::no_permission, refused.front()};
  return outcome;
}

double us(const flow::Histogram& histogram, double fraction) {
  return to_microseconds(histogram.percentile(fraction));
}

/// Prints a figure beside its goal, which is a maximum.
void report_figure(const RtOptions& options, const std::string& part, const std::string& figure,
                   double value, double at_most) {
  const bool met = value <= at_most;
  if (options.json) {
    cli::print_line({{"part", "loop"},
                     {"of", part},
                     {"figure", figure},
                     {"value", value},
                     {"at_most", at_most},
                     {"met", met}});
    return;
  }
  cli::print("  {:34} {:24} {:9.3f}, goal at most {:<7g} {}\n", part, figure, value, at_most,
             met ? "met" : "MISSED");
  std::fflush(stdout);
}

// Both run at once, each on a CPU, and then exchange CPUs, so that differences of the CPUs cancel.
Result<void> beside_cyclictest(const RtOptions& options, const deform::Mesh& model) {
  if (std::thread::hardware_concurrency() < 2)
    return Error{Errc::failed, "beside cyclictest: needs two CPUs"};
  flow::Histogram theirs;
  flow::Histogram ours;
  for (const unsigned cpu : {0U, 1U}) {
    auto arguments = arguments_for(options, "sleep", "off", "");
    arguments.loop.affinity = std::to_string(cpu);
    auto neighbour = Cyclictest::start(1 - cpu, options.seconds, interval_us);
    if (!neighbour) return neighbour.error();
    const auto outcome = measure(arguments, model);
    if (!outcome) return outcome.error();
    const auto latencies = neighbour->finish();
    if (!latencies) return latencies.error();
    const auto add = [](flow::Histogram& sum) {
      return [&sum](auto value, std::uint64_t count) { sum.record(value, count); };
    };
    latencies->for_each(add(theirs));
    (*outcome)->tally[stress::Measure::lateness].raw.for_each(add(ours));
  }
  if (!options.json) {
    cli::print("  loop p50 {:.1f} us, p99 {:.1f} us; cyclictest {:.0f} us, {:.0f} us (in whole "
               "microseconds)\n",
               us(ours, 0.5), us(ours, 0.99), us(theirs, 0.5), us(theirs, 0.99));
  }
  report_figure(options, "loop / cyclictest", "p50 ratio", us(ours, 0.5) / us(theirs, 0.5), 1.2);
  report_figure(options, "loop / cyclictest", "p99 ratio", us(ours, 0.99) / us(theirs, 0.99), 1.2);
  return {};
}

Result<void> spinning(const RtOptions& options, const deform::Mesh& model) {
  for (const auto& [load, name, p99_us] :
       {std::tuple{"", "spin tail, idle", 1.0}, {"cpu,mem,io", "spin tail, under load", 15.0}}) {
    const auto outcome = measure(arguments_for(options, "sleep", "on", load), model);
    if (!outcome) return outcome.error();
    const auto& lateness = (*outcome)->tally[stress::Measure::lateness].raw;
    report_figure(options, name, "p50 us", us(lateness, 0.5), 0.1);
    report_figure(options, name, "p99 us", us(lateness, 0.99), p99_us);
    report_figure(options, name, "% of a CPU",
                  100.0 * (*outcome)->costs.cpu_s / (*outcome)->elapsed_s, 6.0);
  }
  return {};
}

Result<void> whole_pipeline(const RtOptions& options, const deform::Mesh& model) {
  auto arguments = arguments_for(options, "sleep,input,hands,deform,publish", "off", "");
  arguments.run.left = arguments.run.right = "sim?rate=1000"; // no tick without something to do
  const auto outcome = measure(arguments, model);
  if (!outcome) return outcome.error();
  const stress::TickTally& tally = (*outcome)->tally;
  const std::string part = std::to_string(model.vertices.cols()) + " vertices, two hands";
  report_figure(options, part, "work p99 us", us(tally[stress::Measure::work].raw, 0.99), 300.0);
  report_figure(options, part, "page faults", static_cast<double>((*outcome)->costs.minor_faults),
                0.0);
  return {};
}

} // namespace

Result<void> measure_loop(const RtOptions& options) {
  const deform::Mesh model = paper_sized_ball();
  if (!options.json) {
    cli::print("the loop at {} Hz under SCHED_FIFO 80, {} s per measurement\n",
               1'000'000 / interval_us, options.seconds);
  }
  for (const auto part : {beside_cyclictest, spinning, whole_pipeline}) {
    if (auto done = part(options, model); !done) return done;
  }
  return {};
}

} // namespace nendo::bench
