#pragma once
// Editing a timeline in a window, picture by picture. Main thread.

#include <memory>
#include <optional>

#include <nendo/base/result.hpp>

#include "edit/edit_session.hpp"
#include "viewer/timeline_window.hpp"

namespace nendo::edit {

class WindowEditing {
public:
  /// `session` must outlive this. `model` is the timeline's before the hands.
  WindowEditing(std::shared_ptr<viewer::SceneWindow> window, EditSession& session,
                std::shared_ptr<const flow::ModelVersion> model);

  /// Draws one picture, and does what the user asks for. Error: the shapes cannot be made.
  Result<void> show();
  /// Shows the model again, after something else was shown in the window.
  void show_again();
  /// Returns whether the last picture was final: its shapes are those of their times.
  bool is_settled() const noexcept { return is_settled_; }
  /// Returns whether the user has asked to quit, in the last picture.
  bool quits() const noexcept { return quits_; }

private:
  std::shared_ptr<viewer::SceneWindow> window_;
  viewer::TimelineWindow timeline_window_;
  EditSession& session_;
  std::shared_ptr<const flow::ModelVersion> model_; ///< the one that the window shows
  std::optional<HostTime> before_;
  bool is_settled_ = false;
  bool quits_ = false;
};

} // namespace nendo::edit
