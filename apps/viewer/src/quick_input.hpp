#pragma once
// ImGui looks at keyboard and mouse once a picture. Where pictures take long, as without a graphics
// card, a key is down and up again between two looks, and the pointer is elsewhere when the button
// is seen to be down. Here a tap waits for the next picture, and a press is where it was.

#include <deque>
#include <optional>

namespace nendo::viewer {

/// All on the main thread.
class QuickInput {
public:
  /// A key went down: GLFW's number of it.
  void press(int key, bool control, bool shift);
  /// The pointer has moved: pixels from the window's top left corner.
  void point(double x, double y) noexcept {
    pointer_ = {static_cast<float>(x), static_cast<float>(y)};
  }
  /// A button went down, where the pointer was then.
  void click() noexcept;
  /// Before a picture of ImGui's begins, when its back end has told what is down now.
  void put();
  /// After it: the keyboard is again as its back end has told; it tells of the pointer each time.
  void take_back();

private:
  struct Place {
    float x = 0.0F, y = 0.0F;
  };
  struct Tap {
    int key;
    bool control;
    bool shift;
  };

  std::deque<Tap> waiting_;
  Place pointer_;
  std::optional<Place> clicked_; ///< since the last picture
  int last_ = 0;                 ///< put for the latest picture; 0: none
  std::optional<Tap> beside_;    ///< while a tap is put: what the modifiers really are
};

} // namespace nendo::viewer
