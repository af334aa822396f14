#pragma once
// Maps pixels to places in the scene and on a model, and moves a hand or a fingertip with the
// mouse.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/surface_graph.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/wrist.hpp>

#include "render/camera.hpp"
#include "render/image.hpp"

namespace nendo::viewer {

/// Returns the pixel of a place, from the picture's top left corner; nothing if the place is behind
/// the camera.
std::optional<Eigen::Vector2d> pixel_of(const render::Camera& camera, const Eigen::Vector3d& place,
                                        render::Size size) noexcept;

struct NearPlace {
  Eigen::Index at = 0;
  double px = 0.0; ///< its distance from the pointer in the picture
};
/// Returns the place that is nearest to the pointer in the picture, of those within `reach_px`.
std::optional<NearPlace> nearest_in_picture(const render::Camera& camera,
                                            const Eigen::Ref<const deform::Points>& places,
                                            const Eigen::Vector2d& pointer, render::Size size,
                                            double reach_px) noexcept;

/// Returns the displacement, in the camera's units, that moves `place` by these pixels in the
/// picture while its depth stays the same. `height` is the picture's height in pixels.
Eigen::Vector3d way_in_picture(const render::Camera& camera, const Eigen::Vector3d& place,
                               double dx, double dy, double height) noexcept;

struct Ray {
  Eigen::Vector3d from;
  Eigen::Vector3d along; ///< unit length
};

/// Returns the ray through a pixel, from the picture's top left corner.
Ray ray_at(const render::Camera& camera, const Eigen::Vector2d& pixel, render::Size size) noexcept;

/// A place on a surface, with the normal of its triangle on the ray's side.
struct SurfaceHit {
  Eigen::Vector3d at;
  Eigen::Vector3d normal;
  deform::SurfacePosition in_mesh{}; ///< the place in any shape of the mesh
};

/// Returns the first intersection of the ray with the mesh; nothing if there is none. Tests all
/// triangles. `rest` has the rest positions of a shaped model, which determine its triangulation
/// (triangles.hpp); null: the mesh's own positions.
std::optional<SurfaceHit> first_hit(const deform::Mesh& mesh, const Ray& ray,
                                    const deform::Points* rest = nullptr);

/// A place on the stage that the mouse moves within a box, as a timeline's fingertip.
class PlaceMover {
public:
  /// Takes the place. The box: as far as arms reach from `middle_m` on each axis, and up to the
  /// place itself.
  void begin(const Eigen::Vector3d& place_m, const Eigen::Vector3d& middle_m) noexcept;
  /// Moves it by the pointer's motion in pixels, in the picture's plane, so that it stays under the
  /// pointer. `height` is the picture's height in pixels.
  void shift(const render::Camera& camera, double dx, double dy, double height) noexcept;
  /// Moves it by steps of the wheel, 1 cm each. Positive steps go away from the viewer.
  void push(const render::Camera& camera, double steps) noexcept;
  const Eigen::Vector3d& place_m() const noexcept { return place_m_; }

private:
  void go_by(const Eigen::Vector3d& way_m) noexcept;

  Eigen::Vector3d place_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d lowest_m_ = Eigen::Vector3d::Zero(), highest_m_ = Eigen::Vector3d::Zero();
};

/// Drags a hand, simulated or of a glove without a tracker, while the mouse button is down.
class HandMover : public PlaceMover {
public:
  /// Takes the hand with the joint nearest to the pointer, in pixels from the picture's top left
  /// corner, if a joint is within `reach` pixels.
  static constexpr double reach = 60.0;
  void take(const render::Camera& camera, const flow::Frame& frame, const Eigen::Vector2d& pointer,
            render::Size size) noexcept;
  void release() noexcept { slot_.reset(); }
  bool holds() const noexcept { return slot_.has_value(); }

  /// Rotates the hand about its wrist, around the picture's vertical and horizontal axes, by the
  /// pointer's motion in pixels.
  void turn(const render::Camera& camera, double dx, double dy) noexcept;
  /// Returns the new wrist pose of the held hand.
  flow::WristMove move() const noexcept;

private:
  std::optional<std::size_t> slot_; ///< flow::Placement::index_of(side)
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity(); ///< in T_stage_wrist
};

/// Returns the fingertip nearest to the pointer, in pixels from the picture's top left corner;
/// nothing if none is within 14 pixels.
std::optional<hand::Finger> tip_at(const render::Camera& camera, const hand::HandPose& pose,
                                   const Eigen::Vector2d& pointer, render::Size size) noexcept;

} // namespace nendo::viewer
