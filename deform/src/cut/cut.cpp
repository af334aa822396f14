#include <nendo/deform/cut.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/triangles.hpp>

#include "cut/cut_assembly.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/triangle_meeting.hpp"
#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

/// The triangles of one side of the cut.
struct CutSide {
  std::vector<Corners> triangles; ///< pieces of crossed faces, and then cut faces
  std::size_t pieces = 0;
  std::vector<Corners> near; ///< faces that may meet cut faces
};

Corners corners_of_face(const Mesh& mesh, std::size_t face) noexcept {
  const std::uint32_t begin = mesh.face_starts[face];
  return {mesh.face_corners[begin], mesh.face_corners[begin + 1], mesh.face_corners[begin + 2]};
}

class CutCheck {
public:
  CutCheck(const CutAssembly& assembly, const CutSurface& surface, const Points& rest, double reach)
      : assembly_(assembly), mesh_(assembly.mesh), rest_(rest), surface_(surface), reach_(reach),
        first_added_(static_cast<std::uint32_t>(mesh_.vertex_count() - assembly.added.size())) {}
  /// The cut faces of both sides lie in the same places, so they are compared among themselves only
  /// on the upper side.
  bool is_sound(bool up) const {
    const CutSide side = side_of(up);
    const std::vector<Corners>& triangles = side.triangles;
    const BoxTree tree(points_, triangles);
    const auto meets = [&](const Corners& triangle, const auto& is_asked) {
      const SpaceBox box = box_around(points_, triangle);
      return tree.any([&](const SpaceBox& other) { return meet(box, other); },
                      [&](std::uint32_t other) {
                        return is_asked(other) &&
                               triangles_meet(points_, triangle, triangles[other]);
                      });
    };
    for (std::uint32_t piece = 0; piece < side.pieces; ++piece)
      if (meets(triangles[piece], [&](std::uint32_t other) { return other > piece; })) return false;
    for (const Corners& triangle : side.near)
      if (meets(triangle, [&](std::uint32_t other) { return other >= side.pieces; })) return false;
    if (!up) return true;
    for (auto face = static_cast<std::uint32_t>(side.pieces); face < triangles.size(); ++face) {
      const Corners& corner = triangles[face];
      if (is_degenerate(points_[corner[0]], points_[corner[1]], points_[corner[2]])) return false;
      if (reach_ == 0.0 && is_inner(triangles[face])) continue;
      const bool bad = meets(triangles[face], [&](std::uint32_t other) {
        return other >= side.pieces && other != face;
      });
      if (bad) return false;
    }
    return true;
  }

private:
  CutSide side_of(bool up) const {
    CutSide side;
    for (const std::uint32_t face : assembly_.cut_pieces)
      if (is_up(face) == up) side.triangles.push_back(corners_of_face(mesh_, face));
    side.pieces = side.triangles.size();
    const std::size_t half = (mesh_.face_count() - assembly_.first_cut_face) / 2;
    const std::size_t first = assembly_.first_cut_face + (up ? 0 : half);
    for (std::size_t face = first; face < first + half; ++face)
      side.triangles.push_back(corners_of_face(mesh_, face));
    // A plane has all faces that it does not cross on one side, far beyond rounding.
    if (reach_ > 0.0) add_near(up, side.near);
    return side;
  }
  /// A piece has at least one corner that was there before.
  bool is_up(std::uint32_t face) const noexcept {
    for (const std::uint32_t corner : corners_of_face(mesh_, face))
      if (corner < surface_.vertex_count()) return surface_.is_up(corner);
    return false;
  }
  void add_near(bool up, std::vector<Corners>& triangles) const {
    const std::uint32_t old = surface_.vertex_count();
    FaceTriangles of_faces(mesh_, rest_);
    for (std::size_t face = 0; face < assembly_.first_cut_face; ++face) {
      const auto corners = mesh_.corners_of(face);
      double nearest = std::numeric_limits<double>::infinity();
      double longest = 0.0;
      bool belongs = true;
      for (const std::uint32_t corner : corners) {
        belongs = corner < old && surface_.is_up(corner) == up;
        if (!belongs) break;
        nearest = std::min(nearest, std::abs(surface_.above(corner)));
        const SpacePoint edge = points_[corner] - points_[corners[0]];
        longest = std::max(longest, dot(edge, edge));
      }
      if (!belongs || nearest > reach_ + 1.5 * std::sqrt(longest)) continue;
      for (const auto& [a, b, c] : of_faces.of(face))
        triangles.push_back({mesh_.face_corners[a], mesh_.face_corners[b], mesh_.face_corners[c]});
    }
  }
  /// Cut faces of a plane that do not touch its rim lie amid other cut faces of the same plane.
  bool is_inner(const Corners& triangle) const noexcept {
    return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
      return assembly_.added[corner - first_added_].from == no_index;
    });
  }

  const CutAssembly& assembly_;
  const Mesh& mesh_;
  const Points& rest_; ///< places of the old vertices, which are all vertices of uncut faces
  const CutSurface& surface_;
  double reach_; ///< no face whose corners are all farther from the blade can meet cut faces
  std::uint32_t first_added_;
  std::vector<SpacePoint> points_ = space_points(mesh_.vertices);
};

