#include "session/run_models.hpp"

#include <algorithm>
#include <chrono>

#include <nendo/deform/topology.hpp>
#include <nendo/deform/triangles.hpp>

#include "commands/commands.hpp"

namespace nendo::session {

namespace {

/// Min time between two searches for edges that are too long or too short.
constexpr std::chrono::milliseconds look_interval(500);
/// Min number of such edges for another version of the model: the larger of these.
constexpr std::size_t min_unfit = 24;
constexpr double min_unfit_fraction = 0.004; ///< a fraction of the vertices
/// Factor during a stroke, because the new version ends it.
constexpr double in_a_stroke = 5.0;

std::string parts_text(const flow::ModelVersion& model) {
  const auto parts = deform::ModelParts(model.mesh, model.layout()).count();
  return parts == 1 ? "the model is one part now"
                    : "the model has " + std::to_string(parts) + " parts now";
}

bool is_part_edit(const flow::ChangeModel& change) noexcept {
  return change.source == flow::ModelSource::copied || change.source == flow::ModelSource::removed;
}

/// Returns whether the topology of a shape of that model would change.
bool is_thin(const flow::ModelVersion& model, const deform::BlockShape& shape) {
  deform::Points places;
  model.layout().unpack(shape, places);
  const deform::Mesh shaped = deform::in_shape(model.mesh, std::move(places));
  if (deform::count_thin_places(shaped) == 0) return false;
  const auto changed = deform::change_topology(shaped);
  return changed && changed->counts.all() > 0;
}

std::uint64_t newest_stamp(const deform::BlockShape& shape) {
  std::uint64_t newest = 0;
  for (std::size_t block = 0; block < shape.block_count(); ++block)
    newest = std::max(newest, shape.stamp(block));
  return newest;
}

} // namespace

Result<void> RunModels::prepare(const flow::ModelVersion& version) {
  for (Sink* sink : sinks_)
    if (auto prepared = sink->prepare(version); !prepared) return prepared;
  return {};
}

std::optional<Report> RunModels::go_to(const flow::Awaited& awaited) {
  flow::DeformLoop& loop = *placed_.loop;
  if (is_handing_over() || loop.changes().is_changing())
    return std::nullopt; // the request is repeated
  const auto version = loop.changes().model(awaited.model);
  if (version != nullptr && version.get() != &loop.changes().newest_model())
    if (const auto prepared = prepare(*version); !prepared) return Report(prepared.error());
  const auto changed = loop.changes().change_to(awaited);
  if (changed) return std::nullopt;
  return Report(changed.error().message + "; nothing changed", true);
}

std::optional<Report> RunModels::follow(bool may_begin) {
  using std::chrono::seconds;
  flow::DeformLoop& loop = *placed_.loop;
  if (stage_ == Stage::handing_over && !loop.changes().is_changing()) stage_ = Stage::none;
  if (stage_ == Stage::holding_still && loop.changes().is_still()) return hand_over();
  if (making_.valid() && making_.wait_for(seconds(0)) == std::future_status::ready) {
    Made made = making_.get();
    if (!made.finer) {
      refine_to_ = is_by_itself_ ? 0 : refine_to_;
      return Report("the model " + made.finer.error().message + "; nothing changed", true);
    }
    if (is_by_itself_) made_.source = made.source;
    if (is_by_itself_ && made.is_wanted) was_refined_ = made.source == flow::ModelSource::refined;
    if (made.is_wanted) finer_ = *std::move(made.finer);
  }
  // Another version that was not requested must not discard the redo steps.
  if (is_by_itself_ && stage_ == Stage::none && loop.frames().front().redo_steps > 0)
    finer_.reset();
  if (finer_ && stage_ == Stage::none && may_begin && loop.changes().hold_still())
    stage_ = Stage::holding_still;
  if (asked_ && !finer_ && !making_.valid() && !is_handing_over()) return begin();
  if (refine_to_ > 0 && !asked_ && !finer_ && !making_.valid() && !is_handing_over()) look();
  return std::nullopt;
}

/// Starts a thread that checks whether the newest shape needs refining, and prepares it.
void RunModels::look() {
  flow::DeformLoop& loop = *placed_.loop;
  const flow::Frame& frame = loop.frames().front();
  const flow::ModelVersion& model = loop.changes().newest_model();
  const HostTime now = HostClock::now();
  if (now - looked_at_ < look_interval || frame.model != model.number || frame.redo_steps > 0)
    return;
  looked_at_ = now;
  const std::pair look{newest_stamp(frame.shape), frame.steps.in_hand};
  if (std::exchange(last_look_, look) == look) return;
  made_ = {0, flow::ModelSource::refined, refine_to_};
  is_by_itself_ = true;
  const double fraction = min_unfit_fraction * (frame.steps.in_hand ? in_a_stroke : 1.0);
  const auto least = std::max(
      min_unfit,
      static_cast<std::size_t>(fraction * static_cast<double>(model.layout().vertex_count())));
  // Refinement finds thin places better, but hands that stretch clay all the time would suppress
  // changes of topology: so they alternate if both are needed.
  making_ = std::async(std::launch::async, [&model, least, how = made_, shape = frame.shape,
                                            changes_topology = changes_topology_,
                                            was_refined = was_refined_] {
    constexpr flow::ChangeModel change{0, flow::ModelSource::topology};
    const auto changed = [&] {
      return Made{flow::PendingModel::make(model, change), true, change.source};
    };
    if (changes_topology && was_refined && is_thin(model, shape)) return changed();
    Made made{flow::PendingModel::make(model, how)};
    if (!made.finer) return made;
    made.is_wanted = made.finer->count_unfit(shape) >= least;
    if (changes_topology && !was_refined && !made.is_wanted && is_thin(model, shape))
      return changed();
    return made;
  });
}

/// Chooses the part to edit. Returns a message for the user if there is none.
std::optional<Report> RunModels::choose_part() {
  flow::DeformLoop& loop = *placed_.loop;
  const flow::Frame& frame = loop.frames().front();
  made_.part =
      frame.model == loop.changes().newest_model().number ? frame.parts.chosen : deform::no_index;
  if (made_.part != deform::no_index) return std::nullopt;
  return Report(commands::no_part, true);
}

std::optional<Report> RunModels::begin() {
  made_ = *std::exchange(asked_, {});
  is_by_itself_ = false;
  if (is_part_edit(made_) && made_.part == deform::no_index)
    if (auto refusal = choose_part()) return refusal;
  const flow::ModelVersion& model = placed_.loop->changes().newest_model();
  making_ = std::async(std::launch::async, [&model, how = made_, wire = wire_] {
    return Made{flow::PendingModel::make(model, how, wire.places())};
  });
  return std::nullopt;
}

/// Gives the new version to the loop, which holds still.
std::optional<Report> RunModels::hand_over() {
  flow::DeformLoop& loop = *placed_.loop;
  std::optional<flow::PendingModel> finer = std::exchange(finer_, {});
  stage_ = Stage::handing_over;
  if (!finer->is_of(loop.changes().newest_model())) { // an undo came first
    loop.changes().keep_model();
    if (is_part_edit(made_)) return Report("the model has changed; choose the part again", true);
    if (!is_by_itself_) asked_ = made_; // from the current model
    return std::nullopt;
  }
  const auto taken =
      loop.changes().change_model(*finer, [this](const auto& version) { return prepare(version); });
  // Automatic changes happen many times per minute.
  const bool is_topology = made_.source == flow::ModelSource::topology;
  if (is_by_itself_ && (finer->found_nothing() || (taken && !is_topology))) return std::nullopt;
  if (!taken) return Report(taken.error().message + "; the model stays as it is", true);
  if (is_topology)
    return "thin places have parted, opened or fused; " + parts_text(loop.changes().newest_model());
  if (is_of_shape(made_.source)) return parts_text(loop.changes().newest_model());
  return "the model has " + std::to_string(loop.changes().newest_model().layout().vertex_count()) +
         " vertices now";
}

} // namespace nendo::session
