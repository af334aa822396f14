#pragma once
// The timeline window's panel, its keys, and the question before leaving.

#include "viewer/dope_sheet_widget.hpp"
#include "viewer/timeline_window.hpp"
#include "viewer/tip_mover.hpp"

namespace nendo::viewer {

struct TimelineWindow::Panel {
  static constexpr int gap_px = 10;
  static constexpr int width_px = 300;

  DopeSheetWidget strip;
  TipMover tips;
  Retiming retiming{0.0, 0.0, 2.0};
  bool retiming_shown = false;
  bool keys_shown = false;
  float blend = 0.0F;
  bool blends = false; ///< the mouse holds the slider

  void draw(const TimelineView& view, EditActions& actions);
  /// What keys do. It also draws their list.
  void keys(SceneWindow& window, EditActions& actions);
  /// Quits if `wanted` or the key for it is pressed. If there are unsaved changes, it asks first.
  void leave(const TimelineView& view, bool wanted, EditActions& actions);

private:
  static void file(const TimelineView& view, EditActions& actions);
  void key(const TimelineView& view, EditActions& actions);
  static void functions(const TimelineView& view);
  void whole(const TimelineView& view, EditActions& actions);
};

} // namespace nendo::viewer
