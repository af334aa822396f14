#pragma once
// The dope sheet below the scene: pictures of the shape, and play head, keys and marks, which the
// mouse can move.

#include <map>
#include <memory>
#include <optional>

#include "gl/picture.hpp"
#include "viewer/timeline_view.hpp"

namespace nendo::viewer {

class DopeSheetWidget {
public:
  /// Returns the height in pixels of a strip with this number of lanes, controls included.
  static int height_for(std::size_t lanes) noexcept;
  /// Draws the strip at the window's bottom, over its whole width. shaded: times to highlight.
  void draw(const TimelineView& view, const std::optional<Retiming>& shaded, EditActions& actions);

private:
  struct Taken {
    StripKey key;
    double pressed_x = 0.0;
    bool moved = false;
  };
  void follow_pictures(const std::vector<StripPicture>& shown);
  void controls(const TimelineView& view, EditActions& actions) const;
  void follow_mouse(const TimelineView& view, double x, double y, EditActions& actions);
  void press(const TimelineView& view, double x, double y, EditActions& actions);
  void drag(const TimelineView& view, double x, EditActions& actions);

  /// On the graphics card, those that the strip shows now.
  std::map<std::shared_ptr<const render::Image>, gl::Picture> pictures_;
  DopeSheet strip_;
  std::optional<Taken> taken_; ///< a key that the mouse holds
  bool scrubs_ = false;
  double head_s_ = 0.0; ///< the play head at the last picture
};

} // namespace nendo::viewer
