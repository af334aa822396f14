#include "join/crossings.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "geometry/exact_predicates.hpp"

namespace nendo::deform {
namespace {

/// An edge of one part, its points in rising order, and a face of the other.
struct CrossingName {
  std::uint32_t part, from, to, face;
  bool operator==(const CrossingName&) const = default;
};

struct CrossingNameHash {
  std::size_t operator()(const CrossingName& name) const noexcept {
    std::uint64_t hash = name.part;
    for (const std::uint32_t word : {name.from, name.to, name.face}) {
      hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

class CrossingFinder {
public:
  CrossingFinder(const std::array<CrossedPart, 2>& parts, Crossings& crossings)
      : parts_(parts), crossings_(crossings) {}

  bool look_at(std::uint32_t face_of_first, std::uint32_t face_of_second) {
    const std::array<std::uint32_t, 2> faces{face_of_first, face_of_second};
    std::array<std::array<int, 3>, 2> sides{};
    for (std::uint32_t part = 0; part < 2; ++part) {
      if (!sides_of(part, faces, sides[part])) return false;
      if (sides[part][0] == sides[part][1] && sides[part][1] == sides[part][2]) return true;
    }
    found_count_ = 0;
    for (std::uint32_t part = 0; part < 2; ++part)
      if (!cross_edges(part, faces, sides[part])) return false;
    if (found_count_ == 0) return true;
    if (found_count_ != 2 || found_[0] == found_[1]) return false;
    crossings_.segments.push_back({{found_[0], found_[1]}, faces});
    return true;
  }

private:
  const SpacePoint& point(std::uint32_t part, std::uint32_t number) const {
    return parts_[part].points[number];
  }

  /// On which sides of the other face the corners of part's face are; false: one is in its plane.
  bool sides_of(std::uint32_t part, const std::array<std::uint32_t, 2>& faces,
                std::array<int, 3>& sides) const {
    const Corners& own = parts_[part].faces[faces[part]];
    const Corners& other = parts_[1 - part].faces[faces[1 - part]];
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k] = orient_3d(point(1 - part, other[0]), point(1 - part, other[1]),
                           point(1 - part, other[2]), point(part, own[k]));
      if (sides[k] == 0) return false;
    }
    return true;
  }

  bool cross_edges(std::uint32_t part, const std::array<std::uint32_t, 2>& faces,
                   const std::array<int, 3>& sides) {
    const Corners& own = parts_[part].faces[faces[part]];
    for (std::size_t k = 0; k < 3; ++k) {
      if (sides[k] == sides[(k + 1) % 3]) continue;
      const auto [from, to] = std::minmax(own[k], own[(k + 1) % 3]);
      const std::optional<bool> through = goes_through(part, from, to, faces[1 - part]);
      if (!through) return false;
      if (!*through) continue;
      if (found_count_ == 2) return false;
      found_[found_count_++] = numbered({part, from, to, faces[1 - part]});
    }
    return true;
  }

  /// Of an edge whose ends are on both sides of the face's plane; nothing if it meets the rim.
  std::optional<bool> goes_through(std::uint32_t part, std::uint32_t from, std::uint32_t to,
                                   std::uint32_t face) const {
    const Corners& other = parts_[1 - part].faces[face];
    std::array<int, 3> sides{};
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k] = orient_3d(point(part, from), point(part, to), point(1 - part, other[k]),
                           point(1 - part, other[(k + 1) % 3]));
      if (sides[k] == 0) return std::nullopt;
    }
    return sides[0] == sides[1] && sides[1] == sides[2];
  }

  std::uint32_t numbered(const CrossingName& name) {
    const auto [found, is_new] = numbers_.try_emplace(name, to_index(crossings_.points.size()));
    if (!is_new) return found->second;
    const Corners& other = parts_[1 - name.part].faces[name.face];
    const SpacePoint& a = point(1 - name.part, other[0]);
    const SpacePoint normal =
        area_vector(a, point(1 - name.part, other[1]), point(1 - name.part, other[2]));
    const SpacePoint& from = point(name.part, name.from);
    const SpacePoint& to = point(name.part, name.to);
    const double before = dot(normal, from - a);
    const double after = dot(normal, to - a);
    const double along = std::clamp(before / (before - after), 0.0, 1.0);
    crossings_.points.push_back(
        {name.part, name.from, name.to, name.face, along, from + along * (to - from)});
    return found->second;
  }