/// Returns true if no cut face and no piece of a crossed face meets another of these, or a face
/// beside them on its side of the cut, but at shared corners and edges. `reach` is how far cut
/// faces may lie from the blade: 0 for a plane. The places `rest` decide about triangles of faces
/// that are not cut.
bool is_sound(const CutAssembly& assembly, const CutSurface& surface, const Points& rest,
              double reach) {
  const CutCheck check(assembly, surface, rest, reach);
  return check.is_sound(true) && check.is_sound(false);
}

/// The exact predicates need that no product of coordinates overflows or loses digits.
constexpr double largest_size = 1e60;
constexpr double smallest_size = 1e-60;
constexpr std::uint32_t max_attempts = 8;

bool is_fit(const Eigen::Vector3d& vector) noexcept {
  return (vector.array().abs() <= largest_size).all();
}

/// Returns the offsets by which the blade may be displaced, the widest gap between vertices first.
/// `sides` has the vertices' heights.
std::vector<double> gaps_within(const std::vector<double>& sides, double band) {
  std::vector<double> near{-band, band};
  for (const double side : sides)
    if (std::abs(side) < band) near.push_back(side);
  std::sort(near.begin(), near.end());
  std::vector<std::pair<double, double>> gaps; // minus the width, the place
  for (std::size_t at = 1; at < near.size(); ++at)
    gaps.push_back({near[at - 1] - near[at], near[at - 1] / 2.0 + near[at] / 2.0});
  // Gaps of nearly one width are taken in order, so that rounding does not choose.
  std::stable_sort(gaps.begin(), gaps.end(), [&](const auto& a, const auto& b) {
    return std::round(a.first / band * 1e6) < std::round(b.first / band * 1e6);
  });
  std::vector<double> places;
  for (const auto& [width, place] : gaps)
    if (width < -1e-4 * band || places.empty()) places.push_back(place);
  return places;
}

/// The blade's displacement in an attempt, counted from 0. The band grows threefold each time. The
/// first attempts take the widest gap; those after every second one take another gap or another
/// place.
double offset_of_attempt(const std::vector<double>& sides, double diagonal, std::uint32_t attempt) {
  const double band = 1e-6 * diagonal * std::pow(3.0, attempt);
  const std::vector<double> places = gaps_within(sides, band);
  if (attempt == 0) return places.front();
  if (places.size() > 1) return places[attempt % places.size()];
  // One gap only: there is no vertex near, so any place in it will do.
  return band * (attempt % 2 == 1 ? 0.37 : -0.61);
}

/// Mean length of the edges that a blade crosses, or of all if it crosses none.
double edge_length_at(const Mesh& mesh, const HalfEdges& edges, const std::vector<double>& sides,
                      double blade_offset) {
  const auto point = [&](std::uint32_t corner) {
    return space_point(mesh.vertices, mesh.face_corners[corner]);
  };
  const auto is_up = [&](std::uint32_t corner) {
    return sides[mesh.face_corners[corner]] > blade_offset;
  };
  const auto mean = [&](const auto& counts) {
    double total = 0.0;
    std::size_t count = 0;
    for (std::uint32_t at = 0; at < mesh.face_corners.size(); ++at) {
      if (!counts(at)) continue;
      total += length_of(point(edges.next[at]) - point(at));
      ++count;
    }
    return count > 0 ? total / static_cast<double>(count) : 0.0;
  };
  const double crossed = mean([&](std::uint32_t at) { return is_up(at) != is_up(edges.next[at]); });
  return crossed > 0.0 ? crossed : mean([](std::uint32_t) { return true; });
}

enum class Outcome { cut, again, refused };

