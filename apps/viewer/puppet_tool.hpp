#pragma once
// The mouse on a model whose puppet is edited.

#include <optional>

#include "viewer/puppet_marks.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::viewer {

class PuppetTool {
public:
  /// Does what the mouse asks for: a click places a point, or chooses one; a drag of a point sets
  /// where it goes, with shift how it turns; the wheel over one sets its radius; the brush paints.
  /// Returns true if the mouse does nothing else then.
  bool follow(const SceneWindow& window, double units_per_metre, PuppetEditor& editor);
  std::size_t hovered() const noexcept { return hovered_; } ///< point under the mouse; none

private:
  static void turn(const render::Camera& camera, render::Size size, double units_per_metre,
                   PuppetEditor& editor);
  bool brush(const SceneWindow& window, double units_per_metre, PuppetEditor& editor);
  static std::optional<SurfaceHit> hit(const SceneWindow& window, double units_per_metre,
                                       const PuppetEditor& editor);

  std::size_t hovered_ = PuppetEditor::none;
  std::optional<Eigen::Vector2d> pressed_at_; ///< not on a point
  bool holds_pending_ = false;                ///< the mark of a place that waits for its finger
  bool paints_ = false;
};

} // namespace nendo::viewer
