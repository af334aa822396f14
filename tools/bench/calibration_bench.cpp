// nendo bench calibration: how well the guided poses calibrate, on synthetic wearers whose joints
// are known. Everything about them was tuned on seeds 1 to 60; figures are to be quoted from other
// seeds, as the default's.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "bench/bench.hpp"
#include "bench/calibration_trial.hpp"
#include "bench/judge_bench.hpp"
#include "bench/percentiles.hpp"
#include "bench/text_table.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::calibration_bench {
namespace {

struct Options {
  std::uint64_t wearers = 60;
  std::uint64_t seed = 3001;
  bool json = false;
  bool markdown = false;
  std::string judge;
  bool floor = false;
};

struct Figures {
  double median = 0.0;
  double p95 = 0.0;
};

template <class Number>
Figures figures_of(const std::vector<Number>& values) {
  return {percentile(values, 0.5), percentile(values, 0.95)};
}

/// Groups, and then families of them.
constexpr std::size_t row_count = group_names.size() + families.size();

std::string_view row_name(std::size_t row) {
  return row < group_names.size() ? group_names[row] : families[row - group_names.size()].name;
}

Figures row_figures(const TrialErrors& errors, std::size_t method, std::size_t row) {
  if (row < group_names.size()) return figures_of(errors.deg[method][row]);
  const JointFamily& family = families[row - group_names.size()];
  std::vector<float> all;
  for (std::size_t group = family.first_group; group < family.end_group; ++group)
    all.insert(all.end(), errors.deg[method][group].begin(), errors.deg[method][group].end());
  return figures_of(all);
}

void print_json(const TrialErrors& errors, std::uint64_t refused, const Options& options) {
  nlohmann::ordered_json groups;
  for (std::size_t row = 0; row < row_count; ++row) {
    for (std::size_t method = 0; method < method_names.size(); ++method) {
      const Figures deg = row_figures(errors, method, row);
      groups[std::string(row_name(row))][std::string(method_names[method])] = {
          {"median_deg", deg.median}, {"p95_deg", deg.p95}};
    }
  }
  cli::print_line(
      {{"wearers", options.wearers},
       {"first_seed", options.seed},
       {"refused", refused},
       {"fit_ms",
        {{"median", figures_of(errors.fit_ms).median}, {"p95", figures_of(errors.fit_ms).p95}}},
       {"condition_median", figures_of(errors.condition).median},
       {"touch_gap_m_p95", figures_of(errors.touch_gap_m).p95},
       {"groups", groups}});
}

void print_table(const TrialErrors& errors, bool markdown) {
  std::vector<std::string> cells(method_names.begin(), method_names.end());
  cells.emplace_back("full / two_pose");
  print_head("joints", cells, markdown);
  for (std::size_t at = 0; at < row_count; ++at) {
    std::array<Figures, method_names.size()> deg;
    cells.clear();
    for (std::size_t method = 0; method < method_names.size(); ++method) {
      deg[method] = row_figures(errors, method, at);
      cells.push_back(fmt::format("{:.2f} / {:.2f}", deg[method].median, deg[method].p95));
    }
    cells.push_back(fmt::format("{:15.2f}", deg[0].median / std::max(deg[1].median, 1e-9)));
    print_row(row_name(at), cells, markdown);
  }
}

void print_text(const TrialErrors& errors, std::uint64_t refused, const Options& options) {
  cli::print("{} synthetic wearers, seeds {} to {}, {} refused; error of the joints' "
             "angles over free motion in degrees, median / 95th percentile{}\n",
             options.wearers, options.seed, options.seed + options.wearers - 1, refused,
             options.markdown ? "\n" : "");
  print_table(errors, options.markdown);
  cli::print(
      "{}fit: {:.1f} ms, condition {:.0f} (medians); 95% of touches are closed to {:.1f} mm\n",
      options.markdown ? "\n" : "", figures_of(errors.fit_ms).median,
      figures_of(errors.condition).median, 1e3 * figures_of(errors.touch_gap_m).p95);
}

int bench_calibration(const Options& options) {
  if (options.floor && options.judge.empty())
    return cli::report(
        {Errc::usage, "--floor: needs --judge FILE, a file of `nendo bench wearers`"});
  if (!options.judge.empty())
    return judge_bench::judge_file(options.judge, {options.json, options.markdown, options.floor});
  if (options.wearers == 0 || options.wearers > 10'000)
    return cli::report({Errc::usage, "--wearers: use 1 to 10000"});
  cli::install_stop_signals();
  TrialErrors errors;
  std::uint64_t refused = 0;
  for (std::uint64_t n = 0; n < options.wearers; ++n) {
    if (cli::stop_requested())
      return cli::report({Errc::failed, "stopped before all wearers were calibrated"});
    const auto done = try_wearer(options.seed + n, errors);
    if (done) continue;
    ++refused;
    cli::note("wearer " + std::to_string(options.seed + n) + ": " + done.error().message);
  }
  options.json ? print_json(errors, refused, options) : print_text(errors, refused, options);
  return refused < options.wearers ? 0
                                   : cli::report({Errc::failed, "no wearer could be calibrated"});
}

} // namespace
} // namespace nendo::bench::calibration_bench

void nendo::bench::add_calibration(cli::Command& bench) {
  using namespace calibration_bench;
  cli::Command command = bench.add_command(
      "calibration",
      "Measures the accuracy of guided calibration, on synthetic wearers with known joints");
  Options& options = command.on_chosen<Options>(bench_calibration);
  command.add_option("--wearers", options.wearers, "Number of wearers, 1 to 10000");
  command.add_option("--seed", options.seed,
                     "Seed of the first wearer; 1 to 60 were used for tuning");
  command.add_flag("--json", options.json, "One JSON object");
  command.add_flag("--markdown", options.markdown, "A table in Markdown");
  command.add_flag("--floor", options.floor,
                   "With --judge: also report the floor, the accuracy of an estimator that has the "
                   "true hand and the form of the errors");
  command.add_option("--judge", options.judge,
                     "Calibrate the wearers of this file, which `nendo bench wearers` writes, in "
                     "place of new ones");
}
