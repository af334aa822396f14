#include <nendo/flow/part_hands.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace nendo::flow {
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
  for (std::size_t at = 0; at < std::min(hands_.size(), state.held.size()); ++at)
    state.held[at] = mover_.held_by(at);
  state.chosen = chosen_;
  return state;
}

} // namespace nendo::flow
