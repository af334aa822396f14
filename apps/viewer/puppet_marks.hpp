#pragma once
// What a window draws of a puppet that is edited: its points, where they go, how far they reach
// along the surface, and what is masked.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/deform/surface_graph.hpp>

#include "render/scene.hpp"
#include "viewer/puppet_editor.hpp"

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
  std::vector<Eigen::Vector3f> places_; ///< of the model's vertices, a little above the surface
  std::vector<std::uint32_t> corners_;
};

/// Draws the points as marks over the picture, with an arrow to where each goes in the chosen
/// function, and with their names; of many points, only the chosen one and the one under the mouse
/// (`hovered`, or none) have theirs.
void draw_points(const PuppetEditor& editor, const render::Camera& stage_camera, render::Size size,
                 double units_per_metre, std::size_t hovered);

/// Returns the point whose mark is under the pointer; PuppetEditor::none.
std::size_t point_at(const PuppetEditor& editor, const render::Camera& stage_camera,
                     render::Size size, double units_per_metre, const Eigen::Vector2d& pointer);

/// Returns true if the mark of the place that waits for its finger is under the pointer.
bool is_at_pending(const PuppetEditor& editor, const render::Camera& stage_camera,
                   render::Size size, double units_per_metre, const Eigen::Vector2d& pointer);

} // namespace nendo::viewer
