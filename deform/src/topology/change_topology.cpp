#include <nendo/deform/topology.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <nendo/deform/refinement.hpp>

#include "join/mesh_surface.hpp"
#include "join/self_intersections.hpp"
#include "topology/thin_places.hpp"

namespace nendo::deform {

namespace {

/// Where faces met, nothing is done in the next attempt.
constexpr int max_tries = 5;
/// Walls that are thin in many places get one hole after the other, and not all at once: so far
/// apart, in edges.
constexpr double between_holes = 8.0;
constexpr std::size_t max_of_patch = 4096; // points

/// A hole that there was, or a bridge, becomes wider where there was one patch.
void count(ThinPlace::Kind kind, int patches, TopologyCounts& counts) noexcept {
  if (kind == ThinPlace::Kind::neck)
    ++counts.parted;
  else if (patches == 1)
    ++counts.widened;
  else
    ++(kind == ThinPlace::Kind::wall ? counts.holes : counts.fused);
}

/// What was tried at once, from the thinnest place on.
class TopologyAttempt {
public:
  TopologyAttempt(ThinSurface surface, const std::vector<ThinPlace>& places,
                  const std::set<Triple>& left_alone)
      : surface_(std::move(surface)) {
    for (const ThinPlace& place : places)
      if (place.kind != ThinPlace::Kind::neck)
        facing_[place.kind == ThinPlace::Kind::wall ? 0 : 1].insert(place.points.begin(),
                                                                    place.points.end());
    for (const ThinPlace& place : places)
      if (place.begins && !left_alone.contains(place.points) && !is_touched(place)) change(place);
    kept = surface_.take(numbers_);
  }

  /// Returns the places of which some face meets another now.
  std::set<Triple> meeting() const {
    std::map<std::uint32_t, Triple> of_face;
    std::vector<std::uint32_t> changed;
    for (const auto& [face, place] : changed_) {
      const std::uint32_t number = numbers_.faces[face];
      if (number == no_index) continue;
      of_face[number] = place;
      changed.push_back(number);
    }
    std::set<Triple> places;
    for (const auto& [one, other] : self_intersections_of(kept.points, kept.faces, changed))
      for (const std::uint32_t face : {one, other})
        if (const auto found = of_face.find(face); found != of_face.end())
          places.insert(found->second);
    return places;
  }

  TriangleSurface kept;
  TopologyCounts counts;

private:
  /// By something before; and holes are not made near each other.
  bool is_touched(const ThinPlace& place) const {
    if (std::any_of(place.points.begin(), place.points.end(), [this](std::uint32_t point) {
          return touched_.contains(point) || surface_.ring(point).empty();
        }))
      return true;
    if (place.kind == ThinPlace::Kind::neck) return false;
    const std::uint32_t at = place.points[0];
    return std::any_of(joined_.begin(), joined_.end(), [&](const SpacePoint& other) {
      return distance_between(surface_.point(at), other) < between_holes * surface_.wanted(at);
    });
  }
  void change(const ThinPlace& place) {
    const bool is_neck = place.kind == ThinPlace::Kind::neck;
    std::vector<std::uint32_t> points(place.points.begin(), place.points.end());
    if (!is_neck) points = patches_of(place);
    std::set<std::uint32_t> around(points.begin(), points.end());
    for (const std::uint32_t point : points) {
      const std::vector<std::uint32_t> ring = surface_.ring(point);
      around.insert(ring.begin(), ring.end());
    }
    const SpacePoint at = surface_.point(place.points[0]);
    const int patches = is_neck ? 0 : surface_.join_rims(points);
    if (is_neck ? !surface_.part(place.points) : patches == 0) return;
    count(place.kind, patches, counts);
    if (!is_neck) joined_.push_back(at);
    touched_.insert(around.begin(), around.end());
    for (const std::uint32_t face : surface_.take_changed())
      changed_.emplace_back(face, place.points);
  }
  std::vector<std::uint32_t> patches_of(const ThinPlace& place) const {
    const auto& facing = facing_[place.kind == ThinPlace::Kind::wall ? 0 : 1];
    std::set<std::uint32_t> both;
    for (const std::uint32_t first : {place.points[0], place.points[1]}) {
      const std::vector<std::uint32_t> patch = patch_from(first, facing);
      both.insert(patch.begin(), patch.end());
    }
    return {both.begin(), both.end()};
  }
  /// Returns the points around one that face others.
  std::vector<std::uint32_t> patch_from(std::uint32_t first,
                                        const std::set<std::uint32_t>& facing) const {
    std::vector<std::uint32_t> patch{first};
    std::set<std::uint32_t> seen{first};
    for (std::size_t at = 0; at < patch.size() && patch.size() < max_of_patch; ++at)
      for (const std::uint32_t neighbour : surface_.ring(patch[at]))
        if (facing.contains(neighbour) && !touched_.contains(neighbour) &&
            seen.insert(neighbour).second)
          patch.push_back(neighbour);
    for (std::size_t at = 0; at < patch.size() && patch.size() < max_of_patch; ++at)
      for (const std::uint32_t neighbour : surface_.ring(patch[at]))
        if (!seen.contains(neighbour) && !touched_.contains(neighbour) &&
            is_within(neighbour, seen)) {
          seen.insert(neighbour);
          patch.push_back(neighbour);
        }
    return patch;
  }
  /// Most of its neighbours are: islands in a patch belong to it.
  bool is_within(std::uint32_t point, const std::set<std::uint32_t>& patch) const {
    const std::vector<std::uint32_t> ring = surface_.ring(point);
    const auto in = std::count_if(ring.begin(), ring.end(), [&](std::uint32_t neighbour) {
      return patch.contains(neighbour);
    });
    return 3 * in >= 2 * static_cast<std::ptrdiff_t>(ring.size());
  }

  ThinSurface surface_;
  std::array<std::set<std::uint32_t>, 2> facing_; ///< points of thin walls, of gaps
  std::set<std::uint32_t> touched_;
  std::vector<SpacePoint> joined_;
  std::vector<std::pair<std::uint32_t, Triple>> changed_; ///< faces, and by which place
  Renumbering numbers_;
};

} // namespace

Result<ChangedTopology> change_topology(const Mesh& mesh) {
  if (const auto fine = Refiner::check(mesh); !fine) return fine.error();
  auto [surface, look] = single_surface_of(mesh);
  const ThinSurface before(std::move(surface));
  const std::vector<ThinPlace> places = thin_places(before);
  std::set<Triple> left_alone;
  for (int number = 0; number < max_tries; ++number) {
    TopologyAttempt attempt(before, places, left_alone);
    if (attempt.counts.all() == 0) break;
    const std::set<Triple> meeting = attempt.meeting();
    if (meeting.empty()) {
      ChangedTopology changed{mesh_of(attempt.kept, look), attempt.counts};
      changed.mesh.offset = mesh.offset;
      if (Refiner::check(changed.mesh)) return changed;
      break;
    }
    left_alone.insert(meeting.begin(), meeting.end());
  }
  return ChangedTopology{mesh, {}};
}

std::size_t count_thin_places(const Mesh& mesh) {
  if (!Refiner::check(mesh)) return 0;
  const std::vector<ThinPlace> places = thin_places(ThinSurface(single_surface_of(mesh).first));
  return static_cast<std::size_t>(std::count_if(
      places.begin(), places.end(), [](const ThinPlace& place) { return place.begins; }));
}

} // namespace nendo::deform
