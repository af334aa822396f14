#include <nendo/flow/clay_hands.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::flow {

void contact_parts(hand::HandBody& body, const hand::HandPose& pose, double units_per_metre,
                   std::span<deform::ContactPart> parts) noexcept {
  assert(parts.size() == hand::HandBody::part_count);
  body.follow(pose);
  for (std::size_t at = 0; at < parts.size(); ++at) {
    const hand::BodyPart& from = body.parts()[at];
    deform::ContactPart& part = parts[at];
    part.corner_count = from.corner_count;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      part.corners[corner] = units_per_metre * from.corners_m[corner];
      part.radii[corner] = units_per_metre * from.radii_m[corner];
    }
    part.frame = pose[from.carrier];
    part.frame.translation() *= units_per_metre;
  }
}

Eigen::Isometry3d beside(const deform::Mesh& model, double units_per_metre,
                         const hand::HandSkeleton& skeleton, const hand::JointAngles& angles,
                         const Eigen::Isometry3d& T_stage_wrist, double clear_m) {
  constexpr Eigen::Index max_looked_at = 4000;
  constexpr int max_moves = 60;
  const Eigen::Index vertices = model.vertices.cols();
  if (vertices == 0) return T_stage_wrist;
  const Eigen::Vector3d low = model.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = model.vertices.rowwise().maxCoeff();
  const Eigen::Vector3d middle = 0.5 / units_per_metre * (low + high);
  Eigen::Isometry3d wrist = T_stage_wrist;
  const Eigen::Vector3d palm =
      skeleton.pose(angles, wrist)[hand::Joint::middle_proximal].translation();
  Eigen::Vector3d away = palm - middle;
  if (!(away.norm() > 0.0)) away = Eigen::Vector3d::UnitX();
  away.normalize();
  hand::HandBody body(skeleton);
  for (int move = 0; move < max_moves; ++move) {
    body.follow(skeleton.pose(angles, wrist));
    double min_m = clear_m;
    for (Eigen::Index at = 0; at < vertices;
         at += std::max<Eigen::Index>(1, vertices / max_looked_at))
      min_m = std::min(min_m, body.nearest(model.vertices.col(at) / units_per_metre).distance_m);
    if (min_m >= clear_m) break;
    wrist.translation() += (clear_m - min_m + 1e-4) * away;
  }
  return wrist;
}

/// Two large triangles, of which the other parts are corners.
static void place_table(const Table& table, double units_per_metre,
                        std::span<deform::ContactPart> parts) {
  constexpr double half_thickness_m = 0.010;
  const double thick = half_thickness_m * units_per_metre;
  const auto corner = [&](double x, double z) {
    return Eigen::Vector3d(table.top.x() + x * table.half_side, table.top.y() - thick,
                           table.top.z() + z * table.half_side);
  };
  constexpr std::array sides{1.0, -1.0};
  for (std::size_t at = 0; at < parts.size(); ++at) {
    deform::ContactPart& part = parts[at];
    part.corner_count = at < sides.size() ? 3 : 2;
    const double side = sides[at % sides.size()];
    part.corners = {corner(-1.0, -1.0), corner(1.0, 1.0), corner(side, -side)};
    if (part.corner_count == 2) part.corners[1] = part.corners[0];
    part.radii = {thick, thick, thick};
    part.frame.setIdentity();
  }
}

HandBodies::HandBodies(std::span<const hand::HandSkeleton> hands, double units_per_metre,
                       const Table& table)
    : parts_((hands.size() + tables) * hand::HandBody::part_count), table_(table),
      units_per_metre_(units_per_metre) {
  place_table(table, units_per_metre, std::span(parts_).last(hand::HandBody::part_count));
  for (const hand::HandSkeleton& skeleton : hands) {
    bodies_.emplace_back(skeleton);
    follow(bodies_.size() - 1, skeleton.pose({}, Eigen::Isometry3d::Identity()));
  }
}

void HandBodies::follow(std::size_t hand, const hand::HandPose& pose) noexcept {
  constexpr std::size_t parts = hand::HandBody::part_count;
  contact_parts(bodies_[hand], pose, units_per_metre_,
                std::span(parts_).subspan(hand * parts, parts));
}

std::shared_ptr<HandBodies>
make_bodies(const std::array<std::optional<hand::HandSkeleton>, 2>& by_side,
            const deform::Mesh& model, double units_per_metre, const std::optional<Table>& table) {
  std::vector<hand::HandSkeleton> hands;
  for (const auto& hand : by_side)
    if (hand) hands.push_back(*hand);
  return std::make_shared<HandBodies>(hands, units_per_metre,
                                      table ? *table : table_under(model, units_per_metre));
}

