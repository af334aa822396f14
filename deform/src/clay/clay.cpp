// A ClayDeformer, and how its work ends a call: the volume is given back, or all is put off.

#include <nendo/deform/clay.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "clay/clay_work.hpp"
#include "history/sculpted_parts.hpp"

namespace nendo::deform {

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
    float low = shape.bounds[0].sides[axis], negated_high = shape.bounds[0].sides[axis + 4];
    for (const BlockBounds& box : shape.bounds) {
      low = std::min(low, box.sides[axis]);
      negated_high = std::min(negated_high, box.sides[axis + 4]);
    }
    const bool is_floor = of_floor && axis == 1;
    middle[static_cast<Eigen::Index>(axis)] =
        is_floor ? static_cast<double>(low)
                 : 0.5 * (static_cast<double>(low) - static_cast<double>(negated_high));
  }
  return middle;
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
