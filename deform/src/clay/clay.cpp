// A ClayDeformer, and how its work handles clay that is held or that lies on nothing, and ends a
// call: the volume is given back, or all is put off.

#include <nendo/deform/clay.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "clay/clay_work.hpp"
#include "history/sculpted_parts.hpp"
#include "simd/contact_kernels.hpp"

namespace nendo::deform {

using Eigen::Vector3d;

namespace {

// What is pressed out appears from a body's surface on more and more, and all of it this far away.
// Nearer, it would close over a hand, and fold when that leaves.
constexpr double free_mm = 30.0;
constexpr double max_swell = 1.0 / 3.0; // of that, in a call: then slopes are at most a half
constexpr double swell_reach = 3.0;     // of that, from the contacts
constexpr double volume_is_kept = 1e-5; // relative
constexpr double max_left = 0.9;        // share of the previously missing volume; else it is left

// Hands touch nearly all vertices of a box that has eight of them, and what is free swells by as
// much as the box is long, of which the second order knows nothing.
constexpr std::size_t max_coarse_vertices = 200;
constexpr double missing_in_coarse = 1e-4; // relative; less comes out as in other models
constexpr double max_scaling = 2.0;

/// The middle of the shape's box, or of its floor.
Eigen::Vector3d middle_of_box(const BoundedShape& shape, bool of_floor) noexcept {
  Eigen::Vector3d middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float high = shape.bounds[0].sides[axis], negated_low = shape.bounds[0].sides[axis + 4];
    for (const BlockBounds& box : shape.bounds) {
      high = std::max(high, box.sides[axis]);
      negated_low = std::max(negated_low, box.sides[axis + 4]);
    }
    const bool is_floor = of_floor && axis == 1;
    middle[static_cast<Eigen::Index>(axis)] =
        is_floor ? -static_cast<double>(negated_low)
                 : 0.5 * (static_cast<double>(high) - static_cast<double>(negated_low));
  }
  return middle;
}

/// Moves all vertices, with bounds and stamps.
template <class Move>
void move_vertices(BoundedShape& shape, const Move& move) noexcept {
  const std::uint64_t stamp = BlockShape::new_stamp();
  for (std::size_t block = 0; block < shape.bounds.size(); ++block) {
    VertexBlock& content = shape.shape.data()[block];
    for (std::size_t lane = 0; lane < block_size; ++lane)
      set_vertex(content, lane, move(vertex_in(content, lane)));
    shape.shape.set_stamp(block, stamp);
    shape.bounds[block] = fast_bounds_of(content);
  }
}

void scale_about(const Eigen::Vector3d& middle, double factor, BoundedShape& shape) noexcept {
  const Eigen::Vector3f centre = middle.cast<float>();
  const auto by = static_cast<float>(factor);
  move_vertices(shape, [&](const Eigen::Vector3f& at) -> Eigen::Vector3f {
    return centre + by * (at - centre);
  });
  shape.extent = std::max(1.0, factor) * shape.extent + std::abs(factor - 1.0) * middle.norm();
}

} // namespace

ClayDeformer::ClayDeformer(SculptedShape& shape, std::span<const std::uint32_t> triangles,
                           std::size_t bodies, std::size_t parts_per_body,
                           const ClayOptions& options)
    : shape_(&shape),
      work_(std::make_unique<Work>(shape, triangles, bodies, parts_per_body, options)) {}
ClayDeformer::~ClayDeformer() = default;
ClayDeformer::ClayDeformer(ClayDeformer&&) noexcept = default;
ClayDeformer& ClayDeformer::operator=(ClayDeformer&&) noexcept = default;

FieldStatus ClayDeformer::begin(std::span<const ContactPart> parts) {
  if (!work_->accepts(parts)) return FieldStatus::not_finite;
  shape_->parts().keep();
  return grab(parts);
}

void ClayDeformer::continue_from(const ClayDeformer& before, bool keeps_volume) noexcept {
  work_->continue_from(*before.work_, keeps_volume);
}

void ClayDeformer::release(bool is_step) noexcept {
  if (is_step) shape_->parts().keep();
  work_->release();
}

const ClayReport& ClayDeformer::press_to(std::span<const ContactPart> parts) {
  report_ = {};
  if (!work_->accepts(parts)) {
    report_.status = FieldStatus::not_finite;
  } else if (!work_->holds()) {
    report_.status = begin(parts);
  } else {
    work_->press(shape_->parts().change(), parts, report_);
  }
  return report_;
}

std::span<const ClayContact> ClayDeformer::contacts() const noexcept {
  return work_->contacts();
}

double ClayDeformer::volume() const noexcept {
  return work_->volume();
}

