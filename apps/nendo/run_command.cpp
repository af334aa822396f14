// nendo run: shapes a model with gloves.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "commands/commands.hpp"
#include "nendo/commands.hpp"
#include "nendo/run_in_studio.hpp"
#include "nendo/run_once.hpp"
#include "session/run_publishing.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::run_command {
namespace {

int run(RunArguments& options) {
  if (options.studio || options.view.window) return run_in_studio(options, {});
  const auto code = run_once(options);
  return code ? *code : cli::report(code.error());
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
      "a puppet's file; the window and the page paint and save them");
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
RunArguments& options_for(cli::Command& command,
                          const std::function<Begin(const cli::Command&)>& begin = {}) {
  return command.on_chosen<RunArguments>([command, begin](RunArguments& options) {
    options.decided_by_take = command.first_given(decided_by_take());
    if (options.studio) options.view.window = options.web.empty();
    if (begin) options.begin = begin(command);
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
      "Where the window saves an edited puppet, or the page masks, .toml; without it, the "
      "file that was opened, or one in the current folder, named after the model");
  command.add_option("--theme", options.view.theme, "The window's colours")
      .one_of({"light", "dark"});
  command.add_option("--screenshot", options.view.screenshot,
                     "Where the window's last picture goes, .png");
  command.add_flag("--contact", options.view.contact,
                   "The window shows where hands touch clay, and how hard; key 0 switches it");
  command.add_option("--frames", options.view.frames,
                     "Number of the window's pictures after which the run ends; 0: no limit");
  options.usual = std::make_shared<const RunArguments>(options); // before a command line is read
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
      "view", "Runs as `nendo run`, in a window; without arguments, begins as `nendo studio`");
  RunArguments& options = options_for(command, [](const cli::Command& given) {
    return given.has_arguments() ? Begin::with_run : Begin::with_start;
  });
  options.view.window = true;
  add_run_options(command, options);
}

void nendo::app::add_studio(cli::Command& program) {
  using namespace run_command;
  cli::Command command = program.add_command(
      "studio", "A window, or with --web a page in a browser, from glove to sculpture: gloves, "
                "models and modes to choose from, calibration, shaping, and the timeline");
  RunArguments& options = options_for(command, [](const cli::Command& given) {
    const bool is_chosen = !given.first_given({"--mesh", "--puppet", "--mode", "--over"}).empty();
    return is_chosen ? Begin::with_run : Begin::with_start;
  });
  options.studio = true;
  add_run_options(command, options);
}
