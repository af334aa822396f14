#pragma once
// Makes short key presses and clicks visible to ImGui, which looks at keyboard and mouse once for
// each picture. Where a picture takes long, as without a graphics card, a key can go down and up
// again between two looks, and the pointer can have moved on before the button is seen to be down.
// Here a short key press waits for the next picture, and a click keeps its place.

#include <deque>
#include <optional>

namespace nendo::viewer {

/// All calls belong to the main thread.
class QuickInput {
public:
  /// Reports that a key went down. key: GLFW's number.
  void press(int key, bool control, bool shift);
  /// Reports that the pointer has moved, in pixels from the window's top left corner.
  void point(double x, double y) noexcept {
    pointer_ = {static_cast<float>(x), static_cast<float>(y)};
  }
  /// Reports that a button went down at the place of the pointer.
  void click() noexcept;
  /// Passes the waiting input to ImGui. It must be called before ImGui begins a picture, after its
  /// back end has reported the present state.
  void put();
  /// Sets the keyboard back to the state that the back end reported. It must be called after the
  /// picture. The back end reports the pointer for each picture, so the pointer needs no reset.
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
  int last_ = 0;                 ///< the key that was passed for the latest picture; 0 means none
  std::optional<Tap> beside_;    ///< while a tap is passed: the real state of the modifiers
};

} // namespace nendo::viewer
