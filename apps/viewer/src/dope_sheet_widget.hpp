#pragma once
// The strip below the scene: play head, keys, marks, and the mouse on them.

#include <optional>

#include <nendo/viewer/timeline_view.hpp>

namespace nendo::viewer {

class DopeSheetWidget {
public:
  /// Of a strip with so many lanes, controls included; pixels.
  static int height_for(std::size_t lanes) noexcept;
  /// Over the window's whole width, at its bottom. shaded: times that are to stand out.
  void draw(const TimelineView& view, const std::optional<Retiming>& shaded, EditActions& actions);

private:
  struct Taken {
    StripKey key;
    double pressed_x = 0.0;
    bool moved = false;
  };
  void controls(const TimelineView& view, EditActions& actions) const;
  void follow_mouse(const TimelineView& view, double x, double y, EditActions& actions);
  void press(const TimelineView& view, double x, double y, EditActions& actions);
  void drag(const TimelineView& view, double x, EditActions& actions);

  DopeSheet strip_;
  std::optional<Taken> taken_; ///< a key that the mouse holds
  bool scrubs_ = false;
  double head_s_ = 0.0; ///< at the last picture
};

} // namespace nendo::viewer
