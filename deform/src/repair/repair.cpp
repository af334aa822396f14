#include <nendo/deform/repair.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <Eigen/Geometry>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/corner_colours.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/triangles.hpp>

#include "cut/cut_assembly.hpp"
#include "mesh/columns.hpp"
#include "repair/steps.hpp"
#include "repair/stitch.hpp"
#include "repair/weld.hpp"

namespace nendo::deform {
namespace {

/// A cube as wide as the tolerance. In double, because coordinates may be large beside it.
using SpaceCell = std::array<double, 3>;

/// The first points of places, by their cells. Two of them are farther apart than the tolerance, so
/// a cell holds few.
class FirstPoints {
public:
  FirstPoints(const Points& points, double tolerance) : points_(points), tolerance_(tolerance) {}

  /// Returns the first point within the tolerance, or the point itself, which then is one.
  std::uint32_t place_of(std::uint32_t point) {
    const SpaceCell own = cell_of(point);
    std::uint32_t found = no_index;
    constexpr std::array offsets{0.0, -1.0, 1.0};
    const auto beside = std::span(offsets).first(tolerance_ > 0.0 ? 3 : 1);
    for (const double x : beside)
      for (const double y : beside)
        for (const double z : beside)
          look({own[0] + x, own[1] + y, own[2] + z}, point, found);
    if (found != no_index) return found;
    cells_[own].push_back(point);
    return point;
  }

private:
  SpaceCell cell_of(std::uint32_t point) const {
    SpaceCell cell;
    for (std::size_t k = 0; k < 3; ++k) {
      const double at = points_(static_cast<Eigen::Index>(k), point);
      cell[k] = tolerance_ > 0.0 ? std::floor(at / tolerance_) : at + 0.0;
    }
    return cell;
  }
  void look(const SpaceCell& cell, std::uint32_t point, std::uint32_t& found) const {
    const auto here = cells_.find(cell);
    if (here == cells_.end()) return;
    for (const std::uint32_t other : here->second)
      if (other < found && (points_.col(other) - points_.col(point)).norm() <= tolerance_)
        found = other;
  }

