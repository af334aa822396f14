// How the clay's work handles clay that bodies hold, or that lies on nothing.

#include "clay/clay_work.hpp"

#include <algorithm>
#include <cstddef>

namespace nendo::deform {

using Eigen::Vector3d;

namespace {

constexpr double held_radius = 1.2; // of the pulling functions, in radii
constexpr int max_links = 12;       // of a sub-step, for what is held
constexpr double still_mm = 1e-4;   // a model that moves less as a whole does not

/// The mean of the blocks' middles.
Vector3d middle_of(const BoundedShape& shape) noexcept {
  Vector3d sum = Vector3d::Zero();
  for (const BlockBounds& box : shape.bounds)
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto side = static_cast<std::size_t>(axis);
      sum[axis] += 0.5 * static_cast<double>(box.sides[side] - box.sides[side + 4]);
    }
  return sum / static_cast<double>(std::max<std::size_t>(1, shape.bounds.size()));
}

void move_rigidly(BoundedShape& shape, const Eigen::Isometry3d& rigid) noexcept {
  const Eigen::Matrix3f turn = rigid.linear().cast<float>();
  const Eigen::Vector3f way = rigid.translation().cast<float>();
  move_vertices(shape, [&](const Eigen::Vector3f& at) -> Eigen::Vector3f {
    return {turn(0, 0) * at[0] + turn(0, 1) * at[1] + turn(0, 2) * at[2] + way[0],
            turn(1, 0) * at[0] + turn(1, 1) * at[1] + turn(1, 2) * at[2] + way[1],
            turn(2, 0) * at[0] + turn(2, 1) * at[1] + turn(2, 2) * at[2] + way[2]};
  });
  shape.extent = 1.8 * shape.extent + rigid.translation().norm();
}

} // namespace

bool ClayDeformer::Work::holds_any() const noexcept {
  return std::any_of(grips_.begin(), grips_.end(), [](const Grip& grip) { return grip.holds(); });
}

void ClayDeformer::Work::continue_from(const Work& before, bool keeps_volume) noexcept {
  if (before.from_.size() != from_.size() || before.parts_per_body_ != parts_per_body_ ||
      before.options_.units_per_mm != options_.units_per_mm)
    return;
  const double scale = before.layout_.unit() / layout_.unit();
  const Vector3d origin = (before.layout_.origin() - layout_.origin()) / layout_.unit();
  const auto move = [&](const ContactPart& part) {
    ContactPart moved = part;
    for (std::size_t corner = 0; corner < part.corner_count; ++corner) {
      moved.corners[corner] = scale * part.corners[corner] + origin;
      moved.radii[corner] *= scale;
    }
    moved.frame.translation() = scale * part.frame.translation() + origin;
    return moved;
  };
  std::transform(before.from_.begin(), before.from_.end(), from_.begin(), move);
  std::transform(before.skins_.begin(), before.skins_.end(), skins_.begin(), move);
  for (std::size_t body = 0; body < grips_.size(); ++body)
    grips_[body].take_over(before.grips_[body], scale, origin);
  leave_out_held(true);
  around_ = before.around_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto from = static_cast<float>(origin[static_cast<Eigen::Index>(axis)]);
    float& high = around_.limits.sides[axis];
    float& negated_low = around_.limits.sides[axis + 4];
    high = static_cast<float>(scale) * high + from;
    negated_low = static_cast<float>(scale) * negated_low - from;
  }
  swells_all_ = before.swells_all_;
  if (!keeps_volume || !volume_.is_closed() || !before.volume_.is_closed()) return;
  whole_volume_ = before.whole_volume_ * scale * scale * scale;
  is_settling_ = true;
}

/// Parts that hold do not press as well.
void ClayDeformer::Work::leave_out_held(bool is_out) noexcept {
  for (std::size_t part = 0; part < from_.size(); ++part)
    search_.leave_out(part, is_out && grips_[part / parts_per_body_].holds(part));
}

/// At the end of a call.
void ClayDeformer::Work::look_for_grips(ClayReport& report) noexcept {
  for (Grip& grip : grips_)
    grip.begin_look();
  for (const ContactPoint& point : choose())
    grips_[point.body].look(point, loads_[point.body].at(point.place, -point.depth));
  bool is_changed = false;
  for (Grip& grip : grips_) {
    is_changed = grip.end_look(skins_) || is_changed;
    report.held += grip.held().size();
  }
  if (is_changed) leave_out_held(true);
}

/// Moves the model as a rigid body.
void ClayDeformer::Work::carry(BoundedShape& shape, ClayReport& report) noexcept {
  carriers_.clear();
  const Eigen::Isometry3d stays = Eigen::Isometry3d::Identity();
  for (const ContactPoint& point : choose()) {
    const Eigen::Isometry3d& way = is_dragging_ ? ways_[point.part] : stays;
    carriers_.push_back({point.at, point.normal, way * point.at - point.at, point.depth,
                         loads_[point.body].at(point.place, -point.depth)});
  }
  for (Grip& grip : grips_)
    for (const HeldPoint& point : grip.held())
      carriers_.push_back({point.at, Vector3d::Zero(), point.goal - point.at, 0.0, 0.0});
  const Vector3d middle = middle_of(shape);
  rigid_ = fit_rigid_motion(carriers_, middle, options_.friction, load_mm * mm_);
  const double way = (rigid_ * middle - middle).norm();
  const double turn = Eigen::AngleAxisd(rigid_.linear()).angle();
  if (way <= still_mm * mm_ && turn * radius_ <= still_mm * mm_) {
    rigid_.setIdentity();
    return;
  }
  move_rigidly(shape, rigid_);
  for (Grip& grip : grips_)
    for (HeldPoint& point : grip.held())
      point.at = rigid_ * point.at;
  report.carried_mm += way / mm_;
  report.turned_rad += turn;
}

/// What is held follows the parts that hold it, in fields that do not fold.
void ClayDeformer::Work::pull(BoundedShape& shape, ClayReport& report) noexcept {
  for (int link = 0; link < max_links; ++link) {
    const bool is_whole = pull_once(shape);
    ++report.passes;
    if (is_whole) return;
  }
}

/// Returns true if all is where it shall be, or nothing can be done.
bool ClayDeformer::Work::pull_once(BoundedShape& shape) noexcept {
  const double radius = held_radius * radius_;
  Eigen::Index count = 0;
  for (Grip& grip : grips_)
    for (const HeldPoint& point : grip.held())
      pull_.add(static_cast<std::size_t>(count++), point.at, point.goal - point.at);

  const double bound = pull_.solve(static_cast<std::size_t>(count), radius);
  const double part = bound > max_bound ? max_bound / bound : 1.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    field_.centres.col(i) = layout_.origin() + layout_.unit() * pull_.place(at);
    field_.coefficients.col(i) = part * layout_.unit() * pull_.coefficient(at);
  }
  field_.radii.head(count).setConstant(layout_.rounded_radius(radius * layout_.unit()));
  if (!displace(shape, count)) return true;
  for (Grip& grip : grips_)
    for (HeldPoint& point : grip.held())
      point.at += part * pull_.field_at(point.at);
  return part == 1.0;
}

} // namespace nendo::deform
