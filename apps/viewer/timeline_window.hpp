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

  /// Draws one picture and waits for the screen, or for at most 8 ms if there is none. The
  /// vertices of `scene_frame` are not used. If the user wants to leave with unsaved changes, the
  /// window asks first and then returns `quit`.
  EditActions show(const TimelineView& view, const render::SceneFrame& scene_frame);

  SceneWindow& scene_window() noexcept { return *window_; } ///< to be given a model, and its shapes

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
