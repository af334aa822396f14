#include "clay/clay_work.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "geometry/usable.hpp"

namespace nendo::deform {

using Eigen::Vector3d;

namespace {

// In millimetres, for hands.
constexpr double margin_mm = 0.5;   // around a body, where surfaces are kept from being pulled in
constexpr double skin_mm = 0.02;    // a surface this deep is outside
constexpr double between_mm = 0.3;  // and this deep it may wait for the next sub-step
constexpr double give_mm = 0.3;     // how far skin is displaced sideways before it drags
constexpr double loaded_mm = 0.01;  // less does not stick
constexpr double max_step_mm = 2.5; // of a body in a sub-step
constexpr double max_straight_mm = 0.2; // a last push, which may fold

// The least radius of functions, in radii of the thickest part. Clay that is softer is pressed into
// layers thinner than any triangle before it gets round a part, and these cross.
constexpr double min_softness = 1.2;
constexpr double cells_per_radius = 3.0;
constexpr double apart_in_cells = 0.6;
constexpr int max_sub_step_passes = 40;
constexpr double max_sub_steps = 1e6; // of a call; so a way of kilometres has larger ones
constexpr float min_free = 0.5F;      // weight of a mask

/// A part of the way from one pose of a body's part to another.
ContactPart between(const ContactPart& a, const ContactPart& b, double share) noexcept {
  ContactPart part = b;
  for (std::size_t at = 0; at < a.corner_count; ++at) {
    part.corners[at] = a.corners[at] + share * (b.corners[at] - a.corners[at]);
    part.radii[at] = a.radii[at] + share * (b.radii[at] - a.radii[at]);
  }
  const Eigen::Quaterniond from(a.frame.linear());
  const Eigen::Quaterniond to(b.frame.linear());
  part.frame.linear() = from.slerp(share, to).toRotationMatrix();
  part.frame.translation() =
      a.frame.translation() + share * (b.frame.translation() - a.frame.translation());
  return part;
}

int max_centres(std::size_t bodies, const ClayOptions& options) noexcept {
  return std::max(options.max_constraints, static_cast<int>(bodies * Grip::max_held));
}

CsrbfField empty_field(int most, double radius, const BlockLayout& layout) {
  CsrbfField field;
  field.centres = Points::Zero(3, most);
  field.coefficients = Points::Zero(3, most);
  field.radii = Eigen::VectorXd::Constant(most, layout.rounded_radius(radius));
  return field;
}

} // namespace

ClayDeformer::Work::Work(const SculptedShape& shape, std::span<const std::uint32_t> triangles,
                         std::size_t bodies, std::size_t parts_per_body, const ClayOptions& options)
    : layout_(shape.layout()), options_(options), mm_(options.units_per_mm / layout_.unit()),
      radius_(options.radius_mm * mm_), parts_per_body_(parts_per_body),
      from_(bodies * parts_per_body), target_(from_), is_(from_), skins_(from_),
      skins_before_(from_), ways_(from_.size(), Eigen::Isometry3d::Identity()),
      boxes_(bodies, BoxGate::shut()), search_(bodies, parts_per_body),
      chosen_(static_cast<std::size_t>(options.max_constraints)),
      loads_(bodies, ContactLoad(layout_.block_count(), load_mm * mm_)),
      problem_(static_cast<std::size_t>(options.max_constraints)),
      frictions_(static_cast<std::size_t>(options.max_constraints)), pull_(bodies * Grip::max_held),
      field_(empty_field(max_centres(bodies, options), options.radius_mm * options.units_per_mm,
                         layout_)),
      evaluator_(layout_, max_centres(bodies, options), options.evaluation), masked_(options.mask),
      volume_(layout_, options.keeps_volume ? triangles : std::span<const std::uint32_t>{}),
      deep_(bodies), pressed_(from_.size()), around_(BoxGate::shut()) {
  contacts_.reserve(static_cast<std::size_t>(options.max_constraints));
  if (volume_.is_closed()) zones_.emplace(layout_, triangles);
  assert(options.still_bodies <= bodies);
  assert(options.units_per_mm > 0.0 && options.radius_mm > 0.0 && options.max_constraints > 0);
  for (std::size_t body = 0; body < bodies; ++body)
    grips_.emplace_back(body * parts_per_body, parts_per_body, mm_);
  for (std::vector<std::uint32_t>& blocks : deep_)
    blocks.reserve(layout_.block_count());
  carriers_.reserve(static_cast<std::size_t>(options.max_constraints) + bodies * Grip::max_held);
}

bool ClayDeformer::Work::accepts(std::span<const ContactPart> parts) const noexcept {
  assert(parts.size() == from_.size());
  const double most = max_units * layout_.unit();
  return std::all_of(parts.begin(), parts.end(), [&](const ContactPart& part) {
    bool usable = all_usable(part.frame.matrix(), most);
    for (std::size_t at = 0; at < part.corner_count; ++at)
      usable = usable && all_usable(part.corners[at], most) && part.radii[at] > 0.0 &&
               part.radii[at] <= most;
    return usable;
  });
}

void ClayDeformer::Work::pack(std::span<const ContactPart> parts,
                              std::vector<ContactPart>& packed) const noexcept {
  const auto place = [&](const Vector3d& model) -> Vector3d {
    return (model - layout_.origin()) / layout_.unit();
  };
  for (std::size_t at = 0; at < parts.size(); ++at) {
    packed[at] = parts[at];
    for (std::size_t corner = 0; corner < parts[at].corner_count; ++corner) {
      packed[at].corners[corner] = place(parts[at].corners[corner]);
      packed[at].radii[corner] /= layout_.unit();
    }
    packed[at].frame.translation() = place(parts[at].frame.translation());
  }
}

void ClayDeformer::Work::take_hold(const BoundedShape& shape,
                                   std::span<const ContactPart> parts) noexcept {
  pack(parts, from_);
  double thickest = 0.0;
  for (const ContactPart& part : from_)
    for (std::size_t corner = 0; corner < part.corner_count; ++corner)
      thickest = std::max(thickest, part.radii[corner]);
  radius_ = std::max(options_.radius_mm * mm_, min_softness * thickest);
  skins_ = from_;
  for (ContactLoad& load : loads_)
    load.clear();
  for (Grip& grip : grips_)
    grip.release();
  leave_out_held(true);
  if (volume_.is_closed()) volume_now_ = whole_volume_ = volume_.volume(shape);
  contacts_.clear();
  is_settling_ = swells_all_ = false;
  around_ = BoxGate::shut();
  holds_ = true;
}

double ClayDeformer::Work::way_to_target() const noexcept {
  double way = 0.0;
  for (std::size_t at = 0; at < from_.size(); ++at)
    for (std::size_t corner = 0; corner < from_[at].corner_count; ++corner)
      way = std::max(way, (target_[at].corners[corner] - from_[at].corners[corner]).norm() +
                              std::abs(target_[at].radii[corner] - from_[at].radii[corner]));
  return way;
}

/// All that a body sweeps over lies in the box of both poses. Bodies that do not move come to
/// nothing.
bool ClayDeformer::Work::is_way_free(const BoundedShape& shape) noexcept {
  std::fill(boxes_.begin(), boxes_.end(), BoxGate::shut());
  for (std::size_t at = 0; at < from_.size(); ++at) {
    boxes_[at / parts_per_body_].extend(BoxGate::of(from_[at]));
    boxes_[at / parts_per_body_].extend(BoxGate::of(target_[at]));
  }
  return !search_.is_any_near(shape, {boxes_.data(), moving_bodies()}, margin_mm * mm_);
}

void ClayDeformer::Work::place_at(double share) noexcept {
  is_dragging_ = false;
  for (std::size_t at = 0; at < from_.size(); ++at) {
    is_[at] = between(from_[at], target_[at], share);
    drag(at);
  }
  for (Grip& grip : grips_)
    grip.follow(skins_);
  search_.set_parts(is_);
}

/// Skin is soft: what touches it follows a bone only when that has gone farther than the skin
/// yields. So a hand that trembles does not knead.
void ClayDeformer::Work::drag(std::size_t part) noexcept {
  const Eigen::Isometry3d before = skins_[part].frame;
  const Eigen::Isometry3d lag = motion_between(is_[part].frame, before);
  double farthest = 0.0;
  for (std::size_t at = 0; at < is_[part].corner_count; ++at)
    farthest = std::max(farthest, (lag * is_[part].corners[at] - is_[part].corners[at]).norm());
  const double give = give_mm * mm_;
  if (farthest <= give) {
    ways_[part].setIdentity();
    return;
  }
  is_dragging_ = options_.friction > 0.0;
  skins_[part].frame = between(skins_[part], is_[part], 1.0 - give / farthest).frame;
  ways_[part] = motion_between(before, skins_[part].frame);
}

void ClayDeformer::Work::press(BoundedShape& shape, std::span<const ContactPart> parts,
                               ClayReport& report) noexcept {
  status_ = FieldStatus::ok;
  if (zones_) zones_->begin(shape);
  skins_before_ = skins_;
  const double volume_before = volume_now_;
  masked_.begin(shape.shape);
  contacts_.clear();
  search_.distances() = 0;
  pack(parts, target_);
  const double way = way_to_target();
  double gone = 1.0; // of the way
  if (is_way_free(shape)) {
    for (ContactLoad& load : loads_)
      load.clear();
    search_.set_parts(target_);
    skins_ = target_;
  } else {
    double min_radius = max_step_mm * mm_ * 2.0;
    for (const ContactPart& part : target_)
      for (std::size_t corner = 0; corner < part.corner_count; ++corner)
        min_radius = std::min(min_radius, part.radii[corner]);
    const int steps =
        static_cast<int>(std::clamp(std::ceil(way / (0.5 * min_radius)), 1.0, max_sub_steps));
    is_ = from_;
    std::fill(pressed_.begin(), pressed_.end(), 0.0F);
    int used = 0;
    double left = 0.0;
    for (int step = 1; step <= steps && (step == 1 || used < options_.max_passes); ++step) {
      gone = static_cast<double>(step) / steps;
      place_at(gone);
      const int before = report.passes;
      left = sub_step(shape, step == steps, report);
      used += std::max(1, report.passes - before);
      ++report.sub_steps;
    }
    if (gone < 1.0) left = press_out(shape, skin_mm * mm_, report);
    report.penetration_mm = left / mm_;
    list_contacts();
    if (left > 0.0) push_straight(shape);
    report.is_moved = report.passes > 0 || report.carried_mm > 0.0 || left > 0.0;
    if (options_.grips) look_for_grips(report);
  }
  report.remaining_path_mm = (1.0 - gone) * way / mm_;
  masked_.end(shape);
  if (finish(shape, report)) {
    from_ = gone < 1.0 ? is_ : target_;
  } else {
    put_off(way, volume_before, report);
  }
  report.distances = search_.distances();
  report.status = status_;
}

/// Returns how deep the surface still is. Before the last one, a pass whose whole field was applied
/// is not looked at: what it leaves is met in the next one, and is less than a body's next step.
double ClayDeformer::Work::sub_step(BoundedShape& shape, bool is_last,
                                    ClayReport& report) noexcept {
  const double enough = (is_last ? skin_mm : between_mm) * mm_;
  rigid_.setIdentity();
  Found found = find(shape, true);
  const bool is_touched = found.deepest > 0.0 || found.is_loaded;
  if (!options_.lies_on_table && (is_touched || holds_any())) {
    carry(shape, report);
    found.deepest = find(shape, false).deepest;
  }
  if (holds_any()) {
    pull(shape, report);
    found.deepest = find(shape, false).deepest;
  }
  const bool slides = found.is_loaded && is_dragging_;
  if (found.deepest <= enough && !slides) return found.deepest;
  const Applied applied = push(shape, slides, report);
  if (applied == Applied::nothing) return found.deepest;
  return is_last || applied == Applied::part ? press_out(shape, enough, report) : enough;
}

/// Pushes until nothing is deeper than `enough`. Returns how deep the surface still is.
double ClayDeformer::Work::press_out(BoundedShape& shape, double enough,
                                     ClayReport& report) noexcept {
  for (int pass = 1;; ++pass) {
    const double deepest = find(shape, false).deepest;
    if (deepest <= enough || pass == max_sub_step_passes ||
        push(shape, false, report) == Applied::nothing)
      return deepest;
  }
}

/// What a mask holds by more than half is far away from all bodies.
const NearestLanes& ClayDeformer::Work::free_lanes(std::size_t block,
                                                   const NearestLanes& all) noexcept {
  const float* const weights =
      masked_.mask() == nullptr ? nullptr : masked_.mask()->of_block(block);
  if (weights == nullptr) return all;
  free_lanes_ = all;
  for (std::size_t lane = 0; lane < block_size; ++lane)
    if (weights[lane] < min_free) free_lanes_.distance[lane] = std::numeric_limits<float>::max();
  return free_lanes_;
}

std::span<const ContactPoint> ClayDeformer::Work::choose() noexcept {
  return chosen_.choose(apart_in_cells * radius_ / cells_per_radius);
}

ClayDeformer::Work::Found ClayDeformer::Work::find(const BoundedShape& shape, bool loads) noexcept {
  Found found;
  chosen_.clear(radius_ / cells_per_radius);
  for (std::size_t body = 0; body < search_.bodies(); ++body) {
    deep_[body].clear();
    search_.each_near(shape, body, margin_mm * mm_,
                      [&](std::size_t block, const NearestLanes& all) {
                        const NearestLanes& nearest = free_lanes(block, all);
                        if (loads) loads_[body].press(block, nearest);
                        offer(shape, body, block, nearest, found.deepest);
                      });
    if (loads) loads_[body].end_round();
    found.is_loaded = found.is_loaded || loads_[body].is_any();
  }
  return found;
}

void ClayDeformer::Work::offer(const BoundedShape& shape, std::size_t body, std::size_t block,
                               const NearestLanes& nearest, double& deepest) noexcept {
  std::array<std::uint8_t, block_size> lanes;
  const std::size_t count = nearest_of_cells(
      shape.shape[block], nearest, static_cast<float>(margin_mm * mm_), chosen_.cells(), lanes);
  if (count > 0 && nearest.distance[lanes[0]] < 0.0F)
    deep_[body].push_back(static_cast<std::uint32_t>(block));
  for (std::size_t at = 0; at < count; ++at) {
    const std::size_t lane = lanes[at];
    const auto part = static_cast<std::uint32_t>(nearest.part[lane]);
    const double depth = -static_cast<double>(nearest.distance[lane]);
    deepest = std::max(deepest, depth);
    pressed_[part] = std::max(pressed_[part], static_cast<float>(depth));
    const std::size_t place = block * block_size + lane;
    chosen_.offer({static_cast<std::uint32_t>(place),
                   static_cast<std::uint32_t>(body),
                   part,
                   -nearest.distance[lane],
                   vertex_at(shape.shape, place),
                   {nearest.x[lane], nearest.y[lane], nearest.z[lane]}});
  }
}

/// One field; nothing of it if nothing has to move any more, or nothing can.
ClayDeformer::Work::Applied ClayDeformer::Work::push(BoundedShape& shape, bool slides,
                                                     ClayReport& report) noexcept {
  const auto points = choose();
  problem_.assign(points, radius_);
  problem_.solve_pressure(0.5 * skin_mm * mm_);
  if (slides) slide(points);
  const Applied applied = apply(shape, points);
  if (applied == Applied::nothing) return applied;
  ++report.passes;
  report.max_constraints = std::max(report.max_constraints, static_cast<int>(points.size()));
  report.touching = 0;
  for (std::size_t at = 0; at < points.size(); ++at) {
    if (problem_.pressure(at) <= 0.0) continue;
    ++report.touching;
    around_.extend(BoxGate::of({{points[at].at, points[at].at}, {0.0, 0.0}, 2}));
  }
  return applied;
}

/// What the skin of a place's part has done in this sub-step, less what the model did as a whole,
/// is the way that friction would take it. Where there is no load, the limit is 0.
void ClayDeformer::Work::slide(std::span<const ContactPoint> points) noexcept {
  for (std::size_t at = 0; at < points.size(); ++at) {
    const ContactPoint& point = points[at];
    ContactLoad& load = loads_[point.body];
    const double held = load.at(point.place, -point.depth);
    const bool is_loaded = problem_.pressure(at) + held > loaded_mm * mm_;
    const Vector3d before = before_motion(ways_[point.part], point.at);
    const Vector3d was = before_motion(rigid_, point.at);
    frictions_[at] = {is_loaded ? Vector3d(was - before) : Vector3d::Zero(),
                      is_loaded ? held : -problem_.pressure(at), &load.slips(point.place)};
  }
  problem_.solve_friction({frictions_.data(), points.size()}, options_.friction);
}

/// The whole field, or the part of it that does not fold; the next pass does the rest.
ClayDeformer::Work::Applied
ClayDeformer::Work::apply(BoundedShape& shape, std::span<const ContactPoint> points) noexcept {
  const double bound = problem_.lipschitz_bound(max_bound);
  if (!(bound > 0.0)) return Applied::nothing;
  const bool is_whole = bound <= max_bound;
  const double part = (is_whole ? 1.0 : max_bound / bound) * layout_.unit();
  const auto count = static_cast<Eigen::Index>(points.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    field_.centres.col(i) = layout_.origin() + layout_.unit() * points[at].at;
    field_.coefficients.col(i) = part * problem_.coefficient(at);
  }
  field_.radii.head(count).setConstant(layout_.rounded_radius(radius_ * layout_.unit()));
  if (!displace(shape, count)) return Applied::nothing;
  return is_whole ? Applied::whole : Applied::part;
}

/// By the first columns of the field.
bool ClayDeformer::Work::displace(BoundedShape& shape, Eigen::Index count) noexcept {
  for (Eigen::Index i = count; i < used_; ++i)
    field_.coefficients.col(i).setZero();
  used_ = count;
  if (evaluator_.set_field(field_) && evaluator_.displace(shape)) return true;
  status_ = FieldStatus::not_finite;
  return false;
}

/// Of the places that the last search has found near the bodies, those with a load.
void ClayDeformer::Work::list_contacts() noexcept {
  for (const ContactPoint& point : choose()) {
    if (point.body >= moving_bodies()) continue;
    const double load = loads_[point.body].at(point.place, -point.depth) / mm_;
    if (!(load > loaded_mm)) continue;
    contacts_.push_back({layout_.origin() + layout_.unit() * point.at, static_cast<float>(load),
                         static_cast<float>(static_cast<double>(pressed_[point.part]) / mm_),
                         point.body,
                         point.part - point.body * static_cast<std::uint32_t>(parts_per_body_)});
  }
}

/// What the last search has found to be left goes straight out. This may fold, but it is less than
/// a tenth of an edge.
void ClayDeformer::Work::push_straight(BoundedShape& shape) noexcept {
  const double most = max_straight_mm * mm_;
  const std::uint64_t stamp = BlockShape::new_stamp();
  for (std::size_t body = 0; body < search_.bodies(); ++body)
    search_.each_of(shape, body, deep_[body], 0.0, [&](std::size_t block, const NearestLanes& all) {
      const NearestLanes& nearest = free_lanes(block, all);
      VertexBlock& content = shape.shape.data()[block];
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        const double depth = -static_cast<double>(nearest.distance[lane]);
        if (!(depth > 0.0)) continue;
        const Vector3d at = vertex_in(content, lane).cast<double>();
        const Vector3d normal =
            normal_from({nearest.x[lane], nearest.y[lane], nearest.z[lane]}, at);
        const Vector3d out = at + std::min(depth, most) * normal;
        set_vertex(content, lane, out.cast<float>());
      }
      shape.shape.set_stamp(block, stamp);
      shape.bounds[block] = bounds_of(content);
    });
  shape.extent += 2.0 * most;
}

} // namespace nendo::deform
