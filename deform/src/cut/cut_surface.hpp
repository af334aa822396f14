#pragma once
// The faces of a model that a blade crosses, as triangles: made finer where the blade bends, then
// crossed. All other faces stay as they are.
//
// This is no SurfaceMesh (mesh/surface_mesh.hpp). A plane needs no neighbours of triangles,
// and finding them takes longer than finding the crossings. A wire needs a face's triangles only
// when one of them is halved beside it, and the order in which faces become triangles numbers the
// crossings: SurfaceMesh::split() needs both triangles before. And where diagonals of two faces
// have the same ends, one edge of a triangle has no twin; then maps by the ends of edges still find
// the crossing that triangles share, and cross() refuses what does not close.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/triangles.hpp>

#include "cut/blade.hpp"
#include "mesh/surface_mesh.hpp"
#include "mesh/texture_point.hpp"

namespace nendo::deform {

/// A triangle that is part of a face.
struct Piece {
  std::array<std::uint32_t, 3> vertices;
  std::array<std::uint32_t, 3> texcoords; ///< unused if the model has none
  std::uint32_t face;
};

/// A piece that the blade crosses. Its lone corner lies on one side, the two others on the other.
struct CrossedPiece {
  std::uint32_t piece;
  std::uint32_t lone;          ///< 0 to 2
  std::uint32_t after, before; ///< crossings of the edges that begin and end at the lone corner
};

/// The effect of a blade that is displaced by `blade_offset` on a model.
class CutSurface {
public:
  /// `sides` has Blade::side() of all vertices. No vertex may be just `blade_offset` above the
  /// blade. The places `rest` decide about triangles. All arguments must outlive this.
  CutSurface(const Mesh& mesh, const Points& rest, const HalfEdges& edges, const Blade& blade,
             double blade_offset, const std::vector<double>& sides);

  /// Halves edges until a blade that bends is nowhere farther than `sag` from the chord in which it
  /// crosses a triangle. Returns false if that takes too many vertices.
  bool refine(double sag);
  /// Finds the crossings, and the closed loops that they form. Returns false if there are no such
  /// loops, because triangles of several faces touch along one line.
  bool cross();

  bool is_active(std::size_t face) const noexcept { return active_[face] != 0; }
  /// Returns whether refine() has split triangles of an active face.
  bool is_split(std::size_t face) const noexcept { return active_[face] == 2; }
  bool is_up(std::uint32_t vertex) const noexcept { return sides_[vertex] > blade_offset_; }
  double above(std::uint32_t vertex) const noexcept { return sides_[vertex] - blade_offset_; }
  SpacePoint point(std::uint32_t vertex) const noexcept;
  std::uint32_t vertex_count() const noexcept { return to_index(sides_.size()); }
  const std::vector<Piece>& pieces() const noexcept { return pieces_; }
  /// The vertices that refine() added, after those of the mesh.
  const std::vector<CutVertex>& added() const noexcept { return added_; }
  const std::vector<CrossedPiece>& crossed() const noexcept { return crossed_; }
  const std::vector<CutVertex>& crossings() const noexcept { return crossings_; }
  const std::vector<SpacePoint>& crossing_points() const noexcept { return crossing_points_; }
  /// Loops of crossings, and each crossing's loop.
  const std::vector<std::vector<std::uint32_t>>& loops() const noexcept { return loops_; }
  const std::vector<std::uint32_t>& loop_of() const noexcept { return loop_of_; }
  /// Texture coordinates: the mesh's, and those of new corners after them.
  const std::vector<TexturePoint>& new_texcoords() const noexcept { return new_texcoords_; }
  /// Returns the index of a texture coordinate between two others; one that
  /// was made for this point before is used again.
  std::uint32_t texcoord_between(std::uint64_t point, std::uint32_t from, std::uint32_t to,
                                 double part);

private:
  bool is_crossed(const Piece& piece) const noexcept;
  std::uint32_t lone_corner(const Piece& piece) const noexcept;
  void activate(std::uint32_t face);
  void activate_near_bends();
  void index(std::uint32_t piece);
  double sag_of(const Piece& piece) const noexcept;
  std::uint32_t piece_at(std::uint32_t from, std::uint32_t to);
  void halve(std::uint32_t from, std::uint32_t to, std::vector<std::uint32_t>& changed);
  void split(std::uint32_t from, std::uint32_t to, std::uint32_t middle, double part,
             std::vector<std::uint32_t>& changed);
  std::uint32_t crossing(std::uint32_t from, std::uint32_t to);
  double crossing_part(std::uint32_t from, std::uint32_t to) const noexcept;
  bool link_loops();
  TexturePoint texcoord(std::uint32_t index) const noexcept;

  const Mesh& mesh_;
  FaceTriangles triangles_;
  const HalfEdges& edges_;
  const Blade& blade_;
  double blade_offset_;
  std::vector<double> sides_;
  std::vector<SpacePoint> added_points_;
  std::vector<CutVertex> added_;
  std::vector<std::uint8_t> active_; ///< per face; 2: its triangles were split
  std::vector<Piece> pieces_;
  std::unordered_map<std::uint64_t, std::uint32_t> piece_of_edge_;
  std::unordered_map<std::uint64_t, std::uint32_t> crossing_of_edge_;
  std::vector<CrossedPiece> crossed_;
  std::vector<CutVertex> crossings_;
  std::vector<SpacePoint> crossing_points_;
  std::vector<std::uint32_t> loop_of_;
  std::vector<std::vector<std::uint32_t>> loops_;
  struct PointTexcoord {
    std::uint32_t from, to, index;
  };
  std::unordered_map<std::uint64_t, std::vector<PointTexcoord>> texcoords_of_point_;
  std::vector<TexturePoint> new_texcoords_;
};

} // namespace nendo::deform
