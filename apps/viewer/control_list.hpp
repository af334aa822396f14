#pragma once
// The controls that a window shows, by which tests press them, and find what overlaps.

#include <span>
#include <string>

#include <Eigen/Core>

namespace nendo::viewer {

/// A control of the current picture, as far as it can be seen.
struct Control {
  std::string name;
  Eigen::Vector2f min, max; ///< pixels from the window's top left corner
  bool is_possible = true;
  bool is_cut = false; ///< its text is wider than it, or it is wider than what it is in
};
/// Returns the controls that were drawn since forget_controls(). Main thread.
std::span<const Control> controls() noexcept;
void forget_controls() noexcept;
/// Returns the tooltip of the current picture; empty: none.
const std::string& tooltip() noexcept;

} // namespace nendo::viewer
