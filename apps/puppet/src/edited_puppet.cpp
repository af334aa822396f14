#include "edited_puppet.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <nendo/puppet/puppet.hpp>
#include <nendo/puppet/puppet_edit.hpp>

namespace nendo::puppet {

using Eigen::Vector3d;

Vector3d flipped(const Vector3d& place, double at) {
  return {2.0 * at - place.x(), place.y(), place.z()};
}

AxisTurn flipped(const AxisTurn& turn) {
  return {turn.degrees, -flipped(turn.axis), flipped(turn.through)};
}

double rounded(double value, double radius, int more) {
  const int digits = std::clamp(3 - static_cast<int>(std::floor(std::log10(radius))) + more, 0, 30);
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, digits)
          .ptr;
  double read = value;
  std::from_chars(text.data(), end, read);
  return read;
}

Vector3d rounded(const Vector3d& vector, double radius, int more) {
  return {rounded(vector.x(), radius, more), rounded(vector.y(), radius, more),
          rounded(vector.z(), radius, more)};
}

Error refused(std::string message) {
  return {Errc::bad_input, std::move(message)};
}

Result<Puppet> EditedPuppet::done() const {
  const std::string text = text_of(puppet_);
  return parse_puppet(text, "the puppet");
}

std::size_t EditedPuppet::source_of_point(std::size_t point) const {
  if (!puppet_.points[point].is_mirrored) return point;
  return twin_of_point(point);
}

std::size_t EditedPuppet::twin_of_point(std::size_t point) const {
  const auto twin = find_named(puppet_.points, twin_of(puppet_.points[point].name));
  return twin == puppet_.points.end() ? point
                                      : static_cast<std::size_t>(twin - puppet_.points.begin());
}

std::size_t EditedPuppet::source_of_function(std::size_t function) const {
  if (!puppet_.functions[function].is_twin) return function;
  const auto source = find_named(puppet_.functions, twin_of(puppet_.functions[function].name));
  return static_cast<std::size_t>(source - puppet_.functions.begin());
}

std::size_t EditedPuppet::mover_of(std::size_t point) const {
  const auto mover = std::ranges::find_if(puppet_.functions, [&](const Function& function) {
    return std::ranges::find(function.moves, point, &Move::point) != function.moves.end();
  });
  return static_cast<std::size_t>(mover - puppet_.functions.begin());
}

Result<std::size_t> EditedPuppet::add_point(const NewPoint& point, bool is_pin) {
  if (!(point.radius > 0.0) || !std::isfinite(point.radius) || !point.at.allFinite())
    return refused("a point needs a place and a radius above 0");
  const std::size_t added = is_sided(point) ? 2 : 1;
  if (puppet_.points.size() + added > Puppet::max_points)
    return refused("there are " + std::to_string(puppet_.points.size()) +
                   " points already, of at most " + std::to_string(Puppet::max_points) +
                   "; remove some");
  for (std::size_t at = 0; at < puppet_.points.size(); ++at) {
    const double least = min_gap_of_points * std::min(point.radius, puppet_.points[at].radius);
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

bool EditedPuppet::is_sided(const NewPoint& point) const {
  return puppet_.mirrors && std::abs(point.at.x()) > middle * point.radius;
}

void EditedPuppet::remove_points(const std::vector<bool>& goes) {
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
  std::erase_if(puppet_.functions, [](const Function& function) { return function.moves.empty(); });
}

namespace {

bool has_side(const std::string& name) {
  return twin_of(name) != name;
}

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
    const bool is_near = std::abs(draft_.start(at).x()) <= EditedPuppet::middle * point.radius;
    if (is_near && !point.vertex && !has_side(point.name)) point.at.x() = 0.0;
  }
  /// Those that functions of both sides move stay as they are.
  void find_sides() {
    for (std::size_t at = 0; at < sides_.size(); ++at) {
      const PuppetPoint& point = puppet_.points[at];
      const double x = draft_.start(at).x();
      if (!has_side(point.name) && std::abs(x) > EditedPuppet::middle * point.radius)
        sides_[at] = x < 0 ? -1 : 1;
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
    const bool all = std::ranges::all_of(
        function.moves, [&](const Move& move) { return sides_[move.point] == side; });
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
  std::vector<int> sides_; ///< each point's: 1 left, -1 right, 0 neither
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

} // namespace nendo::puppet
