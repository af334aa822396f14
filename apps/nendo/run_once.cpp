// One run: from its arguments to its report.
#include "nendo/run_once.hpp"

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
#include "nendo/model_output.hpp"
#include "session/run_and_report.hpp"

namespace nendo::app::run_command {
namespace {

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

} // namespace

Result<int> run_once(RunArguments& options, const OpenWindow& open_window) {
  if (const auto fine = check(options); !fine) return fine.error();
  auto published = session::publish_to(options.publish);
  if (!published) return published.error();
  auto model = read_model(options);
  if (!model) return model.error();
  warn_about_radius(*model, options);
  note_inside(*model, options.run);
  choose_injective(*model, options);
  cli::install_stop_signals();
  session::RunOptions& wanted = options.run;
  const flow::RealtimeProcess process(wanted.realtime);
  session::RunParticipants participants;
  if (open_window) {
    const auto window = open_window(options);
    if (!window) return window.error();
    participants.observers.push_back(*window);
  }
  std::unique_ptr<session::BrowserView> browser;
  if (!options.page && !options.web.empty()) {
    auto opened = session::open_web_server(options.web);
    if (!opened) return opened.error();
    options.page = *std::move(opened);
  }
  if (options.page) {
    browser = session::browser_view(options.page, wanted.mesh);
    participants.sinks.push_back(browser.get());
    participants.observers.insert(participants.observers.begin(), browser.get());
  }
  EventCount event_count;
  auto opened = session::open_hands(wanted, *model, event_count);
  if (!opened) return opened.error();
  const auto outcome = session::run_and_report(wanted, *opened, *std::move(model), *published,
                                               std::move(participants), process.grants());
  if (!outcome) return outcome.error();
  if (const auto kept = keep_learned(wanted, opened->hands, outcome->stats); !kept)
    return kept.error();
  const bool recorded =
      std::all_of(outcome->recordings.begin(), outcome->recordings.end(),
                  [](const auto& of_loop) { return of_loop.recorded.has_value(); });
  return recorded ? 0 : static_cast<int>(Errc::failed);
}

} // namespace nendo::app::run_command
