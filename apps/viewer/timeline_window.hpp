#pragma once
// A window for editing a timeline: the scene at the play head's time and, below it, a strip with
// the hands' keys. It shows the timeline, and returns the user's actions. Main thread, as window
// systems require.

#include <memory>
#include <string>

#include "forms/timeline_view.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::viewer {

class TimelineWindow {
public:
  /// Draws into `window`, not null, which others may use between two pictures.
  explicit TimelineWindow(std::shared_ptr<SceneWindow> window);
  ~TimelineWindow();
  TimelineWindow(const TimelineWindow&) = delete;
  TimelineWindow& operator=(const TimelineWindow&) = delete;

  /// Draws one picture and waits for the screen, or for at most 8 ms if there is none. Ignores the
  /// vertices of `scene_frame`.
  forms::EditActions show(const forms::TimelineView& view, const render::SceneFrame& scene_frame);

  SceneWindow& scene_window() noexcept { return *window_; } ///< the caller sets model and shapes

private:
  struct Panel;
  bool move_tip(const forms::TimelineView& view, const render::SceneFrame& scene_frame,
                forms::EditActions& actions);
  void mark_tips(const forms::TimelineView& view, const render::SceneFrame& scene_frame) const;

  std::shared_ptr<SceneWindow> window_;
  std::unique_ptr<Panel> panel_;
};

} // namespace nendo::viewer
