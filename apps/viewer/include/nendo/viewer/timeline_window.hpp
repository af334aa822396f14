#pragma once
// A window to edit a timeline in: the scene at the play head's time, and below it a strip with the
// hands' keys. It only shows and asks; on the main thread, as windows demand.

#include <memory>
#include <string>

#include <nendo/viewer/scene_window.hpp>
#include <nendo/viewer/timeline_view.hpp>

namespace nendo::viewer {

class TimelineWindow {
public:
  /// Opens a window. Errors: failed (no screen, no OpenGL 3.3), with `instead`, which says what to
  /// do without.
  static Result<std::unique_ptr<TimelineWindow>> open(const std::string& title, Size size,
                                                      const std::string& instead);
  ~TimelineWindow();
  TimelineWindow(const TimelineWindow&) = delete;
  TimelineWindow& operator=(const TimelineWindow&) = delete;

  void set_model(const deform::BlockLayout& layout, const SceneBuilder& builder) {
    window_->set_model(layout, builder);
  }
  /// The model, from the next picture on.
  void follow(const deform::BlockShape& shape) { window_->follow(shape); }
  /// One picture; waits for the screen, 20 ms at most without one. Of the moment, all but its
  /// vertices. Who wants to leave with unsaved changes is asked first, and then says `quit`.
  EditActions show(const TimelineView& view, const SceneFrame& moment);

  const SceneWindow& scene_window() const noexcept { return *window_; }
  void pretend(const PretendedInput& input) { window_->pretend(input); }

private:
  struct Panel;
  explicit TimelineWindow(std::unique_ptr<SceneWindow> window);
  bool move_tip(const TimelineView& view, const SceneFrame& moment, EditActions& actions);
  void mark_tips(const TimelineView& view, const SceneFrame& moment) const;

  std::unique_ptr<SceneWindow> window_;
  std::unique_ptr<Panel> panel_;
};

} // namespace nendo::viewer
