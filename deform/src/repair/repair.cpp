#include <nendo/deform/repair.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/triangles.hpp>

#include "corner_colours.hpp"
#include "cut/cut_assembly.hpp"
#include "repair/doubles.hpp"
#include "repair/holes.hpp"
#include "repair/near_places.hpp"
#include "repair/stitch.hpp"
#include "repair/t_junctions.hpp"
#include "repair/turning.hpp"
#include "repair/weld.hpp"

namespace nendo::deform {
namespace {

constexpr double default_tolerance = 1e-5; // of the diagonal
constexpr double largest_repairable = 1e60;

class Repairer {
public:
  Repairer(const Mesh& mesh, double tolerance) : mesh_(result_.mesh) {
    result_.mesh = mesh;
    result_.tolerance = tolerance;
  }

  Result<Repair> run() {
    drop_thin_faces();
    drop_doubles(); // they would close the edges of the first ones
    join_places();
    split_junctions();
    drop_doubles();
    if (auto turned = turn(); !turned) return turned.error();
    separate();
    drop_strays();
    const auto filled = fill_holes(mesh_);
    if (!filled) return filled.error();
    result_.filled = filled->count;
    result_.filled_crossing = filled->crossing;
    if (const ManifoldCheck check = check_closed_manifold(mesh_); !check)
      return Error{Errc::bad_input, "cannot be repaired: it still " + describe(check, mesh_)};
    if (auto solid = check_volumes(); !solid) return solid.error();
    result_.turned += turn_outwards(mesh_);
    return std::move(result_);
  }

private:
  void drop_thin_faces();
  void drop_doubles() { result_.dropped += drop_double_faces(mesh_, place_of_); }
  void join_places();
  void split_junctions();
  Result<void> turn();
  void separate();
  void drop_strays();
  Result<void> check_volumes() const;
  std::vector<std::uint8_t> open_vertices() const;
  std::string where(std::uint32_t vertex) const {
    return place_text(mesh_.vertices.col(vertex), mesh_.offset);
  }

  Repair result_;
  Mesh& mesh_;
  std::vector<std::uint32_t> place_of_; ///< of each corner: the first vertex of its place
};

/// Faces with fewer than three corners, and corners that repeat the one before.
void Repairer::drop_thin_faces() {
  std::vector<std::uint32_t> same(static_cast<std::size_t>(mesh_.vertices.cols()));
  for (std::uint32_t at = 0; at < same.size(); ++at)
    same[at] = at;
  const DroppedCorners dropped = renumber_corners(mesh_, same);
  result_.dropped += dropped.faces;
  result_.repeated = dropped.corners;
  place_of_ = mesh_.face_corners;
}

/// Vertices of edges that have not just two faces.
std::vector<std::uint8_t> Repairer::open_vertices() const {
  std::vector<std::uint8_t> open(static_cast<std::size_t>(mesh_.vertices.cols()), 0);
  for_each_edge(placed_edges(mesh_, mesh_.face_corners), [&](std::span<const PlacedEdge> sides) {
    if (sides.size() != 2) open[sides[0].low] = open[sides[0].high] = 1;
  });
  return open;
}

/// Corners keep their vertices for now: only places become one. Faces that get thinner than three
/// places by it go.
void Repairer::join_places() {
  const std::vector<std::uint32_t> place =
      near_places(mesh_.vertices, open_vertices(), result_.tolerance);
  std::vector<std::uint8_t> used(place.size(), 0);
  for (const std::uint32_t vertex : mesh_.face_corners)
    used[vertex] = 1;
  const Eigen::Matrix4Xf& colours = mesh_.look.vertex_colours;
  bool differ = false;
  for (std::uint32_t vertex = 0; vertex < place.size(); ++vertex)
    if (used[vertex] != 0 && place[vertex] != vertex) {
      ++result_.joined;
      differ = differ || (colours.cols() > 0 && colours.col(vertex) != colours.col(place[vertex]));
    }
  if (differ) move_colours_to_corners(mesh_);
  result_.dropped += renumber_corners(mesh_, place).faces;
  place_of_ = mesh_.face_corners;
}

void Repairer::split_junctions() {
  // What lies in an edge of a face that is split may be split by it in turn.
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    const std::size_t split = split_at_junctions(mesh_, place_of_, result_.tolerance);
    result_.split += split;
    if (split == 0) break;
  }
}

Result<void> Repairer::turn() {
  const TurnedAlike alike = turn_alike(mesh_, place_of_);
  if (alike.one_sided)
    return Error{Errc::bad_input,
                 "cannot be repaired: its surface has one side only, as a Möbius strip has, so it "
                 "has no inside; cut it open at the edge between " +
                     where(alike.one_sided->first) + " and " + where(alike.one_sided->second) +
                     " where it was made"};
  result_.turned = alike.turned;
  return {};
}

/// Corners that no edge holds together get vertices of their own. The first ones keep the vertex.
void Repairer::separate() {
  const auto corners = static_cast<std::uint32_t>(place_of_.size());
  std::vector<std::uint32_t> each(corners);
  for (std::uint32_t at = 0; at < corners; ++at)
    each[at] = at;
  UnionFind sets(corners);
  stitch(mesh_, place_of_, each, sets);
  std::vector<std::uint32_t> owner(static_cast<std::size_t>(mesh_.vertices.cols()), no_index);
  std::vector<std::uint32_t> vertex_of_set(corners, no_index), copied;
  const auto before = static_cast<std::uint32_t>(mesh_.vertices.cols());
  for (std::uint32_t at = 0; at < corners; ++at) {
    std::uint32_t& vertex = vertex_of_set[sets.find(at)];
    if (vertex == no_index) {
      const std::uint32_t place = place_of_[at];
      vertex = place;
      if (owner[place] != no_index) {
        vertex = before + static_cast<std::uint32_t>(copied.size());
        copied.push_back(place);
      }
      owner[place] = at;
    }
    mesh_.face_corners[at] = vertex;
  }
  result_.separated = copied.size();
  if (copied.empty()) return;
  mesh_.detail.clear();
  const bool coloured = mesh_.look.vertex_colours.cols() > 0;
  const auto more = static_cast<Eigen::Index>(copied.size());
  mesh_.vertices.conservativeResize(3, before + more);
  if (coloured) mesh_.look.vertex_colours.conservativeResize(4, before + more);
  for (Eigen::Index at = 0; at < more; ++at) {
    const std::uint32_t from = copied[static_cast<std::size_t>(at)];
    mesh_.vertices.col(before + at) = mesh_.vertices.col(from).eval();
    if (coloured)
      mesh_.look.vertex_colours.col(before + at) = mesh_.look.vertex_colours.col(from).eval();
  }
}

/// Vertices that became one with another one go, too, but are not counted again.
void Repairer::drop_strays() {
  std::vector<std::uint8_t> keeps(static_cast<std::size_t>(mesh_.vertices.cols()), 0);
  for (const std::uint32_t corner : mesh_.face_corners)
    keeps[corner] = 1;
  const auto gone = static_cast<std::size_t>(std::count(keeps.begin(), keeps.end(), 0));
  keep_vertices(mesh_, keeps);
  result_.stray = gone - std::min(gone, result_.joined);
}

/// What was filled must have got an inside.
Result<void> Repairer::check_volumes() const {
  if (mesh_.face_count() == 0) return {};
  std::vector<std::uint32_t> part_of;
  const std::uint32_t count = number_parts(mesh_, part_of);
  std::vector<double> volume(count, 0.0), area(count, 0.0);
  std::vector<std::uint32_t> first(count, no_index);
  for (std::uint32_t vertex = 0; vertex < part_of.size(); ++vertex)
    if (part_of[vertex] != no_index && first[part_of[vertex]] == no_index)
      first[part_of[vertex]] = vertex;
  for_each_triangle(mesh_, [&](const Triangle& triangle) {
    const std::uint32_t part = part_of[triangle[0]];
    const auto from_first = [&](std::size_t k) -> Eigen::Vector3d {
      return mesh_.vertices.col(triangle[k]) - mesh_.vertices.col(first[part]);
    };
    const Eigen::Vector3d a = from_first(0), b = from_first(1), c = from_first(2);
    volume[part] += a.dot(b.cross(c)) / 6.0;
    area[part] += 0.5 * (b - a).cross(c - a).norm();
  });
  for (std::uint32_t part = 0; part < count; ++part)
    if (!(std::abs(volume[part]) > 1e-9 * std::pow(area[part], 1.5)))
      return Error{Errc::bad_input, "cannot be repaired: its part at " + where(first[part]) +
                                        " has no inside: both of its sides lie in one place; give "
                                        "it a thickness where it was made, or remove it"};
  return {};
}

} // namespace

