// Two commands: the table of a judgement, and the file of strangers to be judged by.

#include "bench/judge_bench.hpp"

#include <cmath>
#include <fstream>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

#include "bench/bench.hpp"
#include "bench/calibration_judge.hpp"
#include "bench/percentiles.hpp"
#include "bench/stranger.hpp"
#include "bench/text_table.hpp"
#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"

namespace nendo::bench {
namespace judge_bench {
namespace {

/// The goals of the full calibration, median and 95th percentile.
constexpr std::array<std::array<double, 2>, judged_groups.size()> goals{{{2.0, 5.5},
                                                                         {1.6, 4.5},
                                                                         {1.6, 5.0},
                                                                         {1.2, 4.0},
                                                                         {3.5, 11.0},
                                                                         {2.5, 8.0},
                                                                         {2.2, 7.0},
                                                                         {2.0, 6.0},
                                                                         {3.0, 8.0},
                                                                         {3.0, 8.0}}};

/// The true hand of a stranger, who is known by the name. Error: bad_input, of others.
Result<StrangerHand> true_hand(const JudgedWearer& wearer) {
  std::string_view name = wearer.name;
  const bool is_stranger = cut(name, ' ') == "stranger";
  const auto seed = number_in<std::uint64_t>(name);
  const Error other{
      Errc::bad_input,
      wearer.name +
          ": not written by `nendo bench wearers`, so its true hand is unknown; leave out --floor"};
  if (!is_stranger || !seed) return other;
  StrangerHand hand = hand_of_stranger(*seed);
  constexpr double rounded_m = 1e-5; // in the file
  for (std::size_t digit = 0; digit < wearer.pads.size(); ++digit)
    if (!(std::abs(hand.pads()[digit].depth - wearer.pads[digit].depth_m) < rounded_m))
      return other;
  return hand;
}

bool has_floor(const Verdict& verdict) {
  return !verdict.errors.back().front().empty();
}
std::size_t columns_of(const Verdict& verdict) {
  return has_floor(verdict) ? judged_names.size() : static_cast<std::size_t>(Judged::floor);
}

void print_judged_json(const Verdict& verdict) {
  nlohmann::ordered_json groups;
  for (std::size_t group = 0; group < judged_groups.size(); ++group) {
    auto& row = groups[std::string(judged_groups[group])];
    for (std::size_t method = 0; method < columns_of(verdict); ++method) {
      const auto& errors = verdict.errors[method][group];
      row[std::string(judged_names[method])] = {{"median", percentile(errors, 0.5)},
                                                {"p95", percentile(errors, 0.95)}};
    }
    row["goal"] = {{"median", goals[group][0]}, {"p95", goals[group][1]}};
    row["worse_than_two_pose"] = verdict.worse[group];
    if (has_floor(verdict)) row["floor_worse_than_two_pose"] = verdict.floor_worse[group];
  }
  cli::print_line({{"wearers", verdict.wearers},
                   {"refused", verdict.refused},
                   {"fit_ms_median", percentile(verdict.fit_ms, 0.5)},
                   {"groups", groups}});
}

void print_judged_table(const Verdict& verdict, bool markdown) {
  const std::size_t columns = columns_of(verdict);
  std::vector<std::string> cells(judged_names.begin(),
                                 judged_names.begin() + static_cast<std::ptrdiff_t>(columns));
  cells.emplace_back("goal for full");
  cells.emplace_back(has_floor(verdict) ? "worse than two_pose (floor)" : "worse than two_pose");
  print_head("group", cells, markdown);
  for (std::size_t group = 0; group < judged_groups.size(); ++group) {
    cells.clear();
    const auto add_figures = [&](double median, double p95) {
      cells.push_back(fmt::format("{:.2f} / {:.1f}", median, p95));
    };
    for (std::size_t method = 0; method < columns; ++method) {
      const auto& errors = verdict.errors[method][group];
      add_figures(percentile(errors, 0.5), percentile(errors, 0.95));
    }
    cells.push_back(fmt::format("{:.1f} / {:.1f}", goals[group][0], goals[group][1]));
    cells.push_back(fmt::format("{:12} of {}", verdict.worse[group], verdict.wearers));
    if (has_floor(verdict)) cells.back() += fmt::format(" ({})", verdict.floor_worse[group]);
    print_row(judged_groups[group], cells, markdown);
  }
}

} // namespace

int judge_file(const std::string& path, const Output& output) {
  auto wearers = JudgedWearers::open(path);
  if (!wearers) return cli::report(wearers.error());
  cli::install_stop_signals();
  Verdict verdict;
  for (;;) {
    if (cli::stop_requested())
      return cli::report({Errc::failed, "stopped before all wearers were calibrated"});
    const auto wearer = wearers->next();
    if (!wearer) return cli::report(wearer.error());
    if (!*wearer) break;
    if (output.floor) {
      const auto hand = true_hand(**wearer);
      if (!hand) return cli::report(hand.error());
      judge(**wearer, verdict, &*hand);
    } else {
      judge(**wearer, verdict);
    }
  }
  if (verdict.wearers == 0) return cli::report({Errc::bad_input, path + ": has no wearers"});
  if (output.json) {
    print_judged_json(verdict);
    return 0;
  }
  for (const std::string& refused : verdict.refused)
    cli::note("refused: " + refused);
  cli::print("{} wearers, {} refused; errors in degrees, median / 95th percentile; fit {:.0f} ms "
             "(median){}\n",
             verdict.wearers, verdict.refused.size(), percentile(verdict.fit_ms, 0.5),
             output.markdown ? "\n" : "");
  print_judged_table(verdict, output.markdown);
  return 0;
}

} // namespace judge_bench

namespace wearers_bench {
namespace {

struct Options {
  std::string out;
  std::uint64_t wearers = 200;
  std::uint64_t seed = 6001;
  std::uint32_t sensors = 22;
  std::string without; ///< an error term
  std::string only;
};

/// The error term of a name; nullptr if it is none.
double* term_of(StrangerErrors& errors, const std::string& name) {
  if (name == "curvature") return &errors.curvature;
  if (name == "hysteresis") return &errors.hysteresis;
  if (name == "creep") return &errors.creep;
  if (name == "cross-talk") return &errors.cross_talk;
  if (name == "scatter") return &errors.scatter;
  if (name == "slip") return &errors.slip;
  return nullptr;
}

Result<StrangerErrors> errors_of(const Options& options) {
  StrangerErrors errors;
  if (!options.only.empty()) errors = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  for (const auto& [name, part] : {std::pair{options.without, 0.0}, std::pair{options.only, 1.0}}) {
    if (name.empty() || name == "none") continue;
    double* const term = term_of(errors, name);
    if (term == nullptr)
      return Error{Errc::usage, name + ": no such error term; use curvature, hysteresis, creep, "
                                       "cross-talk, scatter, slip or none"};
    *term = part;
  }
  return errors;
}

int write_wearers(const Options& options) {
  if (options.wearers == 0 || options.wearers > 10'000)
    return cli::report({Errc::usage, "--wearers: use 1 to 10000"});
  if (options.sensors != 22 && options.sensors != 18)
    return cli::report({Errc::usage, "--sensors: use 18 or 22"});
  const auto errors = errors_of(options);
  if (!errors) return cli::report(errors.error());
  if (options.out.empty())
    return cli::report({Errc::usage, "--out is missing: the file to write, e.g. wearers.jsonl"});
  if (const auto fine = cli::check_place("--out", options.out); !fine)
    return cli::report(fine.error());
  std::ofstream file(options.out);
  for (std::uint64_t n = 0; n < options.wearers && file; ++n)
    file << line_of(
        make_stranger(options.seed + n, options.sensors == 22 ? sensors_22 : sensors_18, *errors));
  file.close();
  return file ? 0 : cli::report({Errc::failed, options.out + ": cannot be written"});
}

} // namespace
} // namespace wearers_bench
} // namespace nendo::bench

void nendo::bench::add_wearers(cli::Command& bench) {
  using namespace wearers_bench;
  cli::Command command = bench.add_command(
      "wearers",
      "Writes synthetic wearers of another model, for `nendo bench calibration --judge`");
  Options& options = command.on_chosen<Options>(write_wearers);
  command.add_option("--out", options.out, "The file to write, one JSON object per line");
  command.add_option("--wearers", options.wearers, "Number of wearers, 1 to 10000");
  command.add_option("--seed", options.seed,
                     "Seed of the first wearer; 1 to 300 were used for tuning");
  command.add_option("--sensors", options.sensors,
                     "Number of sensors: 22, or 18 for a glove without DIP sensors");
  command.add_option("--without", options.without, "An error term that these wearers do not have");
  command.add_option("--only", options.only, "The only error term that they have, or none");
}
