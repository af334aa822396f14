#pragma once
// Edits a puppet in a window: draws its points, their displacements, their reach along the surface
// and its masks, and handles the mouse.

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <nendo/deform/surface_graph.hpp>

#include "render/scene.hpp"
#include "viewer/puppet_editor.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::viewer {

class PuppetMarks {
public:
  /// Returns coloured patches of the model: the reach of the chosen point or pending place, and the
  /// masks. Updates them when the editor's version changes.
  const std::vector<render::Surface>& veils(const PuppetEditor& editor,
                                            const render::SceneBuilder& builder);

private:
  void make(const PuppetEditor& editor, const render::SceneBuilder& builder);
  void add_reach(const PuppetEditor& editor);
  void add_masks(const PuppetEditor& editor);
  void add_veil(const render::Material& material,
                const std::function<bool(std::uint32_t vertex)>& takes);

  std::vector<render::Surface> veils_;
  std::uint64_t version_ = 0;
  std::uint64_t model_version_ = 0;
  std::optional<deform::SurfaceGraph> graph_;
  render::Surface model_; ///< a little outside of the surface
};

/// How the window shows the model, in its units.
struct ModelPicture {
  ModelPicture(const SceneWindow& window, double units_per_metre);
  /// Returns the place under the mouse of a model in this shape; nothing if the mouse is beside it.
  /// `rest` determines its triangulation.
  std::optional<SurfaceHit> hit_of_mouse(const deform::Mesh& shape,
                                         const deform::Points& rest) const;

  render::Camera camera;
  render::Size size;
};

/// Draws the points as marks over the picture, with names, and with arrows for their displacements
/// by the chosen function. Of many points, only the chosen and the `hovered` one have names.
void draw_points(const PuppetEditor& editor, const ModelPicture& picture, std::size_t hovered);

class PuppetTool {
public:
  /// Handles the mouse: a click places or chooses a point; a drag sets its displacement, with shift
  /// its rotation; the wheel sets its radius; the brush paints. Returns true if it has used the
  /// mouse.
  bool follow(const ModelPicture& picture, PuppetEditor& editor);
  std::size_t hovered() const noexcept { return hovered_; } ///< point under the mouse, or none

private:
  bool brush(const ModelPicture& picture, PuppetEditor& editor);
  static void drag(const ModelPicture& picture, PuppetEditor& editor);
  bool take_point(const ModelPicture& picture, PuppetEditor& editor);

  std::size_t hovered_ = PuppetEditor::none;
  std::optional<Eigen::Vector2d> pressed_at_; ///< a press beside all points
  bool holds_pending_ = false;                ///< drags the pending place
  bool paints_ = false;
};

} // namespace nendo::viewer
