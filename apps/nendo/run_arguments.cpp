#include "nendo/run_arguments.hpp"

#include <array>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/refinement.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/puppet/puppet.hpp>
#include <nendo/sculpting/placing.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "cli/quantities.hpp"
#include "nendo/model_output.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::run_command {
namespace {

std::string dated_name() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char name[64];
  std::strftime(name, sizeof name, "nendo-%Y%m%d-%H%M%S.obj", &local);
  return name;
}

/// Returns whether puppets or masks can be edited during the run.
bool is_edited(const RunArguments& options) {
  return options.view.window || !options.web.empty();
}

/// An existing file is overwritten only if it is the one that was opened.
Result<void> check_out_puppet(const RunArguments& options) {
  if (options.out_puppet.empty()) return {};
  if (!is_edited(options))
    return Error{Errc::usage, "--out-puppet: needs the window, or a page; add --view or --web"};
  std::error_code ignored;
  const bool is_opened =
      std::filesystem::equivalent(options.out_puppet, options.run.puppet_file, ignored);
  if (!is_opened && !options.force && std::filesystem::exists(options.out_puppet, ignored))
    return Error{Errc::usage,
                 "--out-puppet " + options.out_puppet + ": exists; --force replaces it"};
  return cli::check_place("--out-puppet", options.out_puppet, {".toml"});
}

Result<void> check_outputs(RunArguments& options) {
  const session::RunOptions& run = options.run;
  const session::ViewOptions& view = options.view;
  if (auto fine = check_view(options); !fine) return fine;
  const std::string& model = run.over ? run.over->take.setup.loop->mesh : run.mesh;
  if (auto fine = cli::check_place("--out", run.out, deform::mesh_endings); !fine) return fine;
  if (auto fine = cli::check_spares(model, "--out", run.out, options.force); !fine) return fine;
  if (auto fine = cli::check_place("--record", run.recording.file); !fine) return fine;
  if (auto fine = check_out_puppet(options); !fine) return fine;
  for (const auto& [option, file] :
       {std::pair{"--picture", &run.picture}, {"--screenshot", &view.screenshot}})
    if (auto fine = cli::check_place(option, *file, {".png"}); !fine) return fine;
  return cli::check_distinct({{"--out", run.out},
                              {"--picture", run.picture},
                              {"--record", run.recording.file},
                              {"--out-puppet", options.out_puppet},
                              {"--screenshot", view.screenshot}});
}

