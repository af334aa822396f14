// nendo serve: gloves, trackers and hands for other programs, without a model.

#include <memory>
#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "cli/cli.hpp"
#include "nendo/commands.hpp"
#include "service/service_notice.hpp"
#include "session/open_hands.hpp"
#include "session/run_publishing.hpp"
#include "session/run_session.hpp"
#include "session/setting_options.hpp"
#include "session/views.hpp"

namespace nendo::app::serve_command {
namespace {

struct Options {
  session::RunOptions run;
  session::LoopArguments loop;
  session::SettingArguments settings;
  std::vector<std::string> targets;
  std::string web; ///< [ADDR:]PORT; empty: none
};

Result<void> check(Options& options) {
  if (const auto fine = session::check_count(options.run.gloves); !fine) return fine;
  if (const auto fine = gloves::check(options.run.calibration); !fine) return fine;
  if (const auto fine = gloves::check(options.run.wrists); !fine) return fine;
  if (const auto fine = options.run.length.check(); !fine) return fine;
  const auto settings = options.settings.parse();
  if (!settings) return settings.error();
  options.run.filter = settings->filter;
  return options.loop.parse(options.run.loop, options.run.realtime);
}

int serve(Options& options) {
  session::RunOptions& run = options.run;
  run.hands_only = true;
  run.loop.held = false;
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  auto published = session::publish_to(options.targets);
  if (!published) return cli::report(published.error());
  cli::install_stop_signals();
  const flow::RealtimeProcess process(run.realtime);
  std::unique_ptr<session::BrowserView> browser;
  if (!options.web.empty()) {
    auto opened = session::open_browser_view(options.web, "");
    if (!opened) return cli::report(opened.error());
    browser = *std::move(opened);
  }
  const deform::Mesh no_model;
  EventCount event_count;
  auto opened = session::open_hands(run, no_model, event_count);
  if (!opened) return cli::report(opened.error());
  service::ServiceNotice service;
  session::RunParticipants participants;
  participants.progress = [&service, shown = session::progress_for(run, opened->hands)](
                              const flow::Frame& frame, double elapsed_s) {
    service.alive();
    shown(frame, elapsed_s);
  };
  for (const auto& sink : *published)
    participants.sinks.push_back(sink.get());
  if (browser) {
    participants.sinks.push_back(browser.get());
    participants.observers.push_back(browser.get());
  }
  auto grants = process.grants();
  grants.insert(grants.end(), opened->grants.begin(), opened->grants.end());
  auto outcome = session::run_session(run, opened->hands, no_model, participants, grants);
  if (!outcome) return cli::report(outcome.error());
  for (const auto& sink : *published)
    outcome->published.push_back(sink->end());
  session::print_summary(run, opened->hands, *outcome);
  return 0;
}

} // namespace
} // namespace nendo::app::serve_command

void nendo::app::add_serve(cli::Command& program) {
  using namespace serve_command;
  cli::Command command = program.add_command(
      "serve", "Shares gloves, trackers and hands with other programs, without a model");
  Options& options = command.on_chosen<Options>(serve);
  session::RunOptions& run = options.run;
  options.loop.policy = "sample";
  command.add_option("GLOVE", run.gloves,
                     "One, or one for each hand: serial:/dev/ttyUSB0, sim, ...; without it every "
                     "identified glove, or simulated hands");
  gloves::add_wrist_options(command, run.wrists);
  gloves::add_calibration_options(command, run.calibration, true);
  gloves::add_hand_length(command, run.length);
  session::add_publish_option(command, options.targets);
  command.add_option("--web", options.web,
                     "[ADDR:]PORT at which a browser shows the hands; without ADDR, only a browser "
                     "on this machine");
  command.add_rate("--rate", run.loop.rate_hz,
                   "Ticks per second, 1 to 10000, with another --policy than sample");
  options.loop.add_to(command);
  options.settings.add_filter(command);
  command.add_duration("--duration", run.duration_s,
                       "How long, e.g. 30s or 10m; 0: until Ctrl-C, or until the end of the "
                       "gloves' recordings (replay:FILE)");
  command.add_flag("--json", run.json, "Progress and summary as JSON, one object per line");
}
