#include <nendo/puppet/puppet_edit.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <nendo/puppet/puppet.hpp>

#include "edited_puppet.hpp"

namespace nendo::puppet {
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

using deform::Points;
using Eigen::Index;
using Eigen::Vector3d;

namespace {

constexpr double tolerance = 1e-4; // of the diagonal, between a vertex and the image of another
constexpr Index max_looked_at = 1000;
constexpr double max_alone = 0.05; // of them

/// Returns which part of the vertices that are looked at has no image in the plane x = at.
double part_alone(const Points& vertices, const std::vector<Index>& by_x, double at) {
  const double near = tolerance * deform::diagonal_of(vertices);
  const Index step = std::max<Index>(1, vertices.cols() / max_looked_at);
  Index looked_at = 0, alone = 0;
  for (Index v = 0; v < vertices.cols(); v += step, ++looked_at) {
    Vector3d image = vertices.col(v);
    image.x() = 2.0 * at - image.x();
    auto other = std::lower_bound(by_x.begin(), by_x.end(), image.x() - near,
                                  [&](Index one, double x) { return vertices(0, one) < x; });
    bool found = false;
    for (; !found && other != by_x.end() && vertices(0, *other) <= image.x() + near; ++other)
      found = (vertices.col(*other) - image).norm() <= near;
    if (!found) ++alone;
  }
  return looked_at == 0 ? 1.0 : static_cast<double>(alone) / static_cast<double>(looked_at);
}

} // namespace

double plane_of_symmetry(const Points& vertices) {
  if (vertices.cols() == 0 || !vertices.allFinite()) return 0.0;
  const double middle = 0.5 * (vertices.row(0).minCoeff() + vertices.row(0).maxCoeff());
  if (std::abs(middle) <= tolerance * deform::diagonal_of(vertices)) return 0.0;
  std::vector<Index> by_x(static_cast<std::size_t>(vertices.cols()));
  for (std::size_t at = 0; at < by_x.size(); ++at)
    by_x[at] = static_cast<Index>(at);
  std::sort(by_x.begin(), by_x.end(),
            [&](Index one, Index other) { return vertices(0, one) < vertices(0, other); });
  return part_alone(vertices, by_x, middle) <= max_alone ? middle : 0.0;
}

} // namespace nendo::puppet