/// Tries gap after gap.
class Cutter {
public:
  Cutter(const Mesh& mesh, const Blade& blade, const CutOptions& options)
      : mesh_(mesh), rest_(options.rest != nullptr ? *options.rest : mesh.vertices), blade_(blade),
        options_(options) {}
  Result<CutModel> run() {
    if (const auto fine = check(); !fine) return fine.error();
    const auto vertices = mesh_.vertex_count();
    sides_.resize(vertices);
    for (std::size_t vertex = 0; vertex < vertices; ++vertex)
      sides_[vertex] = blade_.side(space_point(mesh_.vertices, vertex));
    faces_inwards_ = volume_of(mesh_) < 0.0;
    edge_ = options_.edge > 0.0
                ? options_.edge
                : edge_length_at(mesh_, edges_, sides_, offset_of_attempt(sides_, diagonal_, 0));
    // A bend needs edges that can follow it; and no cut needs more than some 100,000 faces.
    if (blade_.bends()) edge_ = std::min(edge_, diagonal_ / 40.0);
    edge_ = std::max(edge_, diagonal_ / 400.0);
    for (std::uint32_t number = 0; number < max_attempts; ++number) {
      blade_offset_ = offset_of_attempt(sides_, diagonal_, number);
      result_ = {};
      result_.attempts = number + 1;
      result_.blade_offset = blade_offset_;
      const Outcome outcome = attempt();
      if (outcome == Outcome::cut) return std::move(result_);
      if (outcome == Outcome::refused) return error_;
    }
    return Error{Errc::failed,
                 "cannot be cut here: its surface, or the blade, passes through itself"};
  }

private:
  Result<void> check() {
    diagonal_ = diagonal_of(mesh_.vertices);
    if (!(mesh_.vertices.array().abs() <= largest_size).all() || !(diagonal_ >= smallest_size))
      return Error{Errc::bad_input, "has coordinates that are too large, or no size"};
    const auto vertices = mesh_.vertex_count();
    edges_ = half_edges_of(mesh_.face_starts, mesh_.face_corners, vertices);
    ManifoldCheck closed = check_closed_manifold(mesh_.face_starts, mesh_.face_corners, edges_);
    if (closed.fault == ManifoldFault::repeated_corner) closed = check_closed_manifold(mesh_);
    if (!closed) return Error{Errc::bad_input, describe(closed, mesh_)};
    return {};
  }
  Outcome attempt() {
    CutSurface surface(mesh_, rest_, edges_, blade_, blade_offset_, sides_);
    if (!surface.refine(0.02 * edge_))
      return refuse("cannot be cut here: the blade bends too often for its size");
    if (!surface.cross()) return Outcome::again;
    if (!choose_loops(surface))
      return refuse(surface.loops().empty() ? "is not touched by the blade"
                                            : "is not cut: the blade does not go through");
    // Loops that turn out not to part anything are left, and then everything is made again.
    for (std::size_t round = 0; round <= surface.loops().size(); ++round) {
      if (const Outcome outcome = make_cap_of(surface); outcome != Outcome::cut) return outcome;
      const ChosenCut chosen{mesh_,  blade_,          blade_offset_,  diagonal_,
                             keeps_, std::move(cap_), faces_inwards_, options_};
      CutAssembly assembly = assemble(chosen, surface);
      result_.parts = number_parts(assembly.mesh, result_.part_of_vertex);
      if (drop_rings(surface, assembly)) {
        if (std::count(keeps_.begin(), keeps_.end(), 1) == 0)
          return refuse("is not cut: the blade opens a ring of it, but no part comes off");
        continue;
      }
      if (!is_sound(assembly, surface, rest_, blade_.bends() ? 0.5 * edge_ : 0.0))
        return Outcome::again;
      if (!check_closed_manifold(assembly.mesh)) return Outcome::again;
      result_.mesh = std::move(assembly.mesh);
      result_.added = std::move(assembly.added);
      result_.first_cut_face = assembly.first_cut_face;
      result_.loops = static_cast<std::uint32_t>(std::count(keeps_.begin(), keeps_.end(), 1));
      result_.uncut_loops = to_index(keeps_.size()) - result_.loops;
      return Outcome::cut;
    }
    return Outcome::again;
  }
  /// Takes the loops that lie within the blade. Returns false if there is none.
  bool choose_loops(const CutSurface& surface) {
    keeps_.clear();
    for (const auto& loop : surface.loops())
      keeps_.push_back(std::all_of(loop.begin(), loop.end(),
                                   [&](std::uint32_t crossing) {
                                     return blade_.covers(surface.crossing_points()[crossing]);
                                   })
                           ? 1
                           : 0);
    return std::count(keeps_.begin(), keeps_.end(), 1) > 0;
  }
  Outcome make_cap_of(const CutSurface& surface) {
    for (;;) {
      std::vector<CapLoop> loops;
      std::vector<std::uint32_t> numbers;
      for (std::uint32_t number = 0; number < keeps_.size(); ++number) {
        if (keeps_[number] == 0) continue;
        numbers.push_back(number);
        CapLoop& loop = loops.emplace_back();
        loop.crossings = surface.loops()[number];
        for (const std::uint32_t crossing : loop.crossings)
          loop.places.push_back(blade_.chart(surface.crossing_points()[crossing]));
      }
      if (loops.empty()) return refuse("is not cut: the blade does not go through");
      cap_ = make_cap(loops, to_index(surface.crossings().size()), {edge_, blade_.bends()});
      if (cap_.fault != PlaneFault::none) return Outcome::again;
      if (!drop_wrong_sides(cap_, numbers)) return Outcome::cut;
      if (!blade_.bends())
        return refuse(
            "has parts that face inwards, which `nendo repair IN --out OUT` turns, or lies "
            "inside itself");
    }
  }
  /// Of a hollow whose outer rim is not cut the inside would be filled. Such loops are left whole.
  bool drop_wrong_sides(const Cap& cap, const std::vector<std::uint32_t>& loops) {
    bool dropped = false;
    for (std::size_t at = 0; at < loops.size(); ++at)
      if ((cap.on_left[at] != 0) == faces_inwards_) {
        keeps_[loops[at]] = 0;
        dropped = true;
      }
    return dropped;
  }
  /// Where both sides of a cut belong to one part, nothing comes off, and two faces would lie in
  /// one place. Such loops are left whole.
  bool drop_rings(const CutSurface& surface, const CutAssembly& assembly) {
    bool dropped = false;
    for (std::size_t number = 0; number < keeps_.size(); ++number) {
      if (keeps_[number] == 0) continue;
      const std::uint32_t up = assembly.crossing_vertices[surface.loops()[number].front()];
      if (result_.part_of_vertex[up] != result_.part_of_vertex[up + 1]) continue;
      keeps_[number] = 0;
      dropped = true;
    }
    return dropped;
  }
  Outcome refuse(std::string why) {
    error_ = Error{Errc::failed, std::move(why)};
    return Outcome::refused;
  }

