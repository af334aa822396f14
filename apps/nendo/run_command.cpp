// nendo run: the main job, from gloves to a deformed model.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/flow/tick_grid.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/quantities.hpp"
#include "nendo/commands.hpp"
#include "nendo/puppet_file.hpp"
#include "service/service_notice.hpp"
#include "session/browser_view.hpp"
#include "session/live_view.hpp"
#include "session/loop_options.hpp"
#include "session/open_hands.hpp"
#include "session/overdub.hpp"
#include "session/run_publishing.hpp"
#include "session/run_report.hpp"
#include "takes/recorded_model.hpp"

namespace nendo::app::run_command {
namespace {

struct CommandOptions {
  session::RunOptions run;
  std::string radius;
  std::string mode; ///< empty: type1, or type2 with a brush
  std::string hold = "tips";
  std::string size; ///< of the model on the stage; empty: as the mode has it
  std::string switch_action = "none";
  session::FilterArguments filter;
  session::KernelArguments kernel;
  session::BrushArguments brush;
  session::LoopArguments loop;
  session::ViewOptions view;
  session::OverdubArguments overdub;
  std::string decided_by_take; ///< the first option of the command line that a take decides
  std::vector<std::string> publish;
  std::string web; ///< [ADDR:]PORT; empty: none
  bool injective = false;
  bool not_injective = false;
  std::optional<std::uint32_t> refine_to;
  std::string out_puppet;
  bool force = false; ///< --out may be the model, and --out-puppet may be there
};

// Up to this size, a tick of 64 links takes less time than a tick at 90 Hz has.
constexpr Eigen::Index most_injective_unasked = 100'000;

std::string dated_name() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char name[64];
  std::strftime(name, sizeof name, "nendo-%Y%m%d-%H%M%S.obj", &local);
  return name;
}

/// One that is there is written over only if it is the one that was opened.
Result<void> check_out_puppet(const CommandOptions& options) {
  if (options.out_puppet.empty()) return {};
  if (!options.view.window) return Error{Errc::usage, "--out-puppet is the window's; add --view"};
  std::error_code ignored;
  const bool is_opened =
      std::filesystem::equivalent(options.out_puppet, options.run.puppet_file, ignored);
  if (!is_opened && !options.force && std::filesystem::exists(options.out_puppet, ignored))
    return Error{Errc::usage,
                 "--out-puppet " + options.out_puppet + ": exists; --force replaces it"};
  return cli::check_place("--out-puppet", options.out_puppet, {".toml"});
}

Result<void> check_outputs(const CommandOptions& options) {
  const session::RunOptions& run = options.run;
  const session::ViewOptions& view = options.view;
  if (!view.window && (view.frames > 0 || view.contact || !view.screenshot.empty()))
    return Error{Errc::usage, "--frames, --screenshot and --contact are the window's; add --view"};
  if (auto fine = cli::check_place("--out", run.out, {".obj", ".ply"}); !fine) return fine;
  const std::string& model = run.over ? run.over->take.setup.loop->mesh : run.mesh;
  if (auto fine = cli::check_spares(model, "--out", run.out, options.force); !fine) return fine;
  if (auto fine = cli::check_place("--picture", run.picture, {".png"}); !fine) return fine;
  if (auto fine = cli::check_place("--record", run.recording.file); !fine) return fine;
  if (auto fine = check_out_puppet(options); !fine) return fine;
  if (auto fine = cli::check_place("--screenshot", view.screenshot, {".png"}); !fine) return fine;
  return cli::check_distinct({{"--out", run.out},
                              {"--picture", run.picture},
                              {"--record", run.recording.file},
                              {"--out-puppet", options.out_puppet},
                              {"--screenshot", view.screenshot}});
}

/// A file, or the name of a shipped puppet. Its model stands beside it.
Result<void> read_puppet(CommandOptions& options) {
  session::RunOptions& run = options.run;
  std::error_code ignored;
  if (options.view.window) {
    const bool is_opened =
        std::filesystem::equivalent(options.out_puppet, run.puppet_file, ignored);
    run.out_puppet = {options.out_puppet, options.force || is_opened};
  }
  const bool is_named =
      !run.puppet_file.empty() && std::filesystem::exists(run.puppet_file, ignored);
  if (options.view.window && !run.puppet_file.empty() && !run.mesh.empty() && !is_named &&
      run.puppet_file.ends_with(".toml")) { // one that is to be made
    if (run.out_puppet.file.empty()) run.out_puppet.file = run.puppet_file;
    run.loop.held = false;
    return {};
  }
  if (is_named && options.view.window && options.out_puppet.empty())
    run.out_puppet = {run.puppet_file, true};
  if (run.puppet_file.empty()) return {};
  auto file = open_puppet(run.puppet_file);
  if (!file) return file.error();
  run.puppet_file = file->path;
  run.puppet = std::move(file->puppet);
  if (run.mesh.empty()) run.mesh = file->model;
  return {};
}

/// Reads the file of masks, if one is named.
Result<void> read_masks(session::RunOptions& run) {
  const char* const option = !run.mask_file.empty() ? "--mask" : "--symmetry";
  if ((!run.mask_file.empty() || run.symmetric) && !run.puppet_file.empty())
    return Error{Errc::usage, std::string(option) + ": is of fingertips, and with --puppet hands "
                                                    "play one; put [[masks]] and mirror into its "
                                                    "file"};
  if (run.mask_file.empty()) return {};
  auto masks = puppet::read_puppet(run.mask_file);
  if (!masks) return masks.error();
  if (masks->is_played())
    return Error{Errc::bad_input, run.mask_file +
                                      ": has points and functions, so it is a puppet; open it with "
                                      "--puppet, or leave only its [[masks]]"};
  run.masks = *std::move(masks);
  return {};
}

/// Reads the take to play over, if one is named. Its model and its settings are the run's.
Result<void> read_take(CommandOptions& options) {
  session::RunOptions& run = options.run;
  if (!options.overdub.take.empty() && !options.decided_by_take.empty())
    return Error{Errc::usage, options.decided_by_take + ": the recording of --over decides that; "
                                                        "leave it out"};
  auto over = session::read_overdub(options.overdub);
  if (!over) return over.error();
  run.over = *std::move(over);
  auto live = session::live_part(options.overdub, run);
  if (!live) return live.error();
  run.live = *std::move(live);
  return {};
}

/// Reads the model, or that of the take to play over, which must be as it was recorded.
Result<deform::Mesh> read_model(CommandOptions& options) {
  session::RunOptions& run = options.run;
  if (!run.over) return deform::read_mesh(run.mesh);
  const recording::LoopSetup& loop = *run.over->take.setup.loop;
  auto model = takes::recorded_model(loop, run.mesh);
  if (!model) return model;
  const auto of_file = static_cast<Eigen::Index>(loop.mesh_sum.vertices);
  if (model->vertices.cols() < of_file ||
      recording::sum_of(model->vertices.leftCols(of_file)) != loop.mesh_sum)
    return Error{Errc::bad_input, run.mesh + ": is not the model of " + run.over->file +
                                      "; a layer is played over the model that was recorded"};
  if (run.mesh.empty()) run.mesh = loop.mesh;
  if (auto fine = session::take_over_settings(*model, run); !fine) return fine.error();
  return model;
}

/// What acts on fingertips, or on a puppet's points, has nothing to do with whole hands.
Result<void> check_clay(const session::RunOptions& run) {
  if (run.loop.sculptor.mode != flow::Mode::clay) return {};
  const auto refuse = [](const char* option, const char* why) {
    return Error{Errc::usage,
                 std::string("--mode clay and ") + option + ": " + why + "; give one of them"};
  };
  if (!run.puppet_file.empty())
    return refuse("--puppet", "whole hands press clay, and a puppet has points");
  if (!run.mask_file.empty()) return refuse("--mask", "a mask does not hold clay");
  if (run.symmetric) return refuse("--symmetry", "only fingertips have images");
  if (run.loop.sculptor.hold == flow::Hold::hand)
    return refuse("--hold hand", "clay is pressed, and hands hold it only by closing on it");
  if (run.loop.sculptor.deformer.csrbf.keep_volume > 0.0)
    return refuse("--keep-volume", "clay keeps its volume by itself");
  return {};
}

Result<void> set_size(CommandOptions& options) {
  session::RunOptions& run = options.run;
  if (run.loop.sculptor.mode == flow::Mode::clay) run.model_size_m = session::clay_size_m;
  if (options.size.empty()) return {};
  const auto size_m = cli::metres_of(options.size);
  constexpr double least_m = 0.01;
  constexpr double most_m = 10.0;
  if (!size_m || !(*size_m >= least_m && *size_m <= most_m))
    return Error{Errc::usage, "--size " + options.size + ": use " + std::string(cli::length_words) +
                                  ", from 1cm to 10m"};
  run.model_size_m = *size_m;
  return {};
}

Result<void> check(CommandOptions& options) {
  auto& run = options.run;
  const auto mode = flow::mode_named(options.mode);
  if (!mode && !options.mode.empty())
    return Error{Errc::usage, "--mode " + options.mode + ": unknown; use type1, type2 or clay"};
  run.loop.sculptor.mode = mode.value_or(flow::Mode::type1);
  if (auto fine = options.brush.parse(options.mode, run.loop.sculptor); !fine) return fine;
  if (auto fine = set_size(options); !fine) return fine;
  const auto action = flow::switch_action_named(options.switch_action);
  if (!action) {
    return Error{Errc::usage, "--switch " + options.switch_action +
                                  ": unknown; use none, grab, commit, toggle or keep"};
  }
  run.loop.switch_action = *action;
  run.refine_to = options.refine_to.value_or(0);
  if (options.refine_to && !(run.refine_to >= 4 && run.refine_to <= flow::Refine{}.most_vertices))
    return Error{Errc::usage, fmt::format("--refine {}: use 4 to {} vertices", run.refine_to,
                                          flow::Refine{}.most_vertices)};
  const auto filter = options.filter.parse();
  if (!filter) return filter.error();
  run.filter = *filter;
  const auto csrbf = options.kernel.parse();
  if (!csrbf) return csrbf.error();
  run.loop.sculptor.deformer.csrbf = *csrbf;
  if (options.injective && csrbf->keep_volume > 0.0)
    return Error{Errc::usage, std::string(session::keep_volume_or_injective)};
  const auto hold = flow::hold_named(options.hold);
  if (!hold) return Error{Errc::usage, "--hold " + options.hold + ": unknown; use tips or hand"};
  run.loop.sculptor.hold = *hold;
  if (auto fine = check_clay(run); !fine) return fine;
  if (*hold == flow::Hold::hand && run.loop.sculptor.mode == flow::Mode::type2)
    return Error{Errc::usage,
                 "--hold hand: type 2 follows the ways of fingertips; use --mode type1"};
  if (*hold == flow::Hold::hand && csrbf->keep_volume > 0.0)
    return Error{Errc::usage, "--hold hand and --keep-volume: 90 points with matrices take longer "
                              "than a tick has; give one of them"};
  if (options.injective && options.not_injective)
    return Error{Errc::usage, "--injective and --no-injective: give one of them"};
  if (!(run.loop.rate_hz >= flow::TickGrid::least_rate_hz &&
        run.loop.rate_hz <= flow::TickGrid::most_rate_hz)) {
    return Error{Errc::usage, "--rate: use 1 to 10000 ticks a second"};
  }
  if (auto fine = options.loop.parse(run.loop, run.realtime); !fine) return fine;
  if (!std::isfinite(run.duration_s) || run.duration_s < 0.0 || run.duration_s > 1e7) {
    return Error{Errc::usage, "--duration: use a number of seconds up to 10000000, 0 for no end"};
  }
  if (!(run.undo_memory_mb.value_or(0.0) >= 0.0 && run.undo_memory_mb.value_or(0.0) <= 1e6))
    return Error{Errc::usage, "--undo-memory: use a number of megabytes up to 1000000"};
  const auto supports = session::parse_radius(options.radius);
  if (!supports) return supports.error();
  run.supports = *supports;
  if (auto fine = run.length.check(); !fine) return fine;
  if (auto fine = check(run.calibration); !fine) return fine;
  if (run.out.empty()) run.out = dated_name();
  if (auto fine = run.recording.check(run.out, run.loop.switch_action); !fine) return fine;
  if (auto fine = read_puppet(options); !fine) return fine;
  if (run.puppet && *hold == flow::Hold::hand)
    return Error{Errc::usage, "--hold hand: a puppet's own points move it; leave it out"};
  if (run.puppet && csrbf->keep_volume > 0.0 && run.puppet->distance != puppet::Distance::air &&
      run.loop.sculptor.mode == flow::Mode::type1)
    return Error{Errc::usage, "--keep-volume: " + run.puppet_file +
                                  " measures its distances along the surface, where no kernel is "
                                  "known that keeps the volume; use --mode type2, or distance = "
                                  "\"air\" in it"};
  if (auto fine = read_masks(run); !fine) return fine;
  if (auto fine = read_take(options); !fine) return fine;
  if (run.mesh.empty() && !run.over)
    run.mesh =
        cli::shipped_model(run.loop.sculptor.mode == flow::Mode::clay ? "clay.ply" : "moai.obj")
            .string();
  if (options.view.window && run.out_puppet.file.empty() && !run.over)
    run.out_puppet.file =
        std::filesystem::path(run.mesh).filename().replace_extension(".puppet.toml").string();
  return check_outputs(options);
}

/// The views that the options ask for.
struct Views {
  std::unique_ptr<session::Observer> window;
  std::unique_ptr<session::BrowserView> browser;
};

Result<Views> open_views(const CommandOptions& options) {
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

/// Tells what is hardly meant: a model that has no surface or size, or a radius in another unit
/// than the model's.
void note_oddities(const deform::Mesh& model, const CommandOptions& options) {
  if (const auto remark = deform::remark_on(model); !remark.empty())
    cli::note(options.run.mesh + ": " + std::string(remark));
  if (!options.run.supports) return;
  const deform::Supports& supports = *options.run.supports;
  double reach = supports.own.empty() ? 0.0 : supports.own.front().support.radius;
  for (const auto& own : supports.own)
    reach = std::min(reach, own.support.radius);
  for (const auto& shared : supports.shared)
    reach = std::max(reach, shared.radius);
  const deform::Box box = deform::finite_box_of(model.vertices);
  deform::Points corners(3, 2); // no fingertip that touches the model is farther from all of it
  corners << box.lowest, box.highest;
  if (!deform::reach_all_of(box, corners, deform::one_radius(reach))) return;
  cli::note("--radius " + options.radius +
            ": a fingertip reaches all of the model, whose longest "
            "side is " +
            fmt::format("{:.3g}", (box.highest - box.lowest).maxCoeff()) +
            ", so no part of it stays as it is; use a smaller radius to shape a part");
}

Result<void> check_refinable(const deform::Mesh& model, const CommandOptions& options) {
  if (options.run.refine_to == 0) return {};
  const auto closed = deform::check_closed_manifold(model);
  if (closed) return {};
  return Error{Errc::bad_input, "--refine: " + options.run.mesh + ": " +
                                    deform::describe(closed, model) +
                                    "; only closed models can be refined, so mend it first"};
}

/// Turns the guard against folds on, or says that a model of this size goes without.
void choose_injective(const deform::Mesh& model, CommandOptions& options) {
  if (options.not_injective || options.run.puppet || options.run.over) return;
  if (options.injective || model.vertices.cols() <= most_injective_unasked) {
    options.run.loop.sculptor.deformer.injective.emplace();
    return;
  }
  cli::note(fmt::format("{}: has more than {} vertices, so nothing keeps the surface from folding; "
                        "--injective does, and may make ticks late",
                        options.run.mesh, most_injective_unasked));
}

int run(CommandOptions& options) {
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  auto published = session::publish_to(options.publish);
  if (!published) return cli::report(published.error());
  auto model = read_model(options);
  if (!model) return cli::report(model.error());
  if (const auto fine = check_refinable(*model, options); !fine) return cli::report(fine.error());
  note_oddities(*model, options);
  choose_injective(*model, options);
  cli::install_stop_signals();
  session::RunOptions& wanted = options.run;
  const flow::RealtimeProcess process(wanted.realtime);
  const auto views = open_views(options);
  if (!views) return cli::report(views.error());
  EventCount event_count;
  auto opened = session::open_hands(wanted, *model, event_count);
  if (!opened) return cli::report(opened.error());
  service::ServiceNotice service;
  session::RunParticipants participants;
  participants.progress = [&service, shown = session::progress_for(wanted, opened->hands)](
                              const flow::Frame& frame, double elapsed_s) {
    service.alive();
    shown(frame, elapsed_s);
  };
  for (const auto& sink : *published)
    participants.sinks.push_back(sink.get());
  if (views->browser) {
    participants.sinks.push_back(views->browser.get());
    participants.observers.push_back(views->browser.get());
  }
  if (views->window) participants.observers.push_back(views->window.get());
  auto grants = process.grants();
  grants.insert(grants.end(), opened->grants.begin(), opened->grants.end());
  auto outcome =
      session::run_session(wanted, opened->hands, *std::move(model), participants, grants);
  if (!outcome) return cli::report(outcome.error());
  for (const auto& sink : *published)
    outcome->published.push_back(sink->end());
  session::print_summary(wanted, opened->hands, *outcome);
  const bool recorded =
      std::all_of(outcome->recordings.begin(), outcome->recordings.end(),
                  [](const auto& of_loop) { return of_loop.recorded.has_value(); });
  return recorded ? 0 : static_cast<int>(Errc::failed);
}

void add_shape_options(cli::Command& command, CommandOptions& options) {
  session::RunOptions& run_options = options.run;
  std::string gloves;
  for (const auto& [grammar, summary] : driver::driver_summaries()) {
    gloves += "\n  " + std::string(grammar) + "\n      " + std::string(summary);
  }
  command.set_footer(
      "A GLOVE is one of" + gloves +
      "\nWithout --left and --right every identified glove is used, or simulated hands.");
  command.add_option("--left", run_options.left, "GLOVE on the left hand");
  command.add_option("--right", run_options.right, "GLOVE on the right hand");
  command.add_option("MODEL,--mesh", run_options.mesh,
                     "OBJ, PLY or glTF file to shape; without it, the shipped Moai");
  command.add_option(
      "--puppet", run_options.puppet_file,
      "A puppet file, or face, moai or spot: what each finger does to the model, in place of "
      "hands that touch it. In a window with a MODEL, also a file that is to be made");
  command.add_option(
      "--mode", options.mode,
      "type1: the rest shape follows the fingertips; type2: strokes along their paths; clay: whole "
      "hands press; without it, type1, or type2 with a brush");
  command.add_option(
      "--size", options.size,
      "The model's longest side on the stage, where the hands are, e.g. 20cm; without "
      "it 80 cm, and with --mode clay 7.5 cm");
  command.add_option(
      "--radius", options.radius,
      "Radius of a fingertip's influence, in the mesh's units, without it 0.2 of its longest side; "
      "or five with commas between, thumb to little finger; 10+40:0.5 is a mix");
  session::add_brush_options(command, options.brush);
  command.add_option("--mask", run_options.mask_file,
                     "A file of places that fingertips leave as they are: [[masks]] with at and "
                     "radius, as in a puppet's file; the window paints and saves them");
  command.add_option("--refine", options.refine_to,
                     "While the hands shape it, the model gets more triangles where it is "
                     "stretched, and fewer where it is crowded, up to so many vertices");
  command.add_flag("--symmetry", run_options.symmetric,
                   "Fingertips shape both sides of the model's plane of symmetry, or of x = 0");
  gloves::add_calibration_options(command, run_options.calibration);
  gloves::add_hand_length(command, run_options.length);
  session::add_kernel_options(command, options.kernel);
  command.add_option("--hold", options.hold,
                     "What of a hand holds the model in type 1: tips, or hand, 45 points all over "
                     "it");
  command.add_flag("--injective", options.injective,
                   "Never fold: in links that each stay injective; fingertips whose ways cross are "
                   "held apart. By default with models of up to " +
                       std::to_string(most_injective_unasked) + " vertices");
  command.add_flag("--no-injective", options.not_injective, "Whatever the fingertips ask for");
}

void add_run_options(cli::Command& command, const std::shared_ptr<CommandOptions>& options) {
  session::RunOptions& run_options = options->run;
  add_shape_options(command, *options);
  command.add_option("--rate", run_options.loop.rate_hz, "Ticks a second, 1 to 10000");
  options->loop.add_to(command);
  command.add_option("--switch", options->switch_action,
                     "What the wrist switch does. grab: the hands hold the model while it is on; "
                     "commit: keeps the shape so far; toggle: lets go, takes hold again; keep: "
                     "keeps what was just "
                     "done (--keep-last)");
  session::add_recording_options(command, run_options.recording);
  session::add_overdub_options(command, options->overdub);
  session::add_filter_options(command, options->filter);
  session::add_publish_option(command, options->publish);
  command.add_duration("--duration", run_options.duration_s,
                       "How long, e.g. 30s or 10m; 0: until Ctrl-C, or until the "
                       "gloves are recordings (replay:FILE) that have ended; a window stays open");
  command.add_option("--undo-memory", run_options.undo_memory_mb,
                     "Megabytes that undo and redo may take at most; without it, half of what the "
                     "program may use. Then the oldest steps go");
  command.add_option("--out", run_options.out,
                     "Where to write the shape, .obj or .ply; without it, nendo-<date>-<time>.obj");
  command.add_flag("--force", options->force, cli::force_summary);
  command.add_option("--picture", run_options.picture,
                     "Where to draw the model and the hands before and after, .png");
  command.add_flag("--json", run_options.json, "Progress and summary as JSON, an object a line");
  command.add_flag("--verbose", run_options.verbose,
                   "A longer summary: how the shape was kept from folding");
  command.add_option("--web", options->web,
                     "[ADDR:]PORT at which a browser shows the run, with buttons; without ADDR, a "
                     "browser on this machine");
  command.add_option("--out-puppet", options->out_puppet,
                     "Where the window saves a puppet that was edited, .toml; without it, the file "
                     "that was opened, or beside you, named after the model");
  command.add_option("--screenshot", options->view.screenshot,
                     "Where the window's last picture goes, .png");
  command.add_flag("--contact", options->view.contact,
                   "The window shows at first where hands touch clay, and how hard (0)");
  command.add_option("--frames", options->view.frames,
                     "The window's pictures after which it ends; 0: when it is closed");
  command.on_chosen([options, command] {
    options->decided_by_take = command.first_given(
        {"--puppet", "--mask", "--symmetry", "--mode", "--size", "--radius", "--kernel",
         "--polynomial", "--keep-volume", "--hold", "--injective", "--no-injective", "--rate",
         "--policy", "--switch", "--filter", "--filter-min-cutoff", "--filter-beta"});
    return run(*options);
  });
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<CommandOptions>();
  cli::Command command = program.add_command("run", "Shapes a model with one or two gloves");
  command.add_flag("--view", options->view.window, "Opens the live window, as `nendo view` does");
  add_run_options(command, options);
}

void add_view(cli::Command& program) {
  auto options = std::make_shared<CommandOptions>();
  options->view.window = true;
  cli::Command command = program.add_command(
      "view", "As `nendo run`, in a window with the model, the hands and a panel");
  add_run_options(command, options);
}

} // namespace nendo::app::run_command
