#include <nendo/puppet/puppet_edit.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

namespace nendo::puppet {

using Eigen::Index;
using Eigen::Vector3d;

namespace {

constexpr double middle = 0.05; // of the radius: nearer to x = 0, a point has no side

Vector3d flipped(const Vector3d& place, double at = 0.0) {
  return {2.0 * at - place.x(), place.y(), place.z()};
}

/// A file is read by people: what the mouse gives has some three digits that mean anything, counted
/// from the radius, and `more` of them where another place must not be seen.
double rounded(double value, double radius, int more = 0) {
  const int digits = std::clamp(3 - static_cast<int>(std::floor(std::log10(radius))) + more, 0, 30);
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, digits)
          .ptr;
  double read = value;
  std::from_chars(text.data(), end, read);
  return read;
}

Vector3d rounded(const Vector3d& vector, double radius, int more = 0) {
  return {rounded(vector.x(), radius, more), rounded(vector.y(), radius, more),
          rounded(vector.z(), radius, more)};
}

bool has_side(const std::string& name) {
  return twin_of(name) != name;
}

Error refused(std::string message) {
  return {Errc::bad_input, std::move(message)};
}

template <class List>
auto find_named(List& list, std::string_view name) {
  return std::find_if(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
}

/// A puppet in the making, with its twins. The text brings them in line again.
class EditedPuppet {
public:
  explicit EditedPuppet(const Rig& rig) : puppet_(rig.puppet()), starts_(rig.starts()) {}

  Puppet& puppet() noexcept { return puppet_; }
  Vector3d start(std::size_t point) const { return starts_.col(static_cast<Index>(point)); }

  Result<Puppet> done() {
    const std::string text = text_of(puppet_);
    return parse_puppet(text, "the puppet");
  }

  /// The one whose mirror image it is, or itself.
  std::size_t source_of_point(std::size_t point) const {
    if (!puppet_.points[point].is_mirrored) return point;
    return twin_of_point(point);
  }
  std::size_t twin_of_point(std::size_t point) const {
    const auto twin = find_named(puppet_.points, twin_of(puppet_.points[point].name));
    return twin == puppet_.points.end() ? point
                                        : static_cast<std::size_t>(twin - puppet_.points.begin());
  }
  std::size_t source_of_function(std::size_t function) const {
    if (!puppet_.functions[function].is_twin) return function;
    const auto source = find_named(puppet_.functions, twin_of(puppet_.functions[function].name));
    return static_cast<std::size_t>(source - puppet_.functions.begin());
  }
  template <class List>
  static std::string free_name(const List& list, const std::string& stem, bool is_left) {
    for (std::size_t number = 1;; ++number) {
      const std::string name = stem + std::to_string(number);
      const auto is_free = [&](const std::string& wanted) {
        return find_named(list, wanted) == list.end();
      };
      if (is_free(name) && is_free(name + "Left") && is_free(name + "Right"))
        return name + (is_left ? "Left" : "");
    }
  }
  bool is_moved(std::size_t point) const { return mover_of(point) != puppet_.functions.size(); }
  std::size_t mover_of(std::size_t point) const {
    const auto mover =
        std::find_if(puppet_.functions.begin(), puppet_.functions.end(), [&](const auto& function) {
          return std::any_of(function.moves.begin(), function.moves.end(),
                             [&](const Move& move) { return move.point == point; });
        });
    return static_cast<std::size_t>(mover - puppet_.functions.begin());
  }

  /// Returns its number. What is clicked on the right side of a mirrored puppet is made on the
  /// left, whose twin is there.
  Result<std::size_t> add_point(const NewPoint& point, bool is_pin) {
    if (!(point.radius > 0.0) || !std::isfinite(point.radius) || !point.at.allFinite())
      return refused("a point needs a place and a radius above 0");
    const std::size_t added = is_sided(point) ? 2 : 1;
    if (puppet_.points.size() + added > Puppet::most_points)
      return refused("there are " + std::to_string(puppet_.points.size()) +
                     " points already, of at most " + std::to_string(Puppet::most_points) +
                     "; remove some");
    for (std::size_t at = 0; at < puppet_.points.size(); ++at) {
      const double least = least_gap_of_points * std::min(point.radius, puppet_.points[at].radius);
      if ((start(at) - point.at).norm() < least)
        return refused("the place is too near to the point '" + puppet_.points[at].name +
                       "'; choose one farther away, or a smaller radius");
    }
    PuppetPoint& made = puppet_.points.emplace_back();
    made.at = rounded(point.at, point.radius);
    if (is_sided(point)) made.at.x() = std::abs(made.at.x());
    if (puppet_.mirrors && !is_sided(point)) made.at.x() = 0.0;
    made.radius = rounded(point.radius, point.radius);
    made.is_pin = is_pin;
    const auto before = std::span(puppet_.points).first(puppet_.points.size() - 1);
    made.name = free_name(before, is_pin ? "pin" : "point", is_sided(point));
    return puppet_.points.size() - 1;
  }
  bool is_sided(const NewPoint& point) const {
    return puppet_.mirrors && std::abs(point.at.x()) > middle * point.radius;
  }

  /// Without the points of which `goes` is true.
  void remove_points(const std::vector<bool>& goes) {
    std::vector<std::size_t> numbers(goes.size());
    std::vector<PuppetPoint> rest;
    for (std::size_t at = 0; at < goes.size(); ++at) {
      numbers[at] = rest.size();
      if (!goes[at]) rest.push_back(std::move(puppet_.points[at]));
    }
    puppet_.points = std::move(rest);
    for (Function& function : puppet_.functions) {
      std::erase_if(function.moves, [&](const Move& move) { return goes[move.point]; });
      for (Move& move : function.moves)
        move.point = numbers[move.point];
    }
    for (PuppetPart& part : puppet_.parts) {
      std::erase_if(part.points, [&](std::size_t point) { return goes[point]; });
      for (std::size_t& point : part.points)
        point = numbers[point];
    }
    std::erase_if(puppet_.functions,
                  [](const Function& function) { return function.moves.empty(); });
  }

private:
  Puppet puppet_;
  const deform::Points& starts_;
};

} // namespace

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
  if (puppet.functions.size() + (is_sided ? 2 : 1) > Puppet::most_functions)
    return refused("there are " + std::to_string(puppet.functions.size()) +
                   " functions already, of at most " + std::to_string(Puppet::most_functions) +
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

/// The points that turn stand first.
void set_turn(Function& function, std::size_t point, const AxisTurn& turn) {
  auto& moves = function.moves;
  const bool turned_before = function.turn.has_value();
  function.turn = turn;
  std::erase_if(moves, [&](const Move& move) { return move.point == point && !move.part; });
  for (Move& move : moves)
    if (!turned_before) move = {move.point, Vector3d::Zero(), 1.0};
  if (std::none_of(moves.begin(), moves.end(),
                   [&](const Move& move) { return move.point == point; }))
    moves.insert(moves.begin(), {point, Vector3d::Zero(), 1.0});
}

AxisTurn flipped(const AxisTurn& turn) { // of a mirrored turn
  return {turn.degrees, -flipped(turn.axis), flipped(turn.through)};
}

} // namespace

Result<Puppet> with_turn(const Rig& rig, std::size_t function, std::size_t point,
                         const AxisTurn& turn) {
  constexpr double least_axis = 1e-9;
  if (!(std::abs(turn.degrees) <= 360.0) || !turn.axis.allFinite() || !turn.through.allFinite() ||
      !(turn.axis.norm() > least_axis))
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

/// The twins become points and functions of their own.
void end_mirror(EditedPuppet& draft) {
  Puppet& puppet = draft.puppet();
  for (std::size_t at = 0; at < puppet.points.size(); ++at) {
    PuppetPoint& point = puppet.points[at];
    if (!std::exchange(point.is_mirrored, false)) continue;
    point.vertex.reset();
    point.at = rounded(draft.start(at), point.radius, 4);
  }
  for (Function& function : puppet.functions)
    function.is_twin = false;
}

/// Puts points and functions that are on one side, and whose names do not say so, to the left.
class MirrorBeginning {
public:
  explicit MirrorBeginning(EditedPuppet& draft)
      : draft_(draft), puppet_(draft.puppet()), sides_(puppet_.points.size()) {}

  void begin() {
    find_sides();
    for (Function& function : puppet_.functions) {
      const int side = side_of(function);
      if (side == 0 || has_side(function.name)) continue;
      function.name = left_name(puppet_.functions, function.name);
      if (side < 0) flip(function);
    }
    for (std::size_t at = 0; at < sides_.size(); ++at) {
      PuppetPoint& point = puppet_.points[at];
      if (sides_[at] == 0) {
        settle_in_middle(point, at);
        continue;
      }
      point.name = left_name(puppet_.points, point.name);
      if (sides_[at] > 0) continue;
      point.vertex.reset();
      point.at = rounded(flipped(draft_.start(at)), point.radius, 4);
    }
  }

private:
  /// What a person has clicked in the middle is its own mirror image.
  void settle_in_middle(PuppetPoint& point, std::size_t at) const {
    const bool is_near = std::abs(draft_.start(at).x()) <= middle * point.radius;
    if (is_near && !point.vertex && !has_side(point.name)) point.at.x() = 0.0;
  }
  /// Those that functions of both sides move stay as they are.
  void find_sides() {
    for (std::size_t at = 0; at < sides_.size(); ++at) {
      const PuppetPoint& point = puppet_.points[at];
      const double x = draft_.start(at).x();
      if (!has_side(point.name) && std::abs(x) > middle * point.radius) sides_[at] = x < 0 ? -1 : 1;
    }
    for (bool is_settled = false; !is_settled;) {
      is_settled = true;
      for (const Function& function : puppet_.functions) {
        if (side_of(function) != 0) continue;
        for (const Move& move : function.moves)
          is_settled = std::exchange(sides_[move.point], 0) == 0 && is_settled;
      }
    }
  }
  int side_of(const Function& function) const {
    const int side = sides_[function.moves.front().point];
    const bool all = std::all_of(function.moves.begin(), function.moves.end(),
                                 [&](const Move& move) { return sides_[move.point] == side; });
    return all ? side : 0;
  }
  static void flip(Function& function) {
    function.input = function.input.mirrored();
    for (Move& move : function.moves)
      move.vector = flipped(move.vector);
    if (function.turn) function.turn = flipped(*function.turn);
  }
  template <class List>
  static std::string left_name(const List& list, const std::string& name) {
    const auto is_free = [&](const std::string& wanted) {
      return find_named(list, wanted) == list.end() &&
             find_named(list, twin_of(wanted)) == list.end();
    };
    std::string wanted = name + "Left";
    for (int number = 2; !is_free(wanted); ++number)
      wanted = name + std::to_string(number) + "Left";
    return wanted;
  }

  EditedPuppet& draft_;
  Puppet& puppet_;
  std::vector<int> sides_; ///< of each point: 1 left, -1 right, 0 neither
};

} // namespace

Result<Puppet> with_mirror(const Rig& rig, bool mirrors) {
  EditedPuppet draft(rig);
  if (mirrors == rig.puppet().mirrors) return draft.done();
  if (mirrors)
    MirrorBeginning(draft).begin();
  else
    end_mirror(draft);
  draft.puppet().mirrors = mirrors;
  return draft.done();
}

namespace {

Result<void> add_masks(std::span<const Vector3d> stroke, double radius, Puppet& puppet) {
  if (!(radius > 0.0) || !std::isfinite(radius)) return refused("a brush needs a radius above 0");
  std::vector<Mask>& masks = puppet.masks;
  const auto add = [&](const Vector3d& at) {
    constexpr double near = 0.35; // of the radius: what is masked by one is masked by the other
    const bool is_there = std::any_of(masks.begin(), masks.end(), [&](const Mask& mask) {
      return mask.radius >= radius && (mask.at - at).norm() < near * radius;
    });
    if (!is_there && at.allFinite())
      masks.push_back({rounded(at, radius), rounded(radius, radius)});
  };
  for (const Vector3d& at : stroke) {
    add(at);
    if (puppet.mirrors) add(flipped(at, puppet.mirror_at));
  }
  if (masks.size() > most_painted_masks)
    return refused("there are more than " + std::to_string(most_painted_masks) +
                   " masks then; use a larger brush, or erase some");
  return {};
}

void erase_masks(std::span<const Vector3d> stroke, double radius, Puppet& puppet) {
  std::erase_if(puppet.masks, [&](const Mask& mask) {
    return std::any_of(stroke.begin(), stroke.end(), [&](const Vector3d& at) {
      return (mask.at - at).norm() <= radius ||
             (puppet.mirrors && (mask.at - flipped(at, puppet.mirror_at)).norm() <= radius);
    });
  });
}

} // namespace

Result<Puppet> with_masks(const Rig& rig, std::span<const Vector3d> stroke, double radius) {
  EditedPuppet draft(rig);
  if (draft.puppet().inverted)
    erase_masks(stroke, half_of_mask * radius, draft.puppet());
  else if (const auto added = add_masks(stroke, radius, draft.puppet()); !added)
    return added.error();
  return draft.done();
}

Result<Puppet> without_masks(const Rig& rig, std::span<const Vector3d> stroke, double radius) {
  EditedPuppet draft(rig);
  if (!draft.puppet().inverted)
    erase_masks(stroke, radius, draft.puppet());
  else if (const auto added = add_masks(stroke, radius / half_of_mask, draft.puppet()); !added)
    return added.error();
  return draft.done();
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

} // namespace nendo::puppet
