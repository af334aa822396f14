#include <nendo/deform/repair.hpp>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>

#include "cut/cut_cap.hpp"
#include "cut/half_edges.hpp"

namespace nendo::deform {
namespace {

class Repairer {
public:
  explicit Repairer(const Mesh& mesh) : mesh_(result_.mesh) { result_.mesh = mesh; }

  Result<Repair> run() {
    drop_faces();
    join_vertices();
    drop_faces();
    turn_faces();
    if (auto filled = fill_holes(); !filled) return filled.error();
    turn_outwards();
    if (const ManifoldCheck check = check_closed_manifold(mesh_); !check)
      return Error{Errc::bad_input, "cannot be repaired: it still " + describe(check, mesh_)};
    return std::move(result_);
  }

private:
  void drop_faces();
  void join_vertices();
  void turn_faces();
  void turn(std::size_t face);
  void turn_outwards();
  Result<void> fill_holes();
  Result<void> fill(const std::vector<std::uint32_t>& hole);
  HalfEdges edges() const {
    return half_edges_of(mesh_.face_starts, mesh_.face_corners,
                         static_cast<std::size_t>(mesh_.vertices.cols()));
  }
  std::size_t face_at(std::uint32_t corner) const {
    const auto behind =
        std::upper_bound(mesh_.face_starts.begin(), mesh_.face_starts.end(), corner);
    return static_cast<std::size_t>(behind - mesh_.face_starts.begin()) - 1;
  }

  Repair result_;
  Mesh& mesh_;
};

template <class Values>
void keep(Values& values, const std::vector<std::size_t>& which) {
  if (values.empty()) return;
  Values kept;
  for (const std::size_t at : which)
    kept.push_back(values[at]);
  values = std::move(kept);
}

/// Drops faces that have no area by their corners alone, and those that have the same corners as a
/// face before.
void Repairer::drop_faces() {
  std::set<std::vector<std::uint32_t>> seen;
  std::vector<std::size_t> kept;
  std::vector<std::uint32_t> starts{0}, corners, texcoords;
  for (std::size_t face = 0; face < mesh_.face_count(); ++face) {
    std::vector<std::uint32_t> own;
    const std::uint32_t begin = mesh_.face_starts[face], end = mesh_.face_starts[face + 1];
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t next = at + 1 < end ? at + 1 : begin;
      if (mesh_.face_corners[at] != mesh_.face_corners[next]) own.push_back(at);
    }
    std::vector<std::uint32_t> key;
    for (const std::uint32_t at : own)
      key.push_back(mesh_.face_corners[at]);
    std::sort(key.begin(), key.end());
    const bool repeats = std::adjacent_find(key.begin(), key.end()) != key.end();
    if (own.size() < 3 || repeats || !seen.insert(key).second) {
      ++result_.dropped;
      continue;
    }
    for (const std::uint32_t at : own) {
      corners.push_back(mesh_.face_corners[at]);
      if (!mesh_.corner_texcoords.empty()) texcoords.push_back(mesh_.corner_texcoords[at]);
    }
    starts.push_back(static_cast<std::uint32_t>(corners.size()));
    kept.push_back(face);
  }
  mesh_.face_starts = std::move(starts);
  mesh_.face_corners = std::move(corners);
  mesh_.corner_texcoords = std::move(texcoords);
  keep(mesh_.look.face_materials, kept);
  keep(mesh_.look.groups.of_face, kept);
  keep(mesh_.look.objects.of_face, kept);
}

/// Vertices at open edges become the first one that lies in the same place.
void Repairer::join_vertices() {
  const HalfEdges edges = this->edges();
  std::vector<std::uint8_t> open(static_cast<std::size_t>(mesh_.vertices.cols()), 0);
  for (std::uint32_t edge = 0; edge < mesh_.face_corners.size(); ++edge)
    if (edges.twin[edge] == no_half_edge) {
      open[mesh_.face_corners[edge]] = 1;
      open[mesh_.face_corners[edges.next[edge]]] = 1;
    }
  std::map<SpacePoint, std::uint32_t> first_at;
  std::vector<std::uint32_t> joined(open.size());
  std::iota(joined.begin(), joined.end(), 0U);
  for (std::uint32_t vertex = 0; vertex < open.size(); ++vertex) {
    if (open[vertex] == 0) continue;
    const double* at = mesh_.vertices.data() + 3 * std::size_t{vertex};
    const auto [found, is_new] = first_at.try_emplace({at[0], at[1], at[2]}, vertex);
    if (is_new) continue;
    joined[vertex] = found->second;
    ++result_.joined;
  }
  for (std::uint32_t& corner : mesh_.face_corners)
    corner = joined[corner];
}

void Repairer::turn(std::size_t face) {
  const auto begin = static_cast<std::ptrdiff_t>(mesh_.face_starts[face]);
  const auto end = static_cast<std::ptrdiff_t>(mesh_.face_starts[face + 1]);
  std::reverse(mesh_.face_corners.begin() + begin, mesh_.face_corners.begin() + end);
  if (!mesh_.corner_texcoords.empty())
    std::reverse(mesh_.corner_texcoords.begin() + begin, mesh_.corner_texcoords.begin() + end);
}

/// Turns faces so that each agrees with the neighbour from which it was reached, beginning with the
/// first face of each part.
void Repairer::turn_faces() {
  struct Side {
    std::size_t face;
    bool forward; ///< from the lesser vertex to the greater one
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> sides;
  const auto for_each_side = [&](std::size_t face, const auto& visit) {
    const std::uint32_t begin = mesh_.face_starts[face], end = mesh_.face_starts[face + 1];
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t from = mesh_.face_corners[at];
      const std::uint32_t to = mesh_.face_corners[at + 1 < end ? at + 1 : begin];
      visit(std::pair(std::min(from, to), std::max(from, to)), from < to);
    }
  };
  for (std::size_t face = 0; face < mesh_.face_count(); ++face)
    for_each_side(face,
                  [&](const auto& edge, bool forward) { sides[edge].push_back({face, forward}); });
  std::vector<std::uint8_t> reached(mesh_.face_count(), 0), turns(mesh_.face_count(), 0);
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < mesh_.face_count(); ++first) {
    if (reached[first] != 0) continue;
    reached[first] = 1;
    open.push_back(first);
    while (!open.empty()) {
      const std::size_t face = open.back();
      open.pop_back();
      for_each_side(face, [&](const auto& edge, bool forward) {
        const auto& beside = sides[edge];
        if (beside.size() != 2) return;
        const Side& other = beside[beside[0].face == face ? 1 : 0];
        if (reached[other.face] != 0) return;
        reached[other.face] = 1;
        turns[other.face] = (other.forward == forward) != (turns[face] != 0) ? 1 : 0;
        open.push_back(other.face);
      });
    }
  }
  for (std::size_t face = 0; face < turns.size(); ++face)
    if (turns[face] != 0) {
      turn(face);
      ++result_.turned;
    }
}