namespace {

constexpr double mm_per_metre = 1000.0;

deform::ClayOptions clay_options(const HandBodies& bodies, double radius_m,
                                 const deform::DeformerOptions& deformer) {
  deform::ClayOptions options;
  options.units_per_mm = bodies.units_per_metre() / mm_per_metre;
  options.radius_mm = mm_per_metre * std::max(radius_m, ClayHands::min_radius_m);
  options.still_bodies = HandBodies::tables;
  options.evaluation = deformer.evaluation;
  options.mask = deformer.mask;
  return options;
}

/// Returns the image in the plane x = at. The frame's motion is the image's, and no reflection.
deform::ContactPart image_of(const deform::ContactPart& part, double at) noexcept {
  deform::ContactPart image = part;
  for (Eigen::Vector3d& corner : image.corners)
    corner.x() = 2.0 * at - corner.x();
  const Eigen::Vector3d mirrored(-1.0, 1.0, 1.0);
  image.frame.linear() = mirrored.asDiagonal() * part.frame.linear() * mirrored.asDiagonal();
  image.frame.translation().x() = 2.0 * at - part.frame.translation().x();
  return image;
}

std::size_t bodies_of(const HandBodies& bodies, bool are_mirrored) noexcept {
  return (are_mirrored ? 2 : 1) * bodies.count() + HandBodies::tables;
}

} // namespace

float strength_of(const deform::ClayContact& contact) noexcept {
  constexpr float max_load_mm = 0.5F;
  constexpr float max_pressed_mm = 1.0F;
  return 0.5F * std::clamp(contact.load_mm / max_load_mm, 0.0F, 1.0F) +
         0.5F * std::clamp(contact.pressed_mm / max_pressed_mm, 0.0F, 1.0F);
}

HandTouch touch_of(std::span<const deform::ClayContact> contacts, std::size_t body) noexcept {
  constexpr std::size_t bones = 3; // of a finger: HandBody::parts()
  HandTouch touch{};
  for (const deform::ClayContact& contact : contacts) {
    if (contact.body != body) continue;
    float& strongest = touch[std::min<std::size_t>(contact.part / bones, hand::finger_count)];
    strongest = std::max(strongest, strength_of(contact));
  }
  return touch;
}

ClayModel::ClayModel(const deform::Mesh& mesh)
    : ClayModel(mesh, std::abs(deform::volume_of(mesh))) {}

ClayModel::ClayModel(const deform::Mesh& mesh, double first_volume)
    : corners(deform::corners_of_triangles(mesh)), volume(first_volume) {}

ClayHands::ClayHands(deform::SculptedShape& shape, std::shared_ptr<const ClayModel> model,
                     std::shared_ptr<const HandBodies> bodies, double radius_m,
                     const deform::DeformerOptions& options, std::optional<double> mirror)
    : model_(std::move(model)), bodies_(std::move(bodies)), mirror_(mirror),
      with_images_(mirror ? bodies_of(*bodies_, true) * hand::HandBody::part_count : 0),
      clay_(shape, model_->corners, bodies_of(*bodies_, mirror.has_value()),
            hand::HandBody::part_count, clay_options(*bodies_, radius_m, options)) {}

std::span<const deform::ContactPart> ClayHands::parts() noexcept {
  const auto own = bodies_->parts();
  if (!mirror_) return own;
  const auto hands = own.first(bodies_->count() * hand::HandBody::part_count);
  auto to = std::copy(hands.begin(), hands.end(), with_images_.begin());
  to = std::transform(hands.begin(), hands.end(), to,
                      [&](const auto& part) { return image_of(part, *mirror_); });
  const auto table = own.subspan(hands.size());
  std::copy(table.begin(), table.end(), to);
  return with_images_;
}

deform::FieldStatus ClayHands::follow(const deform::Points&, bool ends) {
  is_moved_ = false;
  presses_ = true;
  constexpr int max_calls = 64; // so that a tick ends, however far a hand has jumped
  for (int call = 0; call < max_calls; ++call) {
    const deform::ClayReport& report = clay_.press_to(parts());
    is_moved_ = is_moved_ || report.is_moved;
    if (!ends || !is_solved(report.status) || report.remaining_path_mm <= 0.0) break;
  }
  return clay_.report().status;
}

void ClayHands::release(bool is_step) noexcept {
  clay_.release(is_step);
  is_moved_ = presses_ = false;
}

ClayState ClayHands::state() const noexcept {
  const deform::ClayReport& report = clay_.report();
  return {.is_clay = true,
          .touching = static_cast<std::uint32_t>(clay_.contacts().size()),
          .penetration_mm = presses_ ? report.penetration_mm : 0.0,
          .volume = std::abs(clay_.volume()),
          .first_volume = clay_.volume() != 0.0 ? model_->volume : 0.0};
}

namespace {

constexpr Eigen::Index tips_of_hand = 5;

deform::PartMoverOptions mover_options(const HandBodies& bodies,
                                       std::shared_ptr<const deform::VertexMask> mask) {
  return {.hands = bodies.count(),
          .reach = PartHands::reach_m * bodies.units_per_metre(),
          .mask = std::move(mask)};
}

template <class Visit>
void each_place(const deform::ModelParts& parts, std::uint32_t part, const Visit& visit) {
  for (const deform::ModelParts::Block& block : parts.blocks_of(part))
    block.each_lane([&](std::size_t lane) { visit(block.number * deform::block_size + lane); });
}

Eigen::Vector3d vertex_of(const deform::BlockLayout& layout, const deform::BlockShape& shape,
                          std::size_t place) noexcept {
  return layout.origin() + layout.unit() * vertex_at(shape, place).cast<double>();
}

} // namespace