FieldStatus ClayDeformer::grab(std::span<const ContactPart> parts) {
  if (!work_->accepts(parts)) return FieldStatus::not_finite;
  work_->take_hold(shape_->parts().now, parts);
  return FieldStatus::ok;
}

FieldStatus ClayDeformer::go(HistoryMove move, std::span<const ContactPart> parts) {
  if (move == HistoryMove::redo && shape_->redo_steps() == 0) return FieldStatus::ok;
  if (!work_->accepts(parts)) return FieldStatus::not_finite;
  shape_->parts().go(move);
  return grab(parts);
}

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

/// Returns whether the volume was measured.
bool ClayDeformer::Work::give_back(BoundedShape& shape, bool is_pressed,
                                   ClayReport& report) noexcept {
  if (!volume_.is_closed() || !(std::abs(whole_volume_) > 0.0)) return false;
  if (!is_pressed && !is_settling_) return false;
  const double before = volume_.volume(shape) - whole_volume_;
  double change = before;
  const double kept = volume_is_kept * std::abs(whole_volume_);
  if (is_pressed || std::abs(change) > kept) {
    const double near = std::max(radius_, free_mm * mm_);
    const GiveBack how{near, max_swell * near, swells_all_ ? nullptr : &around_,
                       swell_reach * near};
    masked_.begin(shape.shape);
    const double given = volume_.give_back(shape, search_, -change, how);
    report.is_moved = report.is_moved || given != 0.0;
    swells_all_ = std::abs(given) < 0.999 * std::abs(change);
    change += given;
    if (masked_.mask() != nullptr) {
      masked_.end(shape);
      for (const VertexMask::Part& part : masked_.mask()->parts())
        volume_.read_again(part.block);
      change = volume_.volume(shape) - whole_volume_;
    } else if (is_coarse()) {
      change = scale_to_volume(shape, report);
    }
  }
  // Where a mask holds nearly all, nothing may be left that can move.
  note_volume(change, is_pressed, std::abs(before), report);
  return true;
}

bool ClayDeformer::Work::is_coarse() const noexcept {
  return layout_.vertex_count() <= max_coarse_vertices && masked_.mask() == nullptr;
}

/// Of a coarse model, what is missing then comes out everywhere alike, which no faces can be in the
/// way of. Returns what is missing afterwards.
double ClayDeformer::Work::scale_to_volume(BoundedShape& shape, ClayReport& report) noexcept {
  const double change = volume_.volume(shape) - whole_volume_;
  const double times = whole_volume_ / (whole_volume_ + change);
  if (std::abs(change) <= missing_in_coarse * std::abs(whole_volume_) ||
      !(times >= 1.0 / max_scaling && times <= max_scaling))
    return change;
  const double factor = std::cbrt(times);
  const Eigen::Vector3d middle = middle_of_box(shape, options_.lies_on_table);
  scale_about(middle, factor, shape);
  for (Grip& grip : grips_)
    for (HeldPoint& point : grip.held())
      point.at = middle + factor * (point.at - middle);
  report.is_moved = true;
  return volume_.volume(shape) - whole_volume_;
}

/// Later calls give back what `change` is too much or too little, unless this one has pressed
/// nothing and left `most` or more.
void ClayDeformer::Work::note_volume(double change, bool is_pressed, double most,
                                     ClayReport& report) noexcept {
  const double off = std::abs(change);
  is_settling_ = off > volume_is_kept * std::abs(whole_volume_) && (is_pressed || off < most);
  volume_now_ = whole_volume_ + change;
  report.volume_change = change / whole_volume_;
}

/// Gives the volume back, and returns whether faces could be kept apart then.
bool ClayDeformer::Work::finish(BoundedShape& shape, ClayReport& report) noexcept {
  const bool is_pressed = report.passes > 0;
  const double before = std::abs(volume_now_ - whole_volume_);
  if (!give_back(shape, is_pressed, report)) return true;
  const std::optional<std::size_t> moved = zones_->keep_apart(shape, volume_, masked_.mask());
  report.kept_apart = moved.value_or(0);
  // Where faces were in its way, not all has come out that was given back.
  if (report.kept_apart > 0) {
    const double change =
        is_coarse() ? scale_to_volume(shape, report) : volume_.volume(shape) - whole_volume_;
    note_volume(change, is_pressed, max_left * before, report);
  }
  return moved.has_value();
}

/// Where faces cannot be kept apart, nothing has happened, and the bodies' way waits: the next call
/// divides it into more sub-steps.
void ClayDeformer::Work::put_off(double way, double volume, ClayReport& report) noexcept {
  skins_ = skins_before_;
  is_settling_ = false;
  volume_now_ = volume;
  report.volume_change = volume / whole_volume_ - 1.0;
  report.remaining_path_mm = way / mm_;
  report.carried_mm = report.turned_rad = 0.0;
  report.is_moved = false;
}

} // namespace nendo::deform
