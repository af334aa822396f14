#include "motions/kneading_hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::motions {
namespace {

constexpr double knead_step_s = 1.0 / 60.0;
constexpr std::array<std::string_view, knead_tasks.size()> task_names{
    "press", "knead", "grip", "carry", "bore", "cut", "slice"};

/// Returns whether a place is where hands take the upper part, within this part of the height.
bool is_upper(double y, double low, double height, double within) noexcept {
  return std::abs(y - low - KneadedModel::upper * height) <= within * height;
}

/// How far vertices of the upper part are from the vertical line through the box's middle.
double upper_radius_of(const deform::Mesh& model, const Eigen::Vector3d& low,
                       const Eigen::Vector3d& high) {
  const Eigen::Vector3d middle = 0.5 * (low + high);
  const double height = high.y() - low.y();
  double farthest = 0.0;
  for (const auto vertex : model.vertices.colwise())
    if (is_upper(vertex.y(), low.y(), height, 0.05))
      farthest = std::max(farthest, std::abs(vertex.x() - middle.x()));
  return farthest;
}

/// The middle of the box around the section at the neck, or of the whole model if there is none.
Eigen::Vector3d neck_of(const deform::Mesh& model, const Eigen::Vector3d& low,
                        const Eigen::Vector3d& high) {
  const double neck = low.y() + KneadedModel::neck_at * (high.y() - low.y());
  Eigen::AlignedBox3d section;
  deform::for_each_triangle(model, [&](const std::array<std::uint32_t, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d from = model.vertices.col(corners[k]);
      const Eigen::Vector3d to = model.vertices.col(corners[(k + 1) % 3]);
      if ((from.y() < neck) == (to.y() < neck)) continue;
      const double part = (neck - from.y()) / (to.y() - from.y());
      section.extend(Eigen::Vector3d(from + part * (to - from)));
    }
  });
  Eigen::Vector3d middle =
      section.isEmpty() ? Eigen::Vector3d(0.5 * (low + high)) : section.center();
  middle.y() = neck;
  return middle;
}

KneadedModel kneaded(const deform::Mesh& model, double scale) {
  const Eigen::Vector3d low = model.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = model.vertices.rowwise().maxCoeff();
  return {scale * low, scale * high, scale * upper_radius_of(model, low, high),
          scale * neck_of(model, low, high)};
}

/// Where the upper part reaches the farthest to a side: 1 to +X, -1 to -X.
Eigen::Vector3d farthest_of_upper(const deform::Mesh& model, double side) {
  const Eigen::VectorXd heights = model.vertices.row(1);
  const double low = heights.minCoeff();
  const double height = heights.maxCoeff() - low;
  Eigen::Vector3d farthest = model.vertices.col(0);
  double most = -std::numeric_limits<double>::max();
  for (const auto vertex : model.vertices.colwise()) {
    if (!is_upper(vertex.y(), low, height, 0.1) || side * vertex.x() <= most) continue;
    most = side * vertex.x();
    farthest = vertex;
  }
  return farthest;
}

/// Of models side by side, the one that is the farthest on the hand's side; nothing if no two parts
/// lie beside each other, as a head does not lie beside its trunk.
std::optional<deform::Mesh> outermost(const deform::Mesh& model, double side) {
  std::vector<deform::Mesh> parts = deform::separate(model);
  const auto reach = [&](const deform::Mesh& part) {
    return std::pair(part.vertices.row(0).minCoeff(), part.vertices.row(0).maxCoeff());
  };
  const auto out = [&](const deform::Mesh& part) {
    const auto [low, high] = reach(part);
    return side * (low + high);
  };
  const auto chosen = std::max_element(
      parts.begin(), parts.end(), [&](const auto& a, const auto& b) { return out(a) < out(b); });
  if (chosen == parts.end()) return std::nullopt;
  const auto own = reach(*chosen);
  const bool is_apart = std::any_of(parts.begin(), parts.end(), [&](const deform::Mesh& other) {
    const auto [least, most] = reach(other);
    return std::min(own.second, most) - std::max(own.first, least) < 0.0;
  });
  return is_apart ? std::optional(std::move(*chosen)) : std::nullopt;
}

} // namespace

std::string_view name_of(KneadTask task) noexcept {
  return task_names[static_cast<std::size_t>(task)];
}

Result<KneadingHand> KneadingHand::make(const deform::Mesh& model,
                                        const hand::HandSkeleton& skeleton, KneadTask task,
                                        double model_size_m) {
  if (model.vertices.cols() == 0) return Error{Errc::bad_input, "the model has no vertices"};
  const Eigen::Vector3d low = model.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = model.vertices.rowwise().maxCoeff();
  const double size = (high - low).maxCoeff();
  if (!(size > 0.0) || !std::isfinite(size))
    return Error{Errc::bad_input, "the model has no size, so hands find nothing to press"};
  const double scale = model_size_m / size;
  const double side = skeleton.side() == Side::right ? 1.0 : -1.0;
  const auto alone = task == KneadTask::carry ? outermost(model, side) : std::nullopt;
  KneadedModel on_stage = kneaded(alone ? *alone : model, scale);
  if (alone) on_stage.taken_at = scale * farthest_of_upper(*alone, side);
  const auto plan = plan_of(task, on_stage, skeleton);
  const auto count = static_cast<std::size_t>(std::ceil(plan->length_s() / knead_step_s)) + 1;
  auto keys = std::make_shared<std::vector<hand::JointAngles>>();
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t key = 0; key < count; ++key) {
    const KneadPlan::Pose pose =
        plan->at(std::min(knead_step_s * static_cast<double>(key), plan->length_s()));
    keys->push_back(pose.angles);
    poses.push_back(pose.T_stage_wrist);
  }
  KneadingHand hand;
  hand.keys_ = std::move(keys);
  hand.wrist_ = std::make_shared<const flow::WristPath>(std::move(poses), knead_step_s);
  return hand;
}

hand::JointAngles KneadingHand::angles(double time_s) const noexcept {
  const auto [first, part] = wrist_->place(time_s);
  return blended((*keys_)[first], (*keys_)[first + 1], part);
}

hand::SensorAngles KneadingHand::sensor_angles(double time_s) const noexcept {
  return sensor_angles_of(angles(time_s));
}

} // namespace nendo::motions
