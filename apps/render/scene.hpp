#pragma once
// The scene that the renderers draw, one on the processor and one with OpenGL. It consists of
// surfaces of triangles, made from a SceneFrame and the model's faces. Lengths are in metres. The
// model is on the ground, y = 0, around x = z = 0, as large as it is on the stage.

#include <cstdint>
#include <memory>
#include <vector>

#include "render/hand_skin.hpp"
#include "render/scene_frame.hpp"
#include "render/surface.hpp"

namespace nendo::render {

struct SceneParts {
  bool hands = true;     ///< the skin
  bool bones = false;    ///< visible through the skin
  bool vectors = true;   ///< control vectors, as arrows
  bool radii = true;     ///< the radius of each fingertip's support
  bool contacts = false; ///< where hands touch clay, and how hard
  bool ground = true;
  bool coarse_hands = false; ///< with a third of the triangles, for small hands
};

struct Scene {
  Surface model;
  std::vector<Surface> solids;  ///< opaque surfaces other than the model
  std::vector<Surface> veils;   ///< translucent
  std::vector<Surface> grounds; ///< one or none
  /// Returns the points that a camera should have in its picture: the model's and the hands'.
  std::vector<Eigen::Vector3f> outline() const;
  bool operator==(const Scene&) const = default;
};

class SceneBuilder {
public:
  /// `rest` defines the scale and the place for all frames of a take. Its faces are kept. If
  /// units_per_metre is 0, the model is as large as on the loop's stage. Allocates.
  explicit SceneBuilder(const deform::Mesh& rest, double units_per_metre = 0.0);

  /// Makes the scene of a frame, which must have as many vertices as the mesh. Allocates where
  /// `scene` is too small, so it must not be called in the loop's thread.
  void build(const SceneFrame& scene_frame, const SceneParts& parts, Scene& scene) const;
  /// Makes only the parts other than the model, for renderers that light each pixel: the ground is
  /// two triangles. Of scene.model, only the material is set.
  void build_beside(const SceneFrame& scene_frame, const SceneParts& parts, Scene& scene) const;

  double units_per_metre() const noexcept { return units_per_metre_; }
  /// Returns the origin of the scene: place in the scene = vertex / units_per_metre - origin.
  const Eigen::Vector3d& origin_m() const noexcept { return origin_m_; }
  /// Returns the faces to be drawn as triangles, three corners for each, in the order of the
  /// paint's coats. Larger faces are cut as in triangles.hpp.
  const std::vector<std::uint32_t>& corners() const noexcept { return corners_; }
  /// Returns the colours of the triangles.
  const std::shared_ptr<const Paint>& paint() const noexcept { return paint_; }
  /// Returns the size of the rest shape on the stage along x, y and z.
  const Eigen::Vector3d& size_m() const noexcept { return size_m_; }

private:
  void add_hand(const SceneHand& hand, std::size_t slot, const SceneFrame& scene_frame,
                const SceneParts& parts, Scene& scene) const;
  void add_contacts(const SceneFrame& scene_frame, Scene& scene) const;
  void add_wire(const SceneFrame& scene_frame, Scene& scene) const;
  void add_ground(Scene& scene, int cells) const;

  double units_per_metre_;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m_ = Eigen::Vector3d::Zero();
  std::vector<std::uint32_t> corners_;
  /// Vertices without a face. They are invisible, so they are placed where a corner is: a camera
  /// that shows all of the model need not show them.
  std::vector<std::uint32_t> strays_;
  std::uint32_t any_corner_ = 0;
  std::shared_ptr<const Paint> paint_;
};

} // namespace nendo::render
