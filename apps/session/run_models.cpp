#include "session/run_models.hpp"

#include <chrono>
#include <utility>

namespace nendo::session {

Result<void> RunModels::prepare(const flow::ModelVersion& version) {
  for (Sink* sink : sinks_)
    if (auto prepared = sink->prepare(version); !prepared) return prepared;
  return {};
}

std::optional<std::string> RunModels::go_to(const flow::Awaited& awaited) {
  flow::DeformLoop& loop = *placed_.loop;
  if (is_handing_over() || loop.is_changing()) return std::nullopt; // it is asked for again
  const flow::ModelVersion* const version = loop.model(awaited.model);
  if (version != nullptr && version != &loop.newest_model())
    if (const auto prepared = prepare(*version); !prepared) return prepared.error().message;
  if (loop.change_to(awaited)) return std::nullopt;
  return "settings that nothing can be done with; the run goes on as it was";
}

std::optional<std::string> RunModels::follow(bool may_begin) {
  using std::chrono::seconds;
  flow::DeformLoop& loop = *placed_.loop;
  if (stage_ == Stage::handing_over && !loop.is_changing()) stage_ = Stage::none;
  if (stage_ == Stage::holding_still && loop.is_still()) return hand_over();
  if (making_.valid() && making_.wait_for(seconds(0)) == std::future_status::ready)
    finer_ = making_.get();
  if (finer_ && stage_ == Stage::none && may_begin && loop.hold_still())
    stage_ = Stage::holding_still;
  if (asked_ && !finer_ && !making_.valid() && !is_handing_over()) return begin();
  return std::nullopt;
}

std::optional<std::string> RunModels::begin() {
  asked_ = false;
  const flow::ModelVersion& model = placed_.loop->newest_model();
  if (!flow::FinerModel::can_be_made_of(model))
    return "the model has " + std::to_string(model.layout().vertex_count()) +
           " vertices and cannot be subdivided again; the run goes on as it was";
  making_ = std::async(std::launch::async,
                       [&model] { return std::make_unique<flow::FinerModel>(model); });
  return std::nullopt;
}

/// The loop holds still.
std::optional<std::string> RunModels::hand_over() {
  flow::DeformLoop& loop = *placed_.loop;
  const std::unique_ptr<flow::FinerModel> finer = std::exchange(finer_, nullptr);
  stage_ = Stage::handing_over;
  if (!finer->is_of(loop.newest_model())) { // somebody has undone meanwhile
    loop.keep_model();
    asked_ = true; // of the model that there is now
    return std::nullopt;
  }
  Result<void> prepared;
  const bool takes = loop.change_model(*finer, [&](const auto& version) {
    prepared = prepare(version);
    return static_cast<bool>(prepared);
  });
  if (!takes) return prepared.error().message + "; the model stays as it is";
  return "the model has " + std::to_string(loop.newest_model().layout().vertex_count()) +
         " vertices now";
}

} // namespace nendo::session