/// Reads the puppet's file, or a shipped puppet. Its model is beside it.
Result<void> read_puppet(RunArguments& options) {
  session::RunOptions& run = options.run;
  std::error_code ignored;
  if (is_edited(options)) {
    const bool is_opened =
        std::filesystem::equivalent(options.out_puppet, run.puppet_file, ignored);
    run.out_puppet = {options.out_puppet, options.force || is_opened};
  }
  const bool is_named =
      !run.puppet_file.empty() && std::filesystem::exists(run.puppet_file, ignored);
  if (options.view.window && !run.puppet_file.empty() && !run.mesh.empty() && !is_named &&
      ends_in(run.puppet_file, ".toml")) { // a new one
    if (run.out_puppet.file.empty()) run.out_puppet.file = run.puppet_file;
    run.loop.held = false;
    return {};
  }
  if (is_named && is_edited(options) && options.out_puppet.empty())
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
Result<void> read_masks(RunArguments& options) {
  session::RunOptions& run = options.run;
  const char* const option = !run.mask_file.empty() ? "--mask" : "--symmetry";
  if ((!run.mask_file.empty() || run.symmetric) && !run.puppet_file.empty())
    return Error{Errc::usage, std::string(option) + ": cannot be combined with --puppet; put "
                                                    "[[masks]] and mirror into the puppet's file"};
  if (run.mask_file.empty()) return {};
  auto masks = puppet::read_puppet(run.mask_file);
  if (!masks) return masks.error();
  if (masks->is_played())
    return Error{Errc::bad_input, run.mask_file +
                                      ": has points and functions, so it is a puppet; open it with "
                                      "--puppet, or keep only its [[masks]]"};
  run.masks = *std::move(masks);
  return {};
}

/// Reads the take to play over, if one is named. Its model and its settings are the run's.
Result<void> read_take(RunArguments& options) {
  session::RunOptions& run = options.run;
  if (!options.overdub.take.empty() && !options.decided_by_take.empty())
    return Error{Errc::usage, options.decided_by_take + ": cannot be combined with --over, whose "
                                                        "recording sets it; leave it out"};
  auto over = session::read_overdub(options.overdub);
  if (!over) return over.error();
  run.over = *std::move(over);
  auto live = session::live_part(options.overdub, run);
  if (!live) return live.error();
  run.live = *std::move(live);
  return {};
}

/// Checks the requested settings, and not the defaults.
Result<void> check_settings(RunArguments& options) {
  const session::RunOptions& run = options.run;
  const flow::LoopSettings& asked = options.asked;
  constexpr auto naming = flow::Naming::options;
  if (!run.puppet && !run.puppet_file.empty()) // a new one
    if (auto fine = flow::compatible(asked, flow::Played::through_air, naming); !fine) return fine;
  const auto played = run.puppet ? flow::played_by(*run.puppet) : flow::Played::nothing;
  if (auto fine = flow::all_effective(asked, played, naming); !fine) return fine;
  if (run.changes_topology && run.puppet)
    return Error{Errc::usage,
                 "--topology: cannot be combined with --puppet, with which key O does the same"};
  return {};
}

Result<void> set_size(RunArguments& options) {
  session::RunOptions& run = options.run;
  run.model_size_m = sculpting::usual_size_m(run.loop.sculptor.mode);
  if (options.size.empty()) return {};
  auto size_m = to_metres(options.size);
  if (const auto size_cm = cli::number_of(options.size)) {
    size_m = *size_cm / 100.0;
    cli::note("--size " + options.size + ": has no unit, so it is in centimetres");
  }
  if (!size_m || !sculpting::model_size_range_m.has(*size_m))
    return Error{Errc::usage, "--size " + options.size + ": use " + std::string(cli::length_words) +
                                  ", " + flow::in_words(sculpting::model_size_range_m, "m") +
                                  "; a bare number is centimetres"};
  run.model_size_m = *size_m;
  return {};
}

Result<void> set_wire(RunArguments& options) {
  if (!options.wire.empty() && !options.knife.empty())
    return Error{Errc::usage, "--wire and --knife: give one of them"};
  const bool is_knife = !options.knife.empty();
  const std::string& text = is_knife ? options.knife : options.wire;
  if (text.empty()) return {};
  const auto span =
      cli::parse_time_span(text, is_knife ? "--knife" : "--wire", cli::SpanEnds::both);
  if (!span) return span.error();
  if (options.run.duration_s > 0.0 && span->to_s > options.run.duration_s)
    return Error{Errc::usage,
                 std::string(is_knife ? "--knife " : "--wire ") + text +
                     ": ends after the run; use times within --duration, or a longer --duration"};
  options.run.loop.wire_time = {span->from_s, span->to_s,
                                is_knife ? flow::Blade::knife : flow::Blade::wire};
  return {};
}

Result<void> check_refinable(const deform::Mesh& model, const RunArguments& options) {
  if (options.run.refine_to == 0) return {};
  const auto fine = deform::Refiner::check(model);
  if (fine) return {};
  return Error{
      Errc::bad_input,
      "--refine: " + options.run.mesh + ": " + fine.error().message +
          "; only closed models can be refined, so repair it: `nendo repair IN --out OUT`"};
}

Result<void> set_shaping(RunArguments& options) {
  const auto settings = options.settings.parse();
  if (!settings) return settings.error();
  options.asked = *settings;
  const auto csrbf = session::csrbf_for(*settings, options.polynomial);
  if (!csrbf) return csrbf.error();
  flow::set_plain_settings(options.run.loop.sculptor, *settings);
  options.run.loop.sculptor.deformer.csrbf = *csrbf;
  if (settings->injective && options.not_injective)
    return Error{Errc::usage, "--injective and --no-injective: give one of them"};
  if (const auto supports = session::parse_radius(options.run.radius, 1.0); !supports)
    return supports.error();
  options.run.filter = settings->filter;
  return {};
}

Result<void> set_switch(RunArguments& options) {
  const auto action = flow::switch_action_named(options.switch_action);
  if (!action)
    return Error{Errc::usage, "--switch " + options.switch_action +
                                  ": unknown; use none, grab, commit, toggle or keep"};
  options.run.loop.switch_action = *action;
  return {};
}

Result<void> set_refine(RunArguments& options) {
  session::RunOptions& run = options.run;
  run.refine_to = options.refine_to.value_or(0);
  if (options.refine_to && !(run.refine_to >= 4 && run.refine_to <= flow::Refine{}.max_vertices))
    return Error{Errc::usage, fmt::format("--refine {}: use 4 to {} vertices", run.refine_to,
                                          flow::Refine{}.max_vertices)};
  if (run.changes_topology && !options.refine_to)
    return Error{Errc::usage, "--topology: needs --refine, as --refine 100000"};
  return {};
}

Result<void> set_pace(RunArguments& options) {
  session::RunOptions& run = options.run;
  if (!(run.loop.rate_hz >= flow::TickGrid::min_rate_hz &&
        run.loop.rate_hz <= flow::TickGrid::max_rate_hz))
    return Error{Errc::usage, "--rate: use 1 to 10000 ticks per second"};
  if (auto fine = options.loop.parse(run.loop, run.realtime); !fine) return fine;
  if (auto fine = cli::check_duration(run.duration_s); !fine) return fine;
  if (!(run.undo_memory_mb.value_or(0.0) >= 0.0 && run.undo_memory_mb.value_or(0.0) <= 1e6))
    return Error{Errc::usage, "--undo-memory: use a number of megabytes up to 1000000"};
  return {};
}

Result<void> check_gloves(RunArguments& options) {
  if (auto fine = options.run.length.check(); !fine) return fine;
  return gloves::check(options.run.calibration);
}

Result<void> check_recording(RunArguments& options) {
  session::RunOptions& run = options.run;
  if (run.out.empty()) run.out = dated_name();
  return run.recording.check(run.out, run.loop.switch_action);
}

/// Chooses the files that have no option.
Result<void> choose_files(RunArguments& options) {
  session::RunOptions& run = options.run;
  if (run.mesh.empty() && !run.over)
    run.mesh =
        cli::shipped_model(run.loop.sculptor.mode == flow::Mode::clay ? "clay.ply" : "moai.obj")
            .string();
  if (is_edited(options) && run.out_puppet.file.empty() && !run.over)
    run.out_puppet.file =
        std::filesystem::path(cli::short_name(run.mesh)).replace_extension(".puppet.toml").string();
  return {};
}

} // namespace