  const Mesh& mesh_;
  const Points& rest_;
  const Blade& blade_;
  const CutOptions& options_;
  HalfEdges edges_;
  std::vector<double> sides_;
  double diagonal_ = 0.0;
  double edge_ = 0.0;
  bool faces_inwards_ = false;
  double blade_offset_ = 0.0;
  std::vector<std::uint8_t> keeps_;
  Cap cap_;
  CutModel result_;
  Error error_;
};

} // namespace

Result<CutModel> cut_model(const Mesh& mesh, const CutPlane& plane, const CutOptions& options) {
  const double length = plane.normal.stableNorm();
  if (!is_fit(plane.point) || !is_fit(plane.normal) || !(length > 0.0))
    return Error{Errc::usage,
                 "cannot be cut by this plane: its normal is zero, or a number too large"};
  const PlaneBlade blade(space_point(plane.point),
                         space_point(Eigen::Vector3d(plane.normal / length)));
  return Cutter(mesh, blade, options).run();
}

Result<CutModel> cut_model(const Mesh& mesh, const CutWire& wire, const CutOptions& options) {
  const double least = 1e-6 * diagonal_of(mesh.vertices);
  std::vector<WireEnds> places;
  for (const WirePlace& place : wire.places) {
    if (!is_fit(place.from) || !is_fit(place.to) || !((place.to - place.from).norm() > least))
      return Error{
          Errc::usage,
          "cannot be cut by this wire: at one place it has no length, or a number too large"};
    const WireEnds ends{space_point(place.from), space_point(place.to)};
    const auto middle = [](const WireEnds& of) { return between(of.from, of.to, 0.5); };
    // A wire that rests sweeps nothing.
    if (!places.empty() && !(length_of(middle(ends) - middle(places.back())) > least)) continue;
    places.push_back(ends);
  }
  if (places.size() < 2) return Error{Errc::usage, "cannot be cut by this wire: it does not move"};
  const WireBlade blade(places);
  return Cutter(mesh, blade, options).run();
}

double volume_of(const Mesh& mesh) {
  if (mesh.vertices.cols() == 0) return 0.0;
  // About a point in the model, so that few digits cancel.
  const Box box = finite_box_of(mesh.vertices);
  const SpacePoint origin = space_point(Eigen::Vector3d(box.lowest / 2.0 + box.highest / 2.0));
  const auto from_origin = [&](std::uint32_t vertex) {
    return space_point(mesh.vertices, vertex) - origin;
  };
  double sum = 0.0;
  for_each_triangle(mesh, [&](const Triangle& at) {
    sum += dot(from_origin(at[0]), cross(from_origin(at[1]), from_origin(at[2])));
  });
  return sum / 6.0;
}

} // namespace nendo::deform
