#include "edit/window_editing.hpp"

#include <utility>

namespace nendo::edit {

WindowEditing::WindowEditing(std::shared_ptr<viewer::SceneWindow> window, EditSession& session,
                             std::shared_ptr<const flow::ModelVersion> model)
    : window_(window), timeline_window_(std::move(window)), session_(session),
      model_(std::move(model)) {
  show_again();
}

void WindowEditing::show_again() {
  const double units_per_metre = session_.history().timeline().units_per_metre;
  window_->set_model(model_->layout(), render::SceneBuilder(model_->mesh, units_per_metre));
  before_.reset();
}

Result<void> WindowEditing::show() {
  const HostTime now = HostClock::now();
  session_.advance(to_seconds(now - before_.value_or(now)));
  before_ = now;
  const auto found = session_.shape();
  if (found.shape && found.shape->model != model_) {
    model_ = found.shape->model;
    show_again();
    before_ = now;
  }
  if (found.shape) window_->follow(found.shape->shape);
  const forms::TimelineView& view = session_.view();
  is_settled_ = found.fresh && !view.computing && session_.has_all_pictures();
  const forms::EditActions actions = timeline_window_.show(view, session_.scene_frame());
  session_.handle(actions);
  quits_ = actions.quit;
  if (auto error = session_.progress().error) return *std::move(error);
  return {};
}

} // namespace nendo::edit
