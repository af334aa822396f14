#include <nendo/puppet/puppet_edit.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <nendo/base/units.hpp>

#include "edited_puppet.hpp"

namespace nendo::puppet {

using Eigen::Vector3d;

Puppet empty_puppet(std::string_view model_name) {
  Puppet puppet;
  puppet.model = model_name;
  return puppet;
}

Result<Puppet> with_function(const Rig& rig, const NewPoint& point, const Vector3d& move,
                             const HandSignal& input, double travel) {
  EditedPuppet draft(rig);
  Puppet& puppet = draft.puppet();
  const bool is_sided = draft.is_sided(point);
  if (puppet.functions.size() + (is_sided ? 2 : 1) > Puppet::max_functions)
    return refused("there are " + std::to_string(puppet.functions.size()) +
                   " functions already, of at most " + std::to_string(Puppet::max_functions) +
                   "; remove some");
  if (!move.allFinite() || !std::isfinite(travel) || travel == 0.0)
    return refused("a function needs a way and a travel that is not 0");
  const auto added = draft.add_point(point, false);
  if (!added) return added.error();
  const bool is_flipped = is_sided && point.at.x() < 0.0;
  Function made;
  made.name = EditedPuppet::free_name(puppet.functions, "move", is_sided);
  made.input = is_flipped ? input.mirrored() : input;
  made.travel = travel;
  made.eases = true;
  const Vector3d way = rounded(move, point.radius);
  made.moves.push_back({*added, is_flipped ? flipped(way) : way, {}});
  puppet.functions.push_back(std::move(made));
  return draft.done();
}

Result<Puppet> with_pin(const Rig& rig, const NewPoint& point) {
  if (rig.puppet().functions.empty())
    return refused("a puppet begins with a point that a finger moves; pins come after it");
  EditedPuppet draft(rig);
  if (const auto added = draft.add_point(point, true); !added) return added.error();
  return draft.done();
}

Result<Puppet> without_point(const Rig& rig, std::size_t point) {
  EditedPuppet draft(rig);
  Puppet& puppet = draft.puppet();
  const std::size_t source = draft.source_of_point(point);
  const std::string name = puppet.points[source].name;
  std::vector<bool> goes(puppet.points.size(), false);
  goes[source] = true;
  const std::size_t twin = draft.twin_of_point(source);
  if (puppet.points[twin].is_mirrored) goes[twin] = true;
  draft.remove_points(goes);
  if (puppet.functions.empty())
    return refused("'" + name + "' is the last point that a function moves; add another one first");
  for (const PuppetPart& part : puppet.parts)
    if (part.is_affine && !part.points.empty() && part.points.size() < 4)
      return refused("a part of the model turns with '" + name +
                     "' and three other points; give it others in the file first");
  return draft.done();
}

Result<Puppet> with_radius(const Rig& rig, std::size_t point, double radius) {
  constexpr double largest = 1e9;
  if (!(radius > 0.0 && radius <= largest))
    return refused("a radius must be more than 0, and at most 1e9");
  EditedPuppet draft(rig);
  PuppetPoint& edited = draft.puppet().points[draft.source_of_point(point)];
  const double scale = radius / edited.radius;
  for (deform::Support& support : edited.mix)
    support.radius = rounded(scale * support.radius, scale * support.radius);
  edited.radius = rounded(radius, radius);
  return draft.done();
}

Result<Puppet> with_pinned(const Rig& rig, std::size_t point, bool pinned) {
  EditedPuppet draft(rig);
  Puppet& puppet = draft.puppet();
  const std::size_t source = draft.source_of_point(point);
  for (const std::size_t one : {source, draft.twin_of_point(source)})
    if (pinned && draft.is_moved(one))
      return refused("'" + puppet.points[one].name + "' is moved by " +
                     puppet.functions[draft.mover_of(one)].name +
                     ", and a pin stays; remove the point, and place a pin there");
  puppet.points[source].is_pin = pinned;
  return draft.done();
}

namespace {

Result<void> check_movable(const PuppetPoint& point) {
  if (point.is_pin) return refused("'" + point.name + "' is a pin, and stays where it is");
  return {};
}

} // namespace

Result<Puppet> with_move(const Rig& rig, std::size_t function, std::size_t point,
                         const Vector3d& vector) {
  if (!vector.allFinite()) return refused("a way must be finite");
  EditedPuppet draft(rig);
  Puppet& puppet = draft.puppet();
  if (const auto fine = check_movable(puppet.points[point]); !fine) return fine.error();
  const bool is_twin = puppet.functions[function].is_twin;
  Function& edited = puppet.functions[draft.source_of_function(function)];
  const std::size_t moved = is_twin ? draft.twin_of_point(point) : point;
  const Vector3d way = rounded(vector, puppet.points[point].radius);
  const Vector3d by = is_twin ? flipped(way) : way;
  for (Move& move : edited.moves) {
    if (move.point != moved) continue;
    if (move.part)
      return refused(edited.name + " turns '" + puppet.points[moved].name +
                     "' with other points; a drag with shift changes the turn");
    move.vector = by;
    return draft.done();
  }
  edited.moves.push_back({moved, by, {}});
  return draft.done();
}

namespace {

/// The points that turn come first.
void set_turn(Function& function, std::size_t point, const AxisTurn& turn) {
  auto& moves = function.moves;
  const bool turned_before = function.turn.has_value();
  function.turn = turn;
  std::erase_if(moves, [&](const Move& move) { return move.point == point && !move.part; });
  for (Move& move : moves)
    if (!turned_before) move = {move.point, Vector3d::Zero(), 1.0};
  if (std::ranges::find(moves, point, &Move::point) == moves.end())
    moves.insert(moves.begin(), {point, Vector3d::Zero(), 1.0});
}

} // namespace

Result<Puppet> with_turn(const Rig& rig, std::size_t function, std::size_t point,
                         const AxisTurn& turn) {
  constexpr double min_axis = 1e-9;
  if (!(std::abs(turn.degrees) <= 360.0) || !turn.axis.allFinite() || !turn.through.allFinite() ||
      !(turn.axis.norm() > min_axis))
    return refused("a turn needs an axis, and at most 360 degrees");
  EditedPuppet draft(rig);
  Puppet& puppet = draft.puppet();
  if (const auto fine = check_movable(puppet.points[point]); !fine) return fine.error();
  const bool is_twin = puppet.functions[function].is_twin;
  Function& edited = puppet.functions[draft.source_of_function(function)];
  AxisTurn wanted = is_twin ? flipped(turn) : turn;
  wanted.degrees = rounded(wanted.degrees, 100.0);
  wanted.axis = rounded(wanted.axis, 1.0);
  wanted.through = rounded(wanted.through, puppet.points[point].radius);
  set_turn(edited, is_twin ? draft.twin_of_point(point) : point, wanted);
  return draft.done();
}

deform::Points vectors_with_turn(const Rig& rig, std::size_t function, std::size_t point,
                                 const AxisTurn& turn) {
  Puppet puppet;
  puppet.points = rig.puppet().points;
  puppet.functions.push_back(rig.puppet().functions[function]);
  set_turn(puppet.functions[0], point, turn);
  return Rig(std::move(puppet), rig.starts()).vectors_of(0);
}

Result<Puppet> with_input(const Rig& rig, std::size_t function, const HandSignal& input,
                          double travel) {
  if (!std::isfinite(travel) || travel == 0.0) return refused("a travel must not be 0");
  EditedPuppet draft(rig);
  const bool is_twin = draft.puppet().functions[function].is_twin;
  Function& edited = draft.puppet().functions[draft.source_of_function(function)];
  edited.input = is_twin ? input.mirrored() : input;
  edited.travel = travel;
  return draft.done();
}

Result<Puppet> with_name(const Rig& rig, std::size_t function, std::string_view name) {
  EditedPuppet draft(rig);
  Puppet& puppet = draft.puppet();
  const bool is_twin = puppet.functions[function].is_twin;
  Function& edited = puppet.functions[draft.source_of_function(function)];
  const std::string wanted = is_twin ? twin_of(std::string(name)) : std::string(name);
  if (wanted == edited.name) return draft.done();
  for (const std::string& taken : {wanted, twin_of(wanted)}) {
    const auto other = find_named(puppet.functions, taken);
    if (other != puppet.functions.end() && !other->is_twin && &*other != &edited)
      return refused("there is a function '" + taken + "' already; choose another name");
  }
  edited.name = wanted;
  return draft.done();
}

namespace {

Result<void> add_masks(std::span<const Vector3d> stroke, double radius, Puppet& puppet) {
  if (!(radius > 0.0) || !std::isfinite(radius)) return refused("a brush needs a radius above 0");
  std::vector<Mask>& masks = puppet.masks;
  const auto add = [&](const Vector3d& at) {
    constexpr double near = 0.35; // of the radius: what is masked by one is masked by the other
    const bool is_there = std::ranges::any_of(masks, [&](const Mask& mask) {
      return mask.radius >= radius && (mask.at - at).norm() < near * radius;
    });
    if (!is_there && at.allFinite())
      masks.push_back({rounded(at, radius), rounded(radius, radius)});
  };
  for (const Vector3d& at : stroke) {
    add(at);
    if (puppet.mirrors) add(flipped(at, puppet.mirror_at));
  }
  if (masks.size() > max_painted_masks)
    return refused("there are more than " + std::to_string(max_painted_masks) +
                   " masks then; use a larger brush, or erase some");
  return {};
}

void erase_masks(std::span<const Vector3d> stroke, double radius, Puppet& puppet) {
  std::erase_if(puppet.masks, [&](const Mask& mask) {
    return std::ranges::any_of(stroke, [&](const Vector3d& at) {
      return (mask.at - at).norm() <= radius ||
             (puppet.mirrors && (mask.at - flipped(at, puppet.mirror_at)).norm() <= radius);
    });
  });
}

/// Where masks are inverted, those are erased that would be added, and the other way.
Result<Puppet> painted(const Rig& rig, std::span<const Vector3d> stroke, bool protects,
                       double add_radius, double erase_radius) {
  EditedPuppet draft(rig);
  if (protects == draft.puppet().inverted)
    erase_masks(stroke, erase_radius, draft.puppet());
  else if (const auto added = add_masks(stroke, add_radius, draft.puppet()); !added)
    return added.error();
  return draft.done();
}

} // namespace

Result<Puppet> with_masks(const Rig& rig, std::span<const Vector3d> stroke, double radius) {
  return painted(rig, stroke, true, radius, half_of_mask * radius);
}

Result<Puppet> without_masks(const Rig& rig, std::span<const Vector3d> stroke, double radius) {
  return painted(rig, stroke, false, radius / half_of_mask, radius);
}

Result<Puppet> without_any_mask(const Rig& rig) {
  EditedPuppet draft(rig);
  draft.puppet().masks.clear();
  draft.puppet().inverted = false;
  return draft.done();
}

Result<Puppet> with_masks_inverted(const Rig& rig) {
  EditedPuppet draft(rig);
  draft.puppet().inverted = !draft.puppet().inverted;
  return draft.done();
}

Result<Puppet> with_symmetry(const Rig& rig, bool on, double at) {
  EditedPuppet draft(rig);
  if (draft.puppet().is_played())
    return refused("hands play this puppet; its mirror is another edit");
  draft.puppet().mirrors = on;
  draft.puppet().mirror_at = on ? at : 0.0;
  return draft.done();
}

double BendWatch::usual_rad(std::size_t finger) noexcept {
  constexpr double thumb_deg = 40.0, others_deg = 70.0;
  return from_degrees(finger == 0 ? thumb_deg : others_deg);
}

std::optional<Bend> BendWatch::follow(const RigPlayer::Hands& hands) noexcept {
  std::optional<Bend> best;
  double most = 0.0, second = 0.0;
  for (const Side side : {Side::left, Side::right}) {
    const HandState* const hand = hands[static_cast<std::size_t>(side)];
    if (hand == nullptr) continue;
    auto& rest = rest_[static_cast<std::size_t>(side)];
    const bool is_first = !rest.has_value();
    if (is_first) rest.emplace();
    for (std::size_t finger = 0; finger < hand::finger_count; ++finger) {
      const auto signal = HandSignal::numbered(side, static_cast<std::uint8_t>(finger));
      if (!signal) continue;
      const double bent_rad = signal->of(*hand);
      if (is_first) (*rest)[finger] = bent_rad;
      const double part = (bent_rad - (*rest)[finger]) / usual_rad(finger);
      if (!(std::abs(part) > second)) continue;
      if (std::abs(part) <= most) {
        second = std::abs(part);
        continue;
      }
      second = most;
      most = std::abs(part);
      best = Bend{*signal, std::copysign(usual_rad(finger), part)};
    }
  }
  if (most < min_bend_fraction || most < dominance_ratio * second) return std::nullopt;
  return best;
}

} // namespace nendo::puppet