  const Points& points_;
  double tolerance_;
  std::map<SpaceCell, std::vector<std::uint32_t>> cells_;
};

/// Returns for each point the number of its place: the first of the points before it that lies
/// within the tolerance, among those that are the first of a place, or its own. Only points for
/// which `joins` is not 0 are looked at; all others are their own place. With a tolerance of 0,
/// points must be equal. Allocates.
std::vector<std::uint32_t> near_places(const Points& points, std::span<const std::uint8_t> joins,
                                       double tolerance) {
  FirstPoints first(points, tolerance);
  std::vector<std::uint32_t> places;
  for (std::uint32_t point = 0; point < joins.size(); ++point)
    places.push_back(joins[point] != 0 ? first.place_of(point) : point);
  return places;
}

constexpr double default_tolerance = 1e-5; // of the diagonal
constexpr double largest_repairable = 1e60;

double area_of(FaceTriangles& triangles, const Mesh& mesh, std::uint32_t face) {
  double area = 0.0;
  for (const Triangle& triangle : triangles.of(face)) {
    const auto at = [&](std::size_t k) -> Eigen::Vector3d {
      return mesh.vertices.col(mesh.face_corners[triangle[k]]);
    };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  return area;
}

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
    turn();
    separate();
    drop_strays();
    if (auto filled = fill(); !filled) return filled.error();
    leave_out_flat();
    drop_left_out_vertices();
    if (auto enough = check_rest(); !enough) return enough.error();
    if (const ManifoldCheck check = check_closed_manifold(mesh_); !check)
      return Error{Errc::bad_input, "cannot be repaired: it still " + describe(check, mesh_)};
    result_.turned += turn_outwards(mesh_);
    return std::move(result_);
  }

private:
  /// Faces with fewer than three corners, and corners that repeat the previous one.
  void drop_thin_faces() {
    const DroppedCorners dropped = renumber_corners(mesh_, all_indices(mesh_.vertex_count()));
    result_.dropped += dropped.faces;
    result_.repeated = dropped.corners;
    place_of_ = mesh_.face_corners;
  }
  void drop_doubles() { result_.dropped += drop_double_faces(mesh_, place_of_); }
  /// Corners keep their vertices for now: only places become one. Faces that get thinner than three
  /// places by it go.
  void join_places() {
    const std::vector<std::uint32_t> place =
        near_places(mesh_.vertices, open_vertices(), result_.tolerance);
    const std::vector<std::uint8_t> used = vertices_of_faces(mesh_);
    const Eigen::Matrix4Xf& colours = mesh_.look.vertex_colours;
    bool differ = false;
    for (std::uint32_t vertex = 0; vertex < place.size(); ++vertex)
      if (used[vertex] != 0 && place[vertex] != vertex) {
        ++result_.joined;
        differ =
            differ || (colours.cols() > 0 && colours.col(vertex) != colours.col(place[vertex]));
      }
    if (differ) move_colours_to_corners(mesh_);
    result_.dropped += renumber_corners(mesh_, place).faces;
    place_of_ = mesh_.face_corners;
  }
  void split_junctions() {
    // What lies in an edge of a face that is split may be split by it in turn.
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) {
      const SplitJunctions split = split_at_junctions(mesh_, place_of_, result_.tolerance);
      result_.split += split.count;
      result_.skipped_junctions = result_.skipped_junctions || split.is_too_many;
      if (split.count == 0) break;
    }
  }
  /// Surfaces with one side only are left out, and then the others are turned.
  void turn() {
    TurnedAlike alike = turn_alike(mesh_, place_of_);
    if (alike.one_sided) {
      leave_out(alike.one_sided_faces,
                {alike.one_sided->first,
                 "has one side only, as a Möbius strip has, so it has no inside",
                 "cut it open at the edge between " + place_text(mesh_, alike.one_sided->first) +
                     " and " + place_text(mesh_, alike.one_sided->second) + " where it was made"});
      drop_left_out_faces();
      alike = turn_alike(mesh_, place_of_);
    }
    result_.turned = alike.turned;
  }
  /// Corners that no edge holds together get vertices of their own. The first ones keep the vertex.
  void separate() {
    const auto corners = to_index(place_of_.size());
    UnionFind sets(corners);
    stitch(mesh_, place_of_, all_indices(corners), sets);
    std::vector<std::uint32_t> owner(mesh_.vertex_count(), no_index);
    std::vector<std::uint32_t> vertex_of_set(corners, no_index), copied;
    const auto before = to_index(mesh_.vertex_count());
    for (std::uint32_t at = 0; at < corners; ++at) {
      std::uint32_t& vertex = vertex_of_set[sets.find(at)];
      if (vertex == no_index) {
        const std::uint32_t place = place_of_[at];
        vertex = place;
        if (owner[place] != no_index) {
          vertex = before + to_index(copied.size());
          copied.push_back(place);
        }
        owner[place] = at;
      }
      mesh_.face_corners[at] = vertex;
    }
    result_.separated = copied.size();
    if (copied.empty()) return;
    mesh_.detail.clear();
    append_columns(columns_at(mesh_.vertices, copied), mesh_.vertices);
    append_columns(columns_at(mesh_.look.vertex_colours, copied), mesh_.look.vertex_colours);
  }
  /// Vertices that became one with another one, or whose faces were left out, also go, but are not
  /// counted again.
  void drop_strays() {
    const std::vector<std::uint8_t> keeps = vertices_of_faces(mesh_);
    const auto gone = static_cast<std::size_t>(std::count(keeps.begin(), keeps.end(), 0));
    keep_vertices(mesh_, keeps);
    result_.stray = gone - std::min(gone, result_.joined + left_out_vertices_);
  }
  Result<void> fill() {
    const auto filled = fill_holes(mesh_);
    if (!filled) return filled.error();
    result_.filled = filled->count;
    result_.filled_crossing = filled->crossing;
    leave_out_parts(filled->unfilled);
    return {};
  }
  /// What was filled must have got an inside.
  void leave_out_flat() {
    if (mesh_.face_count() == 0) return;
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
    std::vector<UnfilledPart> flat;
    for (std::uint32_t part = 0; part < count; ++part)
      if (!(std::abs(volume[part]) > 1e-9 * std::pow(area[part], 1.5)))
        flat.push_back({first[part], "has no inside: both of its sides lie in one place",
                        "give it a thickness where it was made"});
    leave_out_parts(flat);
  }
  /// What was separated from them was not, as far as users see.
  void drop_left_out_vertices() {
    if (result_.left_out.empty()) return;
    const std::vector<std::uint8_t> used = vertices_of_faces(mesh_);
    const std::vector<std::uint32_t> place = exact_places(mesh_.vertices);
    std::vector<std::uint8_t> stays(place.size(), 0);
    for (std::size_t vertex = 0; vertex < used.size(); ++vertex)
      if (used[vertex] != 0) stays[place[vertex]] = 1;
    for (std::size_t vertex = 0; vertex < used.size(); ++vertex)
      if (used[vertex] == 0 && stays[place[vertex]] != 0 && result_.separated > 0)
        --result_.separated;
    keep_vertices(mesh_, used);
  }
  /// A model of which only trifles would be left is none.
  Result<void> check_rest() const {
    if (result_.left_out.empty()) return {};
    double rest = 0.0;
    FaceTriangles triangles(mesh_);
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face)
      rest += area_of(triangles, mesh_, face);
    if (rest > left_out_area_) return {};
    const LeftOut& first = result_.left_out.front();
    return Error{Errc::bad_input, "cannot be repaired: its part at " + first.where + " " +
                                      first.why + "; " + first.remedy + ", or remove it"};
  }
  void leave_out_parts(const std::vector<UnfilledPart>& parts) {
    if (parts.empty()) return;
    std::vector<std::uint32_t> part_of;
    std::vector<std::vector<std::uint32_t>> faces_of(number_parts(mesh_, part_of));
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face)
      faces_of[part_of[mesh_.corners_of(face)[0]]].push_back(face);
    for (const UnfilledPart& part : parts)
      leave_out(faces_of[part_of[part.vertex]], part);
    drop_left_out_faces();
  }
  /// What is alike but for its place becomes one note.
  void leave_out(std::span<const std::uint32_t> faces, const UnfilledPart& how) {
    if (keeps_.empty()) keeps_.assign(mesh_.face_count(), 1);
    FaceTriangles triangles(mesh_);
    for (const std::uint32_t face : faces) {
      keeps_[face] = 0;
      left_out_area_ += area_of(triangles, mesh_, face);
    }
    auto known = std::find_if(result_.left_out.begin(), result_.left_out.end(),
                              [&](const LeftOut& left) { return left.why == how.why; });
    if (known == result_.left_out.end())
      known = result_.left_out.insert(known,
                                      {0, 0, place_text(mesh_, how.vertex), how.why, how.remedy});
    ++known->parts;
    known->faces += faces.size();
  }
  void drop_left_out_faces() {
    const auto count_used = [&] {
      const std::vector<std::uint8_t> used = vertices_of_faces(mesh_);
      return static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
    };
    left_out_vertices_ += count_used();
    keep_faces(mesh_, keeps_, place_of_);
    left_out_vertices_ -= count_used();
    keeps_.clear();
  }
  /// Vertices of edges that have not just two faces.
  std::vector<std::uint8_t> open_vertices() const {
    std::vector<std::uint8_t> open(mesh_.vertex_count(), 0);
    for_each_edge(placed_edges(mesh_, mesh_.face_corners), [&](std::span<const PlacedEdge> sides) {
      if (sides.size() != 2) open[sides[0].low] = open[sides[0].high] = 1;
    });
    return open;
  }

  Repair result_;
  Mesh& mesh_;
  std::vector<std::uint32_t> place_of_; ///< the first vertex of each corner's place
  std::vector<std::uint8_t> keeps_;     ///< one per face, while some are left out
  double left_out_area_ = 0.0;
  std::size_t left_out_vertices_ = 0; ///< that are in the mesh still
};

std::string line_of(const LeftOut& left) {
  std::string line =
      "left out " + std::to_string(left.faces) + (left.faces == 1 ? " face" : " faces");
  if (left.parts > 1) line += " in " + std::to_string(left.parts) + " parts, the first";
  return line + " at " + left.where + ": it " + left.why + "; " + left.remedy + " if it is wanted";
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
  for (const LeftOut& left : repair.left_out)
    lines.push_back(line_of(left));
  if (repair.skipped_junctions)
    lines.emplace_back("has too many open edges to look for vertices that lie in them, so where "
                       "such vertices are it may have got thin slits or lids; join its vertices "
                       "with a greater --tolerance, or close it where it was made");
  return lines;
}

} // namespace nendo::deform
