#include "viewer/pointing.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Dense>

#include <nendo/base/units.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::viewer {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<Vector2d> pixel_of(const render::Camera& camera, const Vector3d& place,
                                 render::Size size) noexcept {
  const Eigen::Vector4d clip =
      camera.projection(1.0 * size.width / size.height) * place.homogeneous();
  if (!(clip.w() > 0.0)) return std::nullopt;
  const Vector2d in_picture = clip.head<2>() / clip.w();
  return Vector2d((1.0 + in_picture.x()) / 2 * size.width,
                  (1.0 - in_picture.y()) / 2 * size.height);
}

std::optional<NearPlace> nearest_in_picture(const render::Camera& camera,
                                            const Eigen::Ref<const deform::Points>& places,
                                            const Vector2d& pointer, render::Size size,
                                            double reach_px) noexcept {
  std::optional<NearPlace> nearest;
  for (Eigen::Index at = 0; at < places.cols(); ++at)
    if (const auto pixel = pixel_of(camera, places.col(at), size))
      if (const double px = (*pixel - pointer).norm(); px < (nearest ? nearest->px : reach_px))
        nearest = NearPlace{at, px};
  return nearest;
}

Vector3d way_in_picture(const render::Camera& camera, const Vector3d& place, double dx, double dy,
                        double height) noexcept {
  const Eigen::Matrix3d rows = camera.axes();
  const double depth = std::max(0.0, rows.row(2).dot(camera.eye() - place));
  const double pixel = 2.0 * camera.tangent() * depth / std::max(1.0, height);
  return pixel * (dx * rows.row(0) - dy * rows.row(1)).transpose();
}

namespace {

/// Möller and Trumbore (1997). Returns how far along the ray the triangle is; nothing if the ray
/// misses it.
std::optional<double> distance_to(const Ray& ray, const Vector3d& a, const Vector3d& b,
                                  const Vector3d& c) noexcept {
  const Vector3d ab = b - a, ac = c - a;
  const Vector3d across = ray.along.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0.0) return std::nullopt;
  const Vector3d to = (ray.from - a) / determinant;
  const double u = to.dot(across);
  const Vector3d beside = to.cross(ab);
  const double v = ray.along.dot(beside);
  const double distance = ac.dot(beside);
  constexpr double edge = -1e-12; // shared edges belong to both triangles
  if (!(u >= edge && v >= edge && u + v <= 1.0 - edge && distance > 0.0)) return std::nullopt;
  return distance;
}

} // namespace

Ray ray_at(const render::Camera& camera, const Eigen::Vector2d& pixel, render::Size size) noexcept {
  const double x = 2.0 * pixel.x() / size.width - 1.0;
  const double y = 1.0 - 2.0 * pixel.y() / size.height;
  const double half_width = camera.tangent() * size.width / size.height; // at a distance of 1
  const Vector3d along((x - camera.centre) * half_width, y * camera.tangent(), -1.0);
  return {camera.eye(), camera.axes().transpose() * along.normalized()};
}

std::optional<SurfaceHit> first_hit(const deform::Mesh& mesh, const Ray& ray,
                                    const deform::Points* rest) {
  std::optional<SurfaceHit> hit;
  double nearest = std::numeric_limits<double>::infinity();
  const deform::Points& places = rest != nullptr ? *rest : mesh.vertices;
  deform::for_each_triangle(mesh, places, [&](const deform::Triangle& corners) {
    const Vector3d a = mesh.vertices.col(corners[0]);
    const Vector3d b = mesh.vertices.col(corners[1]);
    const Vector3d c = mesh.vertices.col(corners[2]);
    const auto distance = distance_to(ray, a, b, c);
    if (!distance || *distance >= nearest) return;
    nearest = *distance;
    Vector3d normal = (b - a).cross(c - a).stableNormalized();
    if (normal.dot(ray.along) > 0.0) normal = -normal;
    const Vector3d at = ray.from + nearest * ray.along;
    const Vector3d area = (b - a).cross(c - a);
    const double whole = std::max(area.squaredNorm(), std::numeric_limits<double>::min());
    const double of_b = (at - a).cross(c - a).dot(area) / whole;
    const double of_c = (b - a).cross(at - a).dot(area) / whole;
    hit = SurfaceHit{at, normal, {corners, {1.0 - of_b - of_c, of_b, of_c}}};
  });
  return hit;
}

void PlaceMover::begin(const Vector3d& place_m, const Vector3d& middle_m) noexcept {
  const Vector3d reach_m = Vector3d::Constant(2.0);
  place_m_ = place_m;
  lowest_m_ = place_m.cwiseMin(middle_m - reach_m);
  highest_m_ = place_m.cwiseMax(middle_m + reach_m);
}

void PlaceMover::go_by(const Vector3d& way_m) noexcept {
  place_m_ = (place_m_ + way_m).cwiseMax(lowest_m_).cwiseMin(highest_m_);
}

void PlaceMover::shift(const render::Camera& camera, double dx, double dy, double height) noexcept {
  go_by(way_in_picture(camera, place_m_, dx, dy, height));
}

void PlaceMover::push(const render::Camera& camera, double steps) noexcept {
  constexpr double step_m = 0.01;
  go_by(-step_m * std::clamp(steps, -20.0, 20.0) * camera.axes().row(2).transpose());
}

void HandMover::take(const render::Camera& camera, const flow::Frame& frame,
                     const Vector2d& pointer, render::Size size) noexcept {
  slot_.reset();
  double nearest = reach;
  for (std::size_t slot = 0; slot < frame.hands.size(); ++slot) {
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    Eigen::Matrix<double, 3, hand::joint_count> places;
    for (std::size_t joint = 0; joint < hand::joint_count; ++joint)
      places.col(static_cast<Eigen::Index>(joint)) = hand.pose.joints[joint].translation();
    const auto found = nearest_in_picture(camera, places, pointer, size, nearest);
    if (!found) continue;
    nearest = found->px;
    slot_ = slot;
    rotation_ = Eigen::Quaterniond(hand.T_stage_wrist.linear());
    // About what is looked at: a model need not be in the stage's middle.
    begin(hand.T_stage_wrist.translation(), camera.target);
  }
}

void HandMover::turn(const render::Camera& camera, double dx, double dy) noexcept {
  constexpr double degrees_per_pixel = 0.35; // as the camera turns
  const Eigen::Matrix3d rows = camera.axes();
  const Eigen::AngleAxisd about_up(from_degrees(degrees_per_pixel * dx), rows.row(1).transpose());
  const Eigen::AngleAxisd about_level(from_degrees(degrees_per_pixel * dy),
                                      rows.row(0).transpose());
  rotation_ = (about_level * about_up * rotation_).normalized();
}

flow::WristMove HandMover::move() const noexcept {
  const Side side = slot_ == flow::Placement::index_of(Side::left) ? Side::left : Side::right;
  Eigen::Isometry3d wrist = Eigen::Isometry3d::Identity();
  wrist.linear() = rotation_.toRotationMatrix();
  wrist.translation() = place_m();
  return flow::WristMove::to(side, wrist);
}

std::optional<hand::Finger> tip_at(const render::Camera& camera, const hand::HandPose& pose,
                                   const Vector2d& pointer, render::Size size) noexcept {
  constexpr double reach_px = 14.0;
  const auto tip = nearest_in_picture(camera, pose.fingertip_positions(), pointer, size, reach_px);
  return tip ? std::optional(static_cast<hand::Finger>(tip->at)) : std::nullopt;
}

} // namespace nendo::viewer