/// A model whose volume is negative is turned as a whole.
void Repairer::turn_outwards() {
  if (volume_of(mesh_) >= 0.0) return;
  for (std::size_t face = 0; face < mesh_.face_count(); ++face)
    turn(face);
  result_.turned += mesh_.face_count();
}

Result<void> Repairer::fill_holes() {
  const HalfEdges edges = this->edges();
  std::vector<std::uint8_t> done(mesh_.face_corners.size(), 0);
  std::vector<std::vector<std::uint32_t>> holes;
  for (std::uint32_t first = 0; first < done.size(); ++first) {
    if (edges.twin[first] != no_half_edge || done[first] != 0) continue;
    // Backwards round the hole: the open edge that ends where this one begins is found by turning
    // about that vertex.
    std::vector<std::uint32_t> hole;
    std::uint32_t edge = first;
    while (done[edge] == 0) {
      done[edge] = 1;
      hole.push_back(mesh_.face_corners[edges.next[edge]]);
      std::uint32_t before = edges.last[edge];
      for (std::size_t turned = 0; edges.twin[before] != no_half_edge; ++turned) {
        if (turned > done.size()) break;
        before = edges.last[edges.twin[before]];
      }
      edge = before;
    }
    if (edge != first) return Error{Errc::bad_input, "cannot be repaired: its holes touch"};
    holes.push_back(std::move(hole));
  }
  for (const auto& hole : holes) {
    if (auto filled = fill(hole); !filled) return filled;
    ++result_.filled;
  }
  return {};
}

/// Fills a hole by triangles between its corners, in the plane of its area. The corners come in the
/// order that the new faces need.
Result<void> Repairer::fill(const std::vector<std::uint32_t>& hole) {
  const auto point = [&](std::uint32_t vertex) {
    const double* at = mesh_.vertices.data() + 3 * std::size_t{vertex};
    return SpacePoint{at[0], at[1], at[2]};
  };
  SpacePoint area{};
  for (std::size_t k = 1; k + 1 < hole.size(); ++k)
    area = area + cross(point(hole[k]) - point(hole[0]), point(hole[k + 1]) - point(hole[0]));
  const PlaneBlade plane(point(hole[0]), area);
  CapLoop loop;
  for (std::uint32_t k = 0; k < hole.size(); ++k) {
    loop.crossings.push_back(k);
    loop.places.push_back(plane.chart(point(hole[k])));
  }
  const Cap cap = make_cap({&loop, 1}, static_cast<std::uint32_t>(hole.size()), {});
  if (!(length_of(area) > 0.0) || cap.fault != PlaneFault::none || cap.triangles.empty()) {
    const SpacePoint at = point(hole[0]);
    return Error{Errc::bad_input, "cannot be repaired: the hole at (" + std::to_string(at[0]) +
                                      ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) +
                                      ") is too crooked to be filled by flat triangles"};
  }
  for (const Corners& triangle : cap.triangles) {
    for (const std::uint32_t corner : triangle) {
      mesh_.face_corners.push_back(hole[corner]);
      if (!mesh_.corner_texcoords.empty()) mesh_.corner_texcoords.push_back(0);
    }
    mesh_.face_starts.push_back(static_cast<std::uint32_t>(mesh_.face_corners.size()));
    for (auto* values :
         {&mesh_.look.face_materials, &mesh_.look.groups.of_face, &mesh_.look.objects.of_face})
      if (!values->empty()) values->push_back(no_index);
  }
  return {};
}

} // namespace

Result<Repair> repair(const Mesh& mesh) {
  if (!(mesh.vertices.array().abs() <= 1e60).all())
    return Error{Errc::bad_input, "cannot be repaired: it has coordinates that are too large"};
  return Repairer(mesh).run();
}

std::string describe(const Repair& repair) {
  std::string words;
  const auto add = [&](std::size_t count, const char* did, const char* one, const char* many) {
    if (count == 0) return;
    if (!words.empty()) words += ", ";
    words += std::string(did) + " " + std::to_string(count) + " " + (count == 1 ? one : many);
  };
  add(repair.dropped, "dropped", "face", "faces");
  add(repair.joined, "joined", "vertex", "vertices");
  add(repair.turned, "turned", "face", "faces");
  add(repair.filled, "filled", "hole", "holes");
  return words.empty() ? "nothing to repair" : words;
}

} // namespace nendo::deform