  const std::array<CrossedPart, 2>& parts_;
  Crossings& crossings_;
  std::unordered_map<CrossingName, std::uint32_t, CrossingNameHash> numbers_;
  std::array<std::uint32_t, 2> found_{};
  std::size_t found_count_ = 0;
};

/// Directions of no special place, so that rays rarely meet an edge.
constexpr std::array<SpacePoint, 8> ray_directions{{{0.5319, 0.6172, 0.5797},
                                                    {-0.7131, 0.2917, 0.6374},
                                                    {0.1733, -0.8431, 0.5091},
                                                    {0.8347, 0.1171, -0.5381},
                                                    {-0.3299, -0.5417, -0.7731},
                                                    {0.2741, 0.9311, -0.2409},
                                                    {-0.9127, 0.3389, -0.2287},
                                                    {0.4261, -0.2593, 0.8669}}};

/// Returns how often the ray from `place` to `far` goes through the surface; nothing if it meets an
/// edge.
std::optional<std::size_t> count_crossed(const SpacePoint& place, const SpacePoint& far,
                                         const CrossedPart& part) {
  std::size_t crossed = 0;
  bool is_certain = true;
  const SpacePoint way = far - place;
  const auto enters = [&](const SpaceBox& box) {
    if (!is_certain) return false;
    double first = 0.0;
    double last = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double a = (box.low[axis] - place[axis]) / way[axis];
      const double b = (box.high[axis] - place[axis]) / way[axis];
      first = std::max(first, std::min(a, b) - 1e-9); // wide, so that rounding loses nothing
      last = std::min(last, std::max(a, b) + 1e-9);
    }
    return first <= last;
  };
  part.tree->visit(enters, [&](std::uint32_t face) {
    const Corners& corner = part.faces[face];
    const SpacePoint& a = part.points[corner[0]];
    const SpacePoint& b = part.points[corner[1]];
    const SpacePoint& c = part.points[corner[2]];
    const int near_side = orient_3d(a, b, c, place);
    const int far_side = orient_3d(a, b, c, far);
    if (near_side == far_side && near_side != 0) return;
    const int first = orient_3d(place, far, a, b);
    const int second = orient_3d(place, far, b, c);
    const int third = orient_3d(place, far, c, a);
    if (std::min({first, second, third}) < 0 && std::max({first, second, third}) > 0) return;
    if (near_side * far_side * first * second * third == 0) is_certain = false;
    ++crossed;
  });
  if (!is_certain) return std::nullopt;
  return crossed;
}

} // namespace

bool find_crossings(const std::array<CrossedPart, 2>& parts, Crossings& crossings) {
  crossings = {};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  parts[0].tree->visit_pairs(*parts[1].tree, [&](std::uint32_t first, std::uint32_t second) {
    pairs.emplace_back(first, second);
  });
  std::sort(pairs.begin(), pairs.end());
  CrossingFinder finder(parts, crossings);
  return std::all_of(pairs.begin(), pairs.end(),
                     [&](const auto& pair) { return finder.look_at(pair.first, pair.second); });
}

int is_inside(const SpacePoint& place, const CrossedPart& part) {
  if (part.tree->empty()) return 0;
  const SpaceBox& box = part.tree->box();
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (place[axis] < box.low[axis] || place[axis] > box.high[axis]) return 0;
  const double reach = 4.0 * distance_between(box.low, box.high);
  for (const SpacePoint& direction : ray_directions)
    if (const auto crossed = count_crossed(place, place + reach * direction, part))
      return static_cast<int>(*crossed % 2);
  return -1;
}

} // namespace nendo::deform