Result<Repair> repair(const Mesh& mesh, const RepairOptions& options) {
  if (!(mesh.vertices.array().abs() <= largest_repairable).all())
    return Error{Errc::bad_input,
                 "cannot be repaired: it has coordinates beyond 1e60; scale it down"};
  double tolerance = options.tolerance.value_or(default_tolerance * diagonal_of(mesh.vertices));
  // Less than rounding is no length.
  if (mesh.vertices.size() > 0 && tolerance < 1e-15 * mesh.vertices.cwiseAbs().maxCoeff())
    tolerance = 0.0;
  return Repairer(mesh, tolerance).run();
}

std::vector<std::string> lines_of(const Repair& repair) {
  std::vector<std::string> lines;
  const auto add = [&](std::size_t count, const char* did, const char* one, const char* many,
                       const std::string& more) {
    if (count == 0) return;
    lines.push_back(std::string(did) + " " + std::to_string(count) + " " +
                    (count == 1 ? one : many) + more);
  };
  char tolerance[64];
  std::snprintf(tolerance, sizeof tolerance, "%.3g", repair.tolerance);
  add(repair.joined, "joined", "vertex", "vertices",
      std::string(" with others no farther away than ") + tolerance);
  add(repair.dropped, "dropped", "face", "faces",
      " that had fewer than three corners or repeated another");
  add(repair.repeated, "dropped", "corner", "corners", " that repeated the one before in its face");
  add(repair.split, "split an edge at", "vertex", "vertices", " that lay in it");
  add(repair.turned, "turned", "face", "faces", " round");
  add(repair.separated, "separated surfaces that only touched, by", "more vertex", "more vertices",
      "");
  add(repair.filled, "filled", "hole", "holes",
      repair.filled_crossing == 0
          ? ""
          : "; " + std::to_string(repair.filled_crossing) +
                (repair.filled_crossing == 1 ? " lid goes" : " lids go") + " through the model");
  add(repair.stray, "dropped", "vertex", "vertices", " without a face");
  return lines;
}

} // namespace nendo::deform
