#pragma once
// A closed surface whose triangles change: edges are split, collapsed and flipped. Attributes
// follow, and each operation is refused where it would fold the surface, change its topology, or
// tear a border between materials, names or texture islands.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/refinement.hpp>

#include "join/triangle_surface.hpp"

namespace nendo::deform {

struct CollapseLimits {
  double longest = 0.0;      ///< no edge becomes longer, unless one around the point was
  double thin = 0.0;         ///< the normals of faces that are lower say nothing
  double least_cosine = 0.5; ///< of the angle by which a face's normal turns
};

class LiveSurface {
public:
  /// The surface must be closed and two-manifold (closed_manifold.hpp). Allocates.
  explicit LiveSurface(TriangleSurface surface);

  // Edge 3 f + k goes from corner k of face f to its next corner; its twin runs back.
  static std::uint32_t next(std::uint32_t edge) noexcept {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
  }
  static std::uint32_t last(std::uint32_t edge) noexcept {
    return edge % 3 == 0 ? edge + 2 : edge - 1;
  }
  std::uint32_t from(std::uint32_t edge) const noexcept {
    return surface_.faces[edge / 3][edge % 3];
  }
  std::uint32_t to(std::uint32_t edge) const noexcept { return from(next(edge)); }
  std::uint32_t twin(std::uint32_t edge) const noexcept { return twins_[edge]; }

  /// The points, those that are gone as well.
  std::size_t point_count() const noexcept { return surface_.points.size(); }
  const SpacePoint& point(std::uint32_t number) const noexcept { return surface_.points[number]; }
  void move(std::uint32_t number, const SpacePoint& to) noexcept { surface_.points[number] = to; }
  /// What refining must know of each point; none at all, if it was not given.
  const std::vector<VertexDetail>& detail() const noexcept { return surface_.detail; }
  void set_detail(std::vector<VertexDetail> detail);
  bool has_point(std::uint32_t number) const noexcept { return edge_at_[number] != no_index; }
  bool has_face(std::uint32_t face) const noexcept { return !gone_[face]; }
  std::size_t face_count() const noexcept { return surface_.faces.size(); }
  double edge_length(std::uint32_t edge) const noexcept {
    return distance_between(point(from(edge)), point(to(edge)));
  }
  /// Calls visit(edge) for the edges that begin at a point, one for each neighbour.
  template <class Visit>
  void visit_edges(std::uint32_t number, const Visit& visit) const {
    const std::uint32_t first = edge_at_[number];
    std::uint32_t edge = first;
    do {
      const std::uint32_t after = twins_[last(edge)];
      visit(edge);
      edge = after;
    } while (edge != first);
  }
  /// Returns the edge from one point to another, or no_index.
  std::uint32_t edge_between(std::uint32_t one, std::uint32_t other) const;
  /// Faces on both sides differ in material or names, or texture is cut there.
  bool is_border(std::uint32_t edge) const noexcept;

  /// Puts a new point into the middle of an edge, and returns its number: point_count() before.
  std::uint32_t split(std::uint32_t edge);
  /// Lets the edge's end go into its beginning, which stays in its place. Returns false if it is
  /// refused.
  bool collapse(std::uint32_t edge, const CollapseLimits& limits);
  /// Turns the edge in its two faces if that makes the worse of them fairer. Returns false if it is
  /// refused.
  bool flip(std::uint32_t edge);

  /// Does what was done before to a surface of the same faces, wherever its points are. Returns
  /// false, and does nothing, if that cannot be done to this one.
  bool repeat(const EdgeOperation& operation);
  /// Appends each operation from now on to that list, which must live as long.
  void note_in(std::vector<EdgeOperation>* list) noexcept { noted_ = list; }

  /// Returns the surface without what is gone, points and faces in their order. `numbers`, if not
  /// null, becomes each point's new number, or no_index. The object is empty afterwards.
  TriangleSurface take(std::vector<std::uint32_t>* numbers = nullptr);

private:
  std::uint32_t texture(std::uint32_t edge) const noexcept {
    return surface_.face_texture[edge / 3][edge % 3];
  }
  void set(std::uint32_t edge, std::uint32_t corner, std::uint32_t texture) noexcept;
  void link(std::uint32_t edge, std::uint32_t twin) noexcept {
    twins_[edge] = twin;
    twins_[twin] = edge;
  }
  std::uint32_t texture_or_none(std::uint32_t edge) const noexcept {
    return surface_.face_texture.empty() ? no_index : texture(edge);
  }
  std::uint32_t middle_texture(std::uint32_t edge);
  std::uint32_t add_face(std::uint32_t like);
  SpacePoint area_of(std::uint32_t face) const noexcept;
  void add_attributes(std::uint32_t a, std::uint32_t b);
  void note(EdgeOperation::Kind kind, std::uint32_t a, std::uint32_t b) {
    if (noted_ != nullptr) noted_->push_back({kind, a, b});
  }
  bool can_collapse(std::uint32_t edge) const;
  void collapse_now(std::uint32_t edge);
  bool makes_fairer(std::uint32_t edge) const;
  bool can_flip(std::uint32_t edge) const;
  void flip_now(std::uint32_t edge);
  bool keeps_links(std::uint32_t edge) const;
  bool keeps_borders(std::uint32_t edge) const;
  bool keeps_shape(std::uint32_t edge, const CollapseLimits& limits) const;

  TriangleSurface surface_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> edge_at_; ///< of each point some edge that begins there
  std::vector<char> gone_;             ///< of each face
  std::vector<EdgeOperation>* noted_ = nullptr;
};

/// From 0 for a triangle without area to 1 for an equilateral one.
double triangle_fairness(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept;

} // namespace nendo::deform
