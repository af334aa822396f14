// nendo stress: measures jitter and missed deadlines of the loop on this machine.

#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "cli/terminal.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"
#include "session/setting_options.hpp"
#include "session/views.hpp"
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
  const bool terminal = cli::has_control_codes(STDERR_FILENO);
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
    const auto opened = session::open_window({});
    if (!opened) return cli::report(opened.error());
    window = session::live_view({}, options->run, *opened);
  }
  const auto outcome =
      stress::run_stress(*options, model->mesh, progress_for(*options), window.get());
  if (cli::has_control_codes(STDERR_FILENO)) std::cerr << "\r\x1b[K";
  if (!outcome) return cli::report(outcome.error());
  ordered_json results = stress::stress_json(*options, **outcome);
  results["model_notes"] = cli::model_notes();
  if (arguments.json) {
    cli::print_line(results);
  } else {
    stress::print_stress(stdout, *options, **outcome, results, *earlier);
  }
  if (arguments.histogram_us && !arguments.json)
    stress::print_histogram((*outcome)->tally[stress::Measure::lateness].raw,
                            *arguments.histogram_us);
  if (const auto done = write_files(arguments, *options, **outcome); !done)
    return cli::report(done.error());
  if (!arguments.json) {
    report_written(arguments.hgrm);
    report_written(arguments.picture);
  }
  const std::string difference =
      earlier->is_object() ? stress::different_work(*earlier, results) : std::string();
  if (!difference.empty())
    cli::note("--compare " + arguments.compare +
              ": was measured with other options: " + printable(difference));
  const auto bad = stress::fulfilled(options->conditions, results);
  for (const auto& line : bad)
    cli::note("--fail-if " + line);
  if ((*outcome)->broke) cli::note("--break: a tick was later than this limit");
  return bad.empty() ? 0 : static_cast<int>(Errc::failed);
}

void add_reports(cli::Command command, stress::StressArguments& arguments) {
  command.add_flag("--json", arguments.json, "The report as one JSON object");
  command.add_option(
      "-h,--histogram", arguments.histogram_us,
      "Print the lateness, one line per microsecond, up to this number of microseconds");
  command.add_option("--hgrm", arguments.hgrm, "Write an HdrHistogram percentile file");
  command.add_option("--picture", arguments.picture, "Draw the lateness as SVG");
  command.add_option("--compare", arguments.compare,
                     "Show an earlier report (--json) beside this one");
  command.add_option("--fail-if", arguments.fail_if,
                     "Exit with 1 if one of these conditions is true, like 'p99.9>200us,missed>0'");
}

} // namespace
} // namespace nendo::app::stress_command

void nendo::app::add_stress(cli::Command& program) {
  using namespace stress_command;
  cli::Command command = program.add_command(
      "stress",
      "Measures jitter and missed deadlines of the loop on this machine, and their causes");
  auto& arguments = command.on_chosen<stress::StressArguments>(run);
  command.free_short_help();
  command.set_footer("It requests real-time rights and reports which were refused; without any, it "
                     "measures an ordinary thread.");
  command.add_microseconds("-i,--interval", arguments.interval_us,
                           "From tick to tick, 100us to 1s; a bare number is microseconds");
  command.add_option("-D,--duration", arguments.duration, "How long: seconds, or 90s, 10m, 2h, 1d");
  command.add_option("--stages", arguments.stages,
                     "Stages of a tick: sleep, input, hands, deform, publish, separated by commas");
  command.add_option("--load", arguments.load,
                     "Load by other processes: cpu, mem, io, separated by commas");
  command.add_microseconds("-b,--break", arguments.break_us,
                           "End at a tick that is later than this, e.g. 200us; a bare number is "
                           "microseconds");
  command.add_duration("--floor", arguments.floor_s,
                       "Seconds to measure the machine alone first; 0: none");
  command.add_option("--left", arguments.run.left,
                     "GLOVE on the left hand; without any, two simulated gloves");
  command.add_option("--right", arguments.run.right, "GLOVE on the right hand");
  gloves::add_wrist_options(command, arguments.run.wrists);
  command.add_option("MODEL,--mesh", arguments.run.mesh,
                     "OBJ, PLY, STL or glTF file; without it, the shipped Moai");
  takes::add_up_option(command, arguments.up);
  session::add_setting(command, flow::setting::mode, arguments.mode);
  command.add_option(
      "--changes", arguments.changes_per_minute,
      "Change the radius this number of times per minute, in every other second, and "
      "report the seconds with and without changes separately");
  command.add_option(std::string(flow::setting::radius.option), arguments.radius,
                     std::string(flow::setting::radius.help));
  command.add_flag("--view", arguments.view,
                   "Open the live window, to measure its effect on the loop");
  arguments.loop.add_to(command, true);
  add_reports(command.under("Report"), arguments);
}
