// nendo stress: how punctual the loop is on this machine, and why not.

#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "cli/json_line.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "cli/terminal.hpp"
#include "nendo/commands.hpp"
#include "session/live_view.hpp"
#include "session/setting_options.hpp"
#include "stress/report.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::stress_command {
namespace {

using nlohmann::ordered_json;

Result<ordered_json> read_earlier(const std::string& path) {
  if (path.empty()) return ordered_json(nullptr);
  constexpr std::uint64_t max_bytes = 1U << 20U;
  const auto text = read_file(path, max_bytes, "report of nendo stress");
  if (!text) return text.error();
  auto report = ordered_json::parse(*text, nullptr, false);
  if (!report.is_object() || report.value("event", ordered_json()) != "stress") {
    return Error{Errc::bad_input,
                 path + ": not a report of nendo stress; `nendo stress --json >FILE` writes one"};
  }
  return report;
}

stress::StressProgress progress_for(const stress::StressOptions& options) {
  const bool terminal = cli::obeys_codes(STDERR_FILENO);
  return [terminal, next_s = 2.0, duration_s = options.run.duration_s](
             const stress::TickTally& tally, double elapsed_s) mutable {
    if (!terminal && elapsed_s < next_s) return;
    next_s += 2.0;
    const auto& lateness = tally[stress::Measure::lateness].raw;
    const std::string line = fmt::format(
        "{:5.1f} of {:.1f} s  {} ticks, lateness p50 {:.1f} us, p99 {:.1f} us, max {:.1f} us",
        elapsed_s, duration_s, tally.ticks(), to_microseconds(lateness.percentile(0.5)),
        to_microseconds(lateness.percentile(0.99)), to_microseconds(lateness.max()));
    std::cerr << (terminal ? "\r" : "") << line << (terminal ? "\x1b[K" : "\n") << std::flush;
  };
}

Result<void> write_files(const stress::StressArguments& arguments,
                         const stress::StressOptions& options,
                         const stress::StressOutcome& outcome) {
  if (!arguments.hgrm.empty()) {
    const auto& lateness = outcome.tally[stress::Measure::lateness].corrected;
    if (const auto done = replace_file(arguments.hgrm, stress::hgrm(lateness)); !done)
      return done.error();
  }
  if (arguments.picture.empty()) return {};
  return replace_file(arguments.picture, stress::stress_picture(options, outcome));
}

Result<void> check_files(const stress::StressArguments& arguments) {
  if (auto fine = cli::check_place("--hgrm", arguments.hgrm); !fine) return fine;
  return cli::check_place("--picture", arguments.picture);
}

int run(const stress::StressArguments& arguments) {
  const auto options = stress::parse(arguments);
  if (!options) return cli::report(options.error());
  if (const auto fine = check_files(arguments); !fine) return cli::report(fine.error());
  const auto earlier = read_earlier(arguments.compare);
  if (!earlier) return cli::report(earlier.error());
  const auto model = takes::read_models(options->run.mesh, takes::reading(arguments.up));
  if (!model) return cli::report(model.error());
  cli::install_stop_signals();
  std::unique_ptr<session::Observer> window;
  if (arguments.view) {
    auto opened = session::open_live_view({}, options->run);
    if (!opened) return cli::report(opened.error());
    window = *std::move(opened);
  }
  const auto outcome =
      stress::run_stress(*options, model->mesh, progress_for(*options), window.get());
  if (cli::obeys_codes(STDERR_FILENO)) std::cerr << "\r\x1b[K";
  if (!outcome) return cli::report(outcome.error());
  ordered_json results = stress::stress_json(*options, **outcome);
  results["model_notes"] = cli::model_notes();
  if (arguments.json) {
    cli::print_line(results);
  } else {
    stress::print_stress(stdout, *options, **outcome, *earlier);
  }
  if (arguments.histogram_us && !arguments.json)
    stress::print_histogram((*outcome)->tally[stress::Measure::lateness].raw,
                            *arguments.histogram_us);
  if (const auto done = write_files(arguments, *options, **outcome); !done)
    return cli::report(done.error());
  const std::string difference =
      earlier->is_object() ? stress::different_work(*earlier, results) : std::string();
  if (!difference.empty())
    cli::note("--compare " + arguments.compare +
              ": was measured with other work: " + printable(difference));
  const auto bad = stress::fulfilled(options->conditions, results);
  for (const auto& line : bad)
    cli::note("--fail-if " + line);
  if ((*outcome)->broke) cli::note("--break: a tick was later than that");
  return bad.empty() ? 0 : static_cast<int>(Errc::failed);
}

void add_reports(cli::Command& command, stress::StressArguments& arguments) {
  command.add_flag("--json", arguments.json, "The report as one JSON object").under("Report");
  command
      .add_option("-h,--histogram", arguments.histogram_us,
                  "Print the lateness, a line a microsecond, up to this many microseconds")
      .under("Report");
  command.add_option("--hgrm", arguments.hgrm, "Write an HdrHistogram percentile file")
      .under("Report");
  command.add_option("--picture", arguments.picture, "Draw the lateness, as SVG").under("Report");
  command
      .add_option("--compare", arguments.compare, "Show an earlier report (--json) beside this one")
      .under("Report");
  command
      .add_option("--fail-if", arguments.fail_if,
                  "Exit with 1 if a figure is so, like 'p99.9>200us,missed>0'")
      .under("Report");
}

} // namespace

void add(cli::Command& program) {
  auto arguments = std::make_shared<stress::StressArguments>();
  cli::Command command = program.add_command(
      "stress", "Tests how punctual the loop is on this machine, and says what made it late");
  command.free_short_help();
  command.set_footer("It asks for real-time rights and says which were refused; without any it "
                     "measures what an ordinary thread gets.");
  command.add_microseconds("-i,--interval", arguments->interval_us,
                           "From tick to tick, 100us to 1s; a bare number is microseconds");
  command.add_option("-D,--duration", arguments->duration,
                     "How long: seconds, or 90s, 10m, 2h, 1d");
  command.add_option("--stages", arguments->stages,
                     "What a tick does: sleep, input, hands, deform, publish, with commas");
  command.add_option("--load", arguments->load,
                     "Work beside it, by processes of its own: cpu, mem, io, with commas");
  command.add_microseconds("-b,--break", arguments->break_us,
                           "End at a tick that is later than this, e.g. 200us; a bare number is "
                           "microseconds");
  command.add_duration("--floor", arguments->floor_s,
                       "Seconds to look at the machine alone before; 0: do not");
  command.add_option("--left", arguments->run.left, "GLOVE on the left hand; without any, two sim");
  command.add_option("--right", arguments->run.right, "GLOVE on the right hand");
  command.add_option("MODEL,--mesh", arguments->run.mesh,
                     "OBJ, PLY, STL or glTF file; without it, the shipped Moai");
  takes::add_up_option(command, arguments->up);
  session::add_setting(command, flow::setting::mode, arguments->mode);
  command.add_option("--changes", arguments->changes_a_minute,
                     "Changes the radius so many times a minute, in every other second, and counts "
                     "the seconds with and without apart");
  command.add_option(std::string(flow::setting::radius.option), arguments->radius,
                     std::string(flow::setting::radius.help));
  command.add_flag("--view", arguments->view,
                   "Looks on with the live window, to see what that costs the loop");
  arguments->loop.add_to(command, true);
  add_reports(command, *arguments);
  command.on_chosen([arguments] { return run(*arguments); });
}

} // namespace nendo::app::stress_command