PartHands::PartHands(deform::SculptedShape& shape, std::shared_ptr<const deform::ModelParts> parts,
                     std::shared_ptr<const HandBodies> bodies,
                     std::shared_ptr<const deform::VertexMask> mask)
    : parts_(std::move(parts)), bodies_(std::move(bodies)), hands_(bodies_->count()),
      grips_(bodies_->count()), mover_(shape, parts_, mover_options(*bodies_, std::move(mask))) {
  for (Hand& hand : hands_)
    hand.places.reserve(max_places);
  contacts_.reserve(max_places * hands_.size());
}

std::span<const deform::PartGrip> PartHands::grips(const deform::Points& tips) noexcept {
  const double units = bodies_->units_per_metre();
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    const Eigen::Index first = tips_of_hand * static_cast<Eigen::Index>(at);
    const Eigen::Vector3d thumb = tips.col(first), index = tips.col(first + 1),
                          middle = tips.col(first + 2);
    const double gap = std::min((index - thumb).norm(), (middle - thumb).norm());
    Hand& hand = hands_[at];
    hand.is_closed = gap < (hand.is_closed ? open_m : closed_m) * units;
    // The palm's parts are a body's last.
    const std::size_t palm = (at + 1) * hand::HandBody::part_count - 1;
    grips_[at].frame = bodies_->parts()[palm].frame;
    grips_[at].frame.translation() = 0.5 * thumb + 0.25 * (index + middle);
    grips_[at].is_closed = hand.is_closed;
  }
  return grips_;
}

deform::FieldStatus PartHands::follow(const deform::Points& tips, bool /*ends*/) noexcept {
  const deform::FieldStatus status = mover_.move_to(grips(tips));
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    const std::uint32_t held = mover_.held_by(at);
    if (std::exchange(hands_[at].held, held) == held) continue;
    find_places(at);
    if (held != deform::no_index) chosen_ = held;
  }
  update_contacts();
  return status;
}

void PartHands::release(bool is_step) noexcept {
  mover_.release(is_step);
  for (Hand& hand : hands_) {
    hand.is_closed = false; // nothing that was before matters then
    hand.held = deform::no_index;
    hand.places.clear();
  }
  contacts_.clear();
}

/// Evenly chosen ones within reach of the fingers, and at least the nearest one.
void PartHands::find_places(std::size_t at) noexcept {
  Hand& hand = hands_[at];
  hand.places.clear();
  if (hand.held == deform::no_index) return;
  const Eigen::Vector3d middle = grips_[at].frame.translation();
  const auto distance = [&](std::size_t place) {
    return (vertex_of(mover_.layout(), mover_.shape(), place) - middle).norm();
  };
  double least = std::numeric_limits<double>::infinity();
  each_place(*parts_, hand.held,
             [&](std::size_t place) { least = std::min(least, distance(place)); });
  const double reach = std::max(reach_m * bodies_->units_per_metre(), least);
  std::size_t near = 0;
  each_place(*parts_, hand.held,
             [&](std::size_t place) { near += distance(place) <= reach ? 1U : 0U; });
  const std::size_t stride = near / max_places + 1;
  std::size_t met = 0;
  each_place(*parts_, hand.held, [&](std::size_t place) {
    if (distance(place) <= reach && met++ % stride == 0) hand.places.push_back(place);
  });
}

/// Each finger that holds has a contact, however few places there are.
void PartHands::update_contacts() noexcept {
  constexpr float held_load_mm = 0.2F;
  constexpr std::array<std::uint32_t, 2> holding_parts{2, 5}; // the ends of thumb and index finger
  contacts_.clear();
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    const auto& places = hands_[at].places;
    const std::size_t count = places.empty() ? 0 : std::max(places.size(), holding_parts.size());
    for (std::size_t number = 0; number < count; ++number) {
      deform::ClayContact contact;
      contact.place = vertex_of(mover_.layout(), mover_.shape(), places[number % places.size()]);
      contact.load_mm = held_load_mm;
      contact.body = static_cast<std::uint32_t>(at);
      contact.part = holding_parts[number % holding_parts.size()];
      contacts_.push_back(contact);
    }
  }
}

PartsState PartHands::state() const noexcept {
  PartsState state;
  state.count = parts_->count();
  for (std::size_t at = 0; at < std::min(hands_.size(), state.held.size()); ++at) {
    state.held[at] = mover_.held_by(at);
    state.in_reach[at] = mover_.in_reach_of(at);
  }
  state.chosen = chosen_;
  return state;
}

} // namespace nendo::flow
