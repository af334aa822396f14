#pragma once
// A window for editing a timeline. It has the scene at the play head's time and, below it, a strip
// with the hands' keys. It only shows the timeline and returns what the user wants to do. All calls
// belong to the main thread, as window systems demand.

#include <memory>
#include <string>

#include "viewer/scene_window.hpp"
#include "viewer/timeline_view.hpp"

namespace nendo::viewer {

class TimelineWindow {
public:
  /// Opens a window. Error: failed (no screen, no OpenGL 3.3). The message ends with `instead`,
  /// which must say what to do without a window.
  static Result<std::unique_ptr<TimelineWindow>> open(const std::string& title, render::Size size,
                                                      const std::string& instead);
  ~TimelineWindow();
  TimelineWindow(const TimelineWindow&) = delete;
  TimelineWindow& operator=(const TimelineWindow&) = delete;

  void set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder) {
    window_->set_model(layout, builder);
  }
  /// Sets the shape of the model from the next picture on.
  void follow(const deform::BlockShape& shape) { window_->follow(shape); }
  /// Draws one picture and waits for the screen, or for at most 8 ms if there is none. The
  /// vertices of `scene_frame` are not used. If the user wants to leave with unsaved changes, the
  /// window asks first and then returns `quit`.
  EditActions show(const TimelineView& view, const render::SceneFrame& scene_frame);

  const SceneWindow& scene_window() const noexcept { return *window_; }
  render::Image screenshot() { return window_->screenshot(); } ///< the last picture
  void simulate(const SimulatedInput& input) { window_->simulate(input); }

private:
  struct Panel;
  explicit TimelineWindow(std::unique_ptr<SceneWindow> window);
  bool move_tip(const TimelineView& view, const render::SceneFrame& scene_frame,
                EditActions& actions);
  void mark_tips(const TimelineView& view, const render::SceneFrame& scene_frame) const;

  std::unique_ptr<SceneWindow> window_;
  std::unique_ptr<Panel> panel_;
};

} // namespace nendo::viewer
