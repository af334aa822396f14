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
/// Replaces the file that the environment variable NENDO_CONTROLS names, if there is one, by a line
/// for each control: min x, min y, max x, max y, 1 or 0 for is_possible, and the name. By it a
/// program that moves the mouse finds what to press. Main thread; blocks for the file.
void write_controls();

} // namespace nendo::viewer