Result<void> check_view(const RunArguments& options) {
  const session::ViewOptions& view = options.view;
  if (view.window || (view.frames == 0 && !view.contact && view.screenshot.empty() &&
                      view.theme == session::ViewOptions{}.theme))
    return {};
  return Error{Errc::usage, "--frames, --screenshot, --contact and --theme: need the window; " +
                                std::string(options.studio ? "leave out --web" : "add --view")};
}

Result<void> check(RunArguments& options) {
  options.run.mesh = cli::name_of_files(options.models);
  options.run.reading = takes::reading(options.up);
  constexpr std::array steps{set_shaping,  set_size,       set_wire,     set_switch,
                             set_refine,   set_pace,       check_gloves, check_recording,
                             read_puppet,  check_settings, read_masks,   read_take,
                             choose_files, check_outputs};
  for (const auto step : steps)
    if (auto fine = step(options); !fine) return fine;
  return {};
}

Result<deform::Mesh> read_model(RunArguments& options) {
  session::RunOptions& run = options.run;
  if (!run.over) {
    auto model = takes::read_models(run.mesh, run.reading);
    if (!model) return model.error();
    if (auto fine = check_refinable(model->mesh, options); !fine) return fine.error();
    for (auto* const puppet : {&run.puppet, &run.masks})
      if (*puppet) puppet::count_from(model->mesh.offset, **puppet);
    return std::move(model->mesh);
  }
  const recording::LoopSetup& loop = *run.over->take.setup.loop;
  auto model = takes::find_recorded_model(loop, run.mesh);
  if (!model) return model.error();
  run.reading = model->reading;
  if (!model->is_recorded)
    return Error{Errc::bad_input, run.mesh + ": is not the model of " + run.over->file +
                                      "; --over needs the recorded model"};
  if (run.mesh.empty()) run.mesh = loop.mesh;
  if (auto fine = session::take_over_settings(model->mesh, run); !fine) return fine.error();
  if (auto fine = check_refinable(model->mesh, options); !fine) return fine.error();
  return std::move(model->mesh);
}

} // namespace nendo::app::run_command
