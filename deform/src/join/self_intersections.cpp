#include "join/self_intersections.hpp"

#include <algorithm>

#include <nendo/deform/index.hpp>

#include "geometry/box_tree.hpp"
#include "geometry/triangle_meeting.hpp"

namespace nendo::deform {
namespace {

/// Collects pairs, sorted at the end.
std::vector<TrianglePair> sorted_pairs(std::vector<TrianglePair> pairs, std::size_t most) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  if (pairs.size() > most) pairs.resize(most);
  return pairs;
}

/// Of triangles of a tree with others, unsorted. None is in both.
std::vector<TrianglePair> found_between(std::span<const SpacePoint> places,
                                        std::span<const Corners> triangles, const BoxTree& tree,
                                        std::span<const std::uint32_t> others, std::size_t most) {
  std::vector<TrianglePair> found;
  if (tree.empty() || others.empty()) return found;
  std::vector<std::uint32_t> near;
  for (const std::uint32_t triangle : others)
    if (meet(tree.box(), box_around(places, triangles[triangle]))) near.push_back(triangle);
  const BoxTree near_tree(places, triangles, std::move(near));
  tree.visit_pairs(near_tree, [&](std::uint32_t mine, std::uint32_t other) {
    if (mine != other && found.size() < most &&
        triangles_meet(places, triangles[mine], triangles[other]))
      found.emplace_back(std::min(mine, other), std::max(mine, other));
  });
  return found;
}

} // namespace

std::vector<TrianglePair> intersections_between(std::span<const SpacePoint> places,
                                                std::span<const Corners> triangles,
                                                std::span<const std::uint32_t> some,
                                                std::span<const std::uint32_t> others,
                                                std::size_t most) {
  if (others.empty()) return {};
  const BoxTree tree(places, triangles, {some.begin(), some.end()});
  return sorted_pairs(found_between(places, triangles, tree, others, most), most);
}

std::vector<TrianglePair> self_intersections_of(std::span<const SpacePoint> places,
                                                std::span<const Corners> triangles,
                                                std::span<const std::uint32_t> changed,
                                                std::size_t most) {
  std::vector<char> is_changed(triangles.size(), 0);
  std::vector<TrianglePair> found;
  for (const std::uint32_t triangle : changed) {
    is_changed[triangle] = 1;
    const Corners& corner = triangles[triangle];
    if (is_degenerate(places[corner[0]], places[corner[1]], places[corner[2]]))
      found.emplace_back(triangle, triangle);
  }
  std::vector<std::uint32_t> others;
  for (std::uint32_t triangle = 0; triangle < triangles.size(); ++triangle)
    if (!is_changed[triangle]) others.push_back(triangle);
  const BoxTree tree(places, triangles, {changed.begin(), changed.end()});
  const auto between = found_between(places, triangles, tree, others, most);
  found.insert(found.end(), between.begin(), between.end());
  tree.visit_pairs(tree, [&](std::uint32_t one, std::uint32_t other) {
    if (one < other && found.size() < most &&
        triangles_meet(places, triangles[one], triangles[other]))
      found.emplace_back(one, other);
  });
  return sorted_pairs(std::move(found), most);
}

std::vector<TrianglePair> self_intersections(std::span<const SpacePoint> places,
                                             std::span<const Corners> triangles, std::size_t most) {
  return self_intersections_of(places, triangles, all_indices(triangles.size()), most);
}

} // namespace nendo::deform
