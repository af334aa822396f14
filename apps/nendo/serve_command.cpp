// nendo serve: gloves, trackers and hands for other programs, without a model.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <nendo/deform/mesh.hpp>

#include "cli/cli.hpp"
#include "nendo/commands.hpp"
#include "serve/server.hpp"
#include "session/run_and_report.hpp"
#include "session/setting_options.hpp"
#include "session/views.hpp"

namespace nendo::app::serve_command {
namespace {

struct Options {
  session::RunOptions run;
  session::LoopArguments loop;
  session::SettingArguments settings;
  std::string name{driver::default_serve_name}; ///< the text for serve::parse_target()
  std::vector<std::string> targets;
  std::string web; ///< [ADDR:]PORT; empty: none
};

/// Passes the frames of a run to the server.
class ServerSink final : public session::Sink {
public:
  explicit ServerSink(serve::Server& server) : frames_(server.frames()) {}
  Result<void> begin(const session::LoopStart&) override { return {}; }
  Result<void> prepare(const flow::ModelVersion&) override { return {}; }
  void show(const flow::Frame& frame) noexcept override { frames_.show(frame); }

private:
  flow::FrameSink& frames_;
};

serve::Devices devices_of(const std::vector<gloves::OpenHand>& hands) {
  serve::Devices devices;
  for (std::size_t at = 0; at < hands.size(); ++at) {
    const gloves::OpenHand& hand = hands[at];
    devices.gloves.push_back({static_cast<std::uint8_t>(at), hand.side, hand.glove->info()});
    if (!hand.wrist) continue;
    const driver::TrackerStation& station = hand.wrist->station;
    devices.trackers.push_back({hand.side, station.station, station.tracker->info()});
  }
  return devices;
}

/// Reports what clients missed, if they did.
void report_clients(const serve::ServerCounters& counters) {
  if (counters.dropped > 0)
    cli::note(fmt::format("clients of the socket missed {} lines, because they read too slowly",
                          counters.dropped));
  if (counters.refused > 0)
    cli::note(
        fmt::format("{} clients were refused, because there were too many", counters.refused));
}

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

int serve_hands(Options& options) {
  session::RunOptions& run = options.run;
  run.hands_only = true;
  run.loop.held = false;
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  auto published = session::publish_to(options.targets);
  if (!published) return cli::report(published.error());
  const auto target = serve::parse_target(options.name);
  if (!target) return cli::report({Errc::usage, "--name " + target.error().message});
  auto socket = serve::Socket::claim(*target);
  if (!socket) return cli::report(socket.error());
  cli::install_stop_signals();
  const flow::RealtimeProcess process(run.realtime);
  std::unique_ptr<session::BrowserView> browser;
  if (!options.web.empty()) {
    auto opened = session::open_web_server(options.web);
    if (!opened) return cli::report(opened.error());
    browser = session::browser_view(*std::move(opened), "");
  }
  const deform::Mesh no_model;
  EventCount event_count;
  auto opened = session::open_hands(run, no_model, event_count);
  if (!opened) return cli::report(opened.error());
  auto server = serve::Server::open(*std::move(socket), devices_of(opened->hands));
  if (!server) return cli::report(server.error());
  run.loop.input_log = &(*server)->input();
  ServerSink served(**server);
  cli::note("serving at " + (*server)->path());
  session::RunParticipants participants;
  participants.sinks.push_back(&served);
  if (browser) {
    participants.sinks.push_back(browser.get());
    participants.observers.push_back(browser.get());
  }
  const auto outcome = session::run_and_report(run, *opened, no_model, *published,
                                               std::move(participants), process.grants());
  if (!outcome) return cli::report(outcome.error());
  report_clients((*server)->counters());
  return 0;
}

} // namespace
} // namespace nendo::app::serve_command

void nendo::app::add_serve(cli::Command& program) {
  using namespace serve_command;
  cli::Command command = program.add_command(
      "serve", "Shares gloves, trackers and hands with other programs, without a model");
  Options& options = command.on_chosen<Options>(serve_hands);
  session::RunOptions& run = options.run;
  options.loop.policy = "sample";
  command.add_option("GLOVE", run.gloves,
                     "One, or one for each hand: serial:/dev/ttyUSB0, sim, ...; without it every "
                     "identified glove, or simulated hands");
  gloves::add_wrist_options(command, run.wrists);
  gloves::add_calibration_options(command, run.calibration, true);
  gloves::add_hand_length(command, run.length);
  command.add_option("--name", options.name,
                     "The name by which GLOVE serve:NAME and other programs find it; with "
                     "?group=GROUP that group may use it");
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
