#pragma once
// Changes a value by moving the pointer sideways, or by typing it, with a circle over the picture:
// the radial control of Blender's sculpt mode. Main thread.

#include <functional>
#include <string>

#include <imgui.h>

#include <nendo/flow/setting.hpp>

namespace nendo::viewer {

class ValueGesture {
public:
  struct Quantity {
    std::string name;
    std::string unit;   ///< empty: no unit
    double value = 0.0; ///< in that unit
    flow::Range range;  ///< in that unit
    int decimals = 1;
    double per_px = 0.0; ///< the length of a pixel; 0: a disc shows the part of the range's end
  };

  /// Begins where the pointer is. `use` gets the confirmed value, within the range.
  void begin(const Quantity& quantity, std::function<void(double value)> use);
  bool is_on() const noexcept { return use_ != nullptr; }
  /// Follows the pointer and the keyboard, which no other widget gets meanwhile, and draws the
  /// circle. A left click or Enter confirms, a right click or Esc cancels.
  void follow();
  /// Returns the value, and what can be done: "radius 4.2 cm: ...".
  std::string message() const;

private:
  std::string value_text() const;
  void read_keys();
  void draw() const;

  Quantity quantity_;
  std::function<void(double)> use_;
  std::string typed_;
  double value_ = 0.0;
  ImVec2 begun_;   ///< where the pointer was
  float x_ = 0.0F; ///< where it is
};

} // namespace nendo::viewer
