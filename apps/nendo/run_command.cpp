// nendo run: shapes a model with gloves.

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/text.hpp>
#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/repair.hpp>
#include <nendo/deform/supports.hpp>
#include <nendo/sculpting/kept_learning.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "commands/commands.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"
#include "nendo/run_arguments.hpp"
#include "session/run_and_report.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::run_command {
namespace {

/// Up to this size, a tick of 64 links takes less than the period of 90 Hz.
constexpr Eigen::Index max_injective_unasked = 100'000;

/// The views that the options ask for.
struct Views {
  std::unique_ptr<session::Observer> window;
  std::unique_ptr<session::BrowserView> browser;
};

Result<Views> open_views(const RunArguments& options) {
  Views views;
  if (options.view.window) {
    auto window = session::open_live_view(options.view, options.run);
    if (!window) return window.error();
    views.window = *std::move(window);
  }
  if (!options.web.empty()) {
    auto browser = session::open_browser_view(options.web, options.run.mesh);
    if (!browser) return browser.error();
    views.browser = *std::move(browser);
  }
  return views;
}

/// Warns if a fingertip that touches the model reaches all of it.
void warn_about_radius(const deform::Mesh& model, const RunArguments& options) {
  const deform::Box box = deform::box_of_faces(model);
  const double size = (box.highest - box.lowest).maxCoeff();
  const auto parsed = session::parse_radius(options.run.radius, size / options.run.model_size_m);
  if (!parsed || !*parsed) return;
  const deform::Supports& supports = **parsed;
  double reach = supports.own.empty() ? 0.0 : supports.own.front().support.radius;
  for (const auto& own : supports.own)
    reach = std::min(reach, own.support.radius);
  for (const auto& shared : supports.shared)
    reach = std::max(reach, shared.radius);
  deform::Points corners(3, 2); // no fingertip that touches the model is farther from all of it
  corners << box.lowest, box.highest;
  warn_about_reach("--radius " + options.run.radius, box, corners, deform::one_radius(reach));
}

/// Returns whether repairing closes the model, as advice. It is tried, so that the advice is true,
/// unless that takes too long.
std::string advice_to_close(const deform::Mesh& model) {
  constexpr Eigen::Index max_tried = 100'000;
  if (model.vertices.cols() > max_tried) return "`nendo repair IN --out OUT` may close it";
  const auto repaired = deform::repair(model);
  return repaired ? "`nendo repair IN --out OUT` closes it" : repaired.error().message;
}

/// Warns before the first tick if the model has no inside.
void note_inside(const deform::Mesh& model, const session::RunOptions& options) {
  const deform::ManifoldCheck closed = deform::check_closed_manifold(model);
  // Clay also knows the volume of surfaces that touch in a point.
  if (!closed && closed.fault != deform::ManifoldFault::pinched_vertex) {
    if (options.loop.sculptor.mode == flow::Mode::clay)
      cli::note(options.mesh + ": " + deform::describe(closed, model) +
                ", so it has no inside, and its volume is not kept; " + advice_to_close(model));
    return;
  }
  if (const std::size_t inwards = deform::count_inward_faces(model); inwards > 0)
    cli::note(fmt::format("{}: {} of its {} faces look inwards, where inside and outside are "
                          "exchanged; `nendo repair IN --out OUT` reverses them",
                          options.mesh, inwards, model.face_count()));
}

/// Turns fold prevention on, or warns that a model of this size has none.
void choose_injective(const deform::Mesh& model, RunArguments& options) {
  if (options.not_injective || options.run.puppet || options.run.over) return;
  if (options.asked.injective || model.vertices.cols() <= max_injective_unasked) {
    options.run.loop.sculptor.deformer.injective.emplace();
    return;
  }
  cli::note(fmt::format("{}: has more than {} vertices, so the surface can fold; --injective "
                        "prevents folds, but ticks may be late",
                        options.run.mesh, max_injective_unasked));
}

/// Stores what --adapt has learned about the hands of a --user, and reports it: on standard output,
/// unless that has JSON.
Result<void> keep_learned(const session::RunOptions& options,
                          const std::vector<gloves::OpenHand>& hands,
                          const flow::LoopStats& stats) {
  const auto report = [&](const std::string& text) {
    options.json ? cli::note(text) : static_cast<void>(std::cout << text << std::endl);
  };
  for (const gloves::OpenHand& hand : hands) {
    const std::string& user = options.calibration.user_of(hand.first.side);
    if (!hand.wearer.adapt || user.empty()) continue;
    const std::size_t slot = flow::Placement::index_of(hand.side);
    if (hand.wearer.ends) {
      const auto slips = sculpting::keep_slips(hand.glove->info(), hand.wearer.ends->side, user,
                                               stats.slips_counts[slot]);
      if (!slips) return slips.error();
      const std::string path = printable(slips->path.string());
      report(
          slips->is_changed
              ? fmt::format("wrote {}: the slips of the sensors; the previous file is kept", path)
              : fmt::format("{} hand: no sensor has slipped; {} is unchanged", name_of(hand.side),
                            path));
      continue;
    }
    const auto kept = sculpting::keep_ranges(hand.glove->info(), stats.range_sides[slot], user,
                                             stats.ranges[slot]);
    if (!kept) return kept.error();
    if (kept->empty())
      cli::note(fmt::format("{} hand: learned nothing, because no joint moved enough",
                            name_of(hand.side)));
    else
      report(fmt::format("wrote {}: the learned ranges, for --user {}", printable(kept->string()),
                         printable(user)));
  }
  return {};
}

int run(RunArguments& options) {
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  auto published = session::publish_to(options.publish);
  if (!published) return cli::report(published.error());
  auto model = read_model(options);
  if (!model) return cli::report(model.error());
  warn_about_radius(*model, options);
  note_inside(*model, options.run);
  choose_injective(*model, options);
  cli::install_stop_signals();
  session::RunOptions& wanted = options.run;
  const flow::RealtimeProcess process(wanted.realtime);
  const auto views = open_views(options);
  if (!views) return cli::report(views.error());
  EventCount event_count;
  auto opened = session::open_hands(wanted, *model, event_count);
  if (!opened) return cli::report(opened.error());
  session::RunParticipants participants;
  if (views->browser) {
    participants.sinks.push_back(views->browser.get());
    participants.observers.push_back(views->browser.get());
  }
  if (views->window) participants.observers.push_back(views->window.get());
  const auto outcome = session::run_and_report(wanted, *opened, *std::move(model), *published,
                                               std::move(participants), process.grants());
  if (!outcome) return cli::report(outcome.error());
  if (const auto kept = keep_learned(wanted, opened->hands, outcome->stats); !kept)
    return cli::report(kept.error());
  const bool recorded =
      std::all_of(outcome->recordings.begin(), outcome->recordings.end(),
                  [](const auto& of_loop) { return of_loop.recorded.has_value(); });
  return recorded ? 0 : static_cast<int>(Errc::failed);
}

void add_shape_options(cli::Command& command, RunArguments& options) {
  session::RunOptions& run_options = options.run;
  std::string gloves;
  for (const driver::GloveDriver& driver : driver::glove_drivers(gloves::glove_context()))
    gloves.append("\n  ").append(driver.grammar).append("\n      ").append(driver.summary);
  std::string trackers;
  for (const driver::TrackerDriver& driver : gloves::tracker_drivers())
    trackers.append("\n  ").append(driver.grammar).append("\n      ").append(driver.summary);
  command.set_footer(
      "A GLOVE is one of" + gloves +
      "\nWithout --left and --right every identified glove is used, or simulated hands.\nA TRACKER "
      "is one of" +
      trackers +
      "\nWithout --left-wrist and --right-wrist the hands stay where they are placed.\nKeys "
      "during the run, in the terminal, the window and a browser; some only in the last two:" +
      commands::key_list(commands::everywhere, "\n  key ", "\n      "));
  command.add_option("--left", run_options.left, "GLOVE on the left hand");
  command.add_option("--right", run_options.right, "GLOVE on the right hand");
  gloves::add_wrist_options(command, run_options.wrists);
  command.add_option("MODEL,--mesh", options.models,
                     "OBJ, PLY, STL or glTF files to shape, side by side; without it, the shipped "
                     "Moai");
  takes::add_up_option(command, options.up);
  command.add_option(
      "--puppet", run_options.puppet_file,
      "A puppet file, or face, moai or spot: each finger then plays an action of the model, and "
      "does not touch it. In a window with a MODEL, the file may be new");
  namespace setting = flow::setting;
  session::SettingArguments& settings = options.settings;
  settings.add(command, setting::mode);
  command.add_option(
      "--size", options.size,
      "The model's longest side on the stage, e.g. 20cm; without it 80 cm, with --mode clay "
      "7.5 cm, and with parts 25 cm; a bare number is centimetres");
  command.add_option(std::string(setting::radius.option), run_options.radius,
                     std::string(setting::radius.help));
  settings.add(command, setting::brushes);
  settings.add(command, setting::brush_strength);
  command.add_option(
      "--mask", run_options.mask_file,
      "A file of protected areas for fingertips: [[masks]] with at and radius, as in "
      "a puppet's file; the window paints and saves them");
  command.add_option(
      "--wire", options.wire,
      "FROM:TO, e.g. 0.8s:2.5s: the index fingers draw a wire through the model between these "
      "times, which then cuts; key C does the same");
  command.add_option(
      "--knife", options.knife,
      "FROM:TO: the same with a knife as long as the model, at the index finger that "
      "points more; key K does the same");
  command.add_option(
      "--refine", options.refine_to,
      "Max number of vertices: during the run, the model gets more triangles where it "
      "is stretched, and fewer where they are crowded");
  command.add_flag(
      "--topology", run_options.changes_topology,
      "With --refine: where the model is thinner than its edges, necks break and walls "
      "open, and surfaces as close as that fuse; key O does the same");
  command.add_flag("--symmetry", run_options.symmetric,
                   "Shape both sides of the model's plane of symmetry, or of x = 0, at once");
  gloves::add_calibration_options(command, run_options.calibration, true);
  gloves::add_hand_length(command, run_options.length);
  settings.add(command, setting::kernel);
  session::add_polynomial_option(command, options.polynomial);
  settings.add(command, setting::keep_volume);
  settings.add(command, setting::hold);
  settings.add(command, setting::injective);
  command.add_flag("--no-injective", options.not_injective,
                   "Allow folds; without either option, --injective with models of up to " +
                       std::to_string(max_injective_unasked) + " vertices");
}

/// The options that the recording of --over decides.
std::vector<std::string> decided_by_take() {
  std::vector<std::string> options{"--puppet", "--mask",       "--symmetry",
                                   "--size",   "--left-wrist", "--right-wrist"};
  flow::for_each_setting([&](const flow::SettingText& setting) {
    if (!setting.option.empty()) options.emplace_back(setting.option);
  });
  for (const char* more : {"--polynomial", "--no-injective", "--rate", "--policy", "--switch"})
    options.emplace_back(more);
  return options;
}

/// Makes the options of a command that runs.
RunArguments& options_for(cli::Command& command) {
  return command.on_chosen<RunArguments>([command](RunArguments& options) {
    options.decided_by_take = command.first_given(decided_by_take());
    return run(options);
  });
}

void add_run_options(cli::Command& command, RunArguments& options) {
  session::RunOptions& run_options = options.run;
  add_shape_options(command, options);
  command.add_rate("--rate", run_options.loop.rate_hz, "Ticks per second, 1 to 10000");
  options.loop.add_to(command);
  command.add_option("--switch", options.switch_action,
                     "Action of the wrist switch. grab: the hands hold the model while it is on; "
                     "commit: keeps the shape so far; toggle: releases and grabs; keep: saves the "
                     "last seconds (--keep-last)");
  session::add_recording_options(command, run_options.recording);
  session::add_overdub_options(command, options.overdub);
  options.settings.add_filter(command);
  session::add_publish_option(command, options.publish);
  command.add_duration(
      "--duration", run_options.duration_s,
      "How long, e.g. 30s or 10m; 0: until Ctrl-C, or until the end of the gloves' "
      "recordings (replay:FILE); a window stays open");
  command.add_option("--undo-memory", run_options.undo_memory_mb,
                     "Max megabytes for undo and redo, after which the oldest steps are discarded; "
                     "without it, half of the available memory");
  command.add_option(
      "--out", run_options.out,
      "Where to write the shape, .obj, .ply or .stl; without it, nendo-<date>-<time>.obj");
  command.add_flag("--force", options.force, cli::force_summary);
  command.add_option("--picture", run_options.picture,
                     "Where to draw the model and the hands before and after, .png");
  command.add_flag("--json", run_options.json, "Progress and summary as JSON, one object per line");
  command.add_flag("--verbose", run_options.verbose, "A longer summary, with figures about folds");
  command.add_option(
      "--web", options.web,
      "[ADDR:]PORT at which a browser shows and controls the run; without ADDR, only a "
      "browser on this machine");
  command.add_option(
      "--out-puppet", options.out_puppet,
      "Where the window saves an edited puppet, .toml; without it, the file that was "
      "opened, or one in the current folder, named after the model");
  command.add_option("--theme", options.view.theme, "The window's colours")
      .one_of({"light", "dark"});
  command.add_option("--screenshot", options.view.screenshot,
                     "Where the window's last picture goes, .png");
  command.add_flag("--contact", options.view.contact,
                   "The window shows where hands touch clay, and how hard; key 0 switches it");
  command.add_option("--frames", options.view.frames,
                     "Number of the window's pictures after which the run ends; 0: no limit");
}

} // namespace
} // namespace nendo::app::run_command

void nendo::app::add_run(cli::Command& program) {
  using namespace run_command;
  cli::Command command = program.add_command("run", "Shapes a model with one or two gloves");
  RunArguments& options = options_for(command);
  command.add_flag("--view", options.view.window, "Open the live window, as `nendo view` does");
  add_run_options(command, options);
}

void nendo::app::add_view(cli::Command& program) {
  using namespace run_command;
  cli::Command command = program.add_command(
      "view", "Runs as `nendo run`, in a window with the model, the hands and a panel");
  RunArguments& options = options_for(command);
  options.view.window = true;
  add_run_options(command, options);
}
