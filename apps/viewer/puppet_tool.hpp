#pragma once
// A puppet that is edited, in a window: its points, where they go, how far they reach along the
// surface, its masks, and the mouse on the model.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/deform/surface_graph.hpp>

#include "render/scene.hpp"
#include "viewer/puppet_editor.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::viewer {

class PuppetMarks {
public:
  /// Returns coloured patches of the model: the reach of the chosen point, or of the place that was
  /// clicked, and the masks. They are made again when the editor's version changes.
  const std::vector<render::Surface>& veils(const PuppetEditor& editor,
                                            const render::SceneBuilder& builder);

private:
  void make(const PuppetEditor& editor, const render::SceneBuilder& builder);
  void add_reach(const PuppetEditor& editor);
  void add_masks(const PuppetEditor& editor);
  template <class Takes>
  void add_veil(const render::Material& material, const Takes& takes);

  std::vector<render::Surface> veils_;
  std::uint64_t version_ = 0;
  std::uint64_t model_version_ = 0;
  std::optional<deform::SurfaceGraph> graph_;
  std::vector<Eigen::Vector3f> places_; ///< the model's vertices, a little above the surface
  std::vector<std::uint32_t> corners_;
};

/// Draws the points as marks over the picture, with an arrow to where each goes in the chosen
/// function, and with their names; of many points, only the chosen one and the one under the mouse
/// (`hovered`, or none) have theirs.
void draw_points(const PuppetEditor& editor, const render::Camera& stage_camera, render::Size size,
                 double units_per_metre, std::size_t hovered);

class PuppetTool {
public:
  /// Does what the mouse asks for: a click places a point, or chooses one; a drag of a point sets
  /// where it goes, with shift how it turns; the wheel over one sets its radius; the brush paints.
  /// Returns true if the mouse does nothing else then.
  bool follow(const SceneWindow& window, double units_per_metre, PuppetEditor& editor);
  std::size_t hovered() const noexcept { return hovered_; } ///< point under the mouse; none

private:
  bool brush(const SceneWindow& window, double units_per_metre, PuppetEditor& editor);

  std::size_t hovered_ = PuppetEditor::none;
  std::optional<Eigen::Vector2d> pressed_at_; ///< not on a point
  bool holds_pending_ = false;                ///< the mark of a place that waits for its finger
  bool paints_ = false;
};

} // namespace nendo::viewer
