#pragma once
// What both renderers draw, the one on the processor and the one in OpenGL: surfaces of triangles,
// made of a moment and the model's faces. In metres; the model stands on the ground, y = 0, about
// x = z = 0, as large as it is on the stage.

#include <cstdint>
#include <vector>

#include <nendo/viewer/hand_skin.hpp>
#include <nendo/viewer/scene_frame.hpp>
#include <nendo/viewer/surface.hpp>

namespace nendo::viewer {

struct SceneParts {
  bool hands = true;   ///< skin
  bool bones = true;   ///< seen through the skin
  bool vectors = true; ///< control vectors, as arrows
  bool radii = true;   ///< how far each fingertip's support reaches
  bool ground = true;
};

struct Scene {
  Surface model;
  std::vector<Surface> solids;  ///< opaque, beside the model
  std::vector<Surface> veils;   ///< translucent
  std::vector<Surface> grounds; ///< one or none
  /// What a camera ought to have in its picture: the model and the hands.
  std::vector<Eigen::Vector3f> outline() const;
};

class SceneBuilder {
public:
  /// `rest` settles scale and place for all moments of a take; its faces are kept. With no
  /// units_per_metre, the model is as large as on the loop's stage. Allocates.
  explicit SceneBuilder(const deform::Mesh& rest, double units_per_metre = 0.0);

  /// Off the loop: allocates where `scene` has not had as much before. The moment's vertices are as
  /// many as the mesh's.
  void build(const SceneFrame& moment, const SceneParts& parts, Scene& scene) const;
  /// The parts beside the model alone; of scene.model only the material.
  void build_beside(const SceneFrame& moment, const SceneParts& parts, Scene& scene) const;

  double units_per_metre() const noexcept { return units_per_metre_; }
  /// scene = vertex / units_per_metre - origin.
  const Eigen::Vector3d& origin_m() const noexcept { return origin_m_; }
  /// Three a triangle; the faces, cut into fans.
  const std::vector<std::uint32_t>& corners() const noexcept { return corners_; }
  /// Of the rest shape on the stage, x, y, z.
  const Eigen::Vector3d& size_m() const noexcept { return size_m_; }

private:
  void add_hand(const SeenHand& hand, std::size_t slot, const SceneFrame& moment,
                const SceneParts& parts, Scene& scene) const;
  void add_ground(Scene& scene) const;

  double units_per_metre_;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m_ = Eigen::Vector3d::Zero();
  std::vector<std::uint32_t> corners_;
};

} // namespace nendo::viewer
