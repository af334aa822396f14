#include <nendo/deform/triangles.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "geometry/ear_clipping.hpp"
#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

/// Products of three coordinates must neither overflow nor lose digits (exact_predicates.hpp).
constexpr double max_extent = 1e60;
constexpr double min_extent = 1e-60;

/// Returns the direction of a vector, exactly: a power of two makes its largest coordinate 0.5 to
/// 1. Nothing but zero if it has no direction.
SpacePoint as_direction(const SpacePoint& vector) noexcept {
  const double largest = std::max({std::abs(vector[0]), std::abs(vector[1]), std::abs(vector[2])});
  if (!(largest > 0.0) || !std::isfinite(vector[0] + vector[1] + vector[2])) return {};
  int exponent = 0;
  std::frexp(largest, &exponent);
  return {std::ldexp(vector[0], -exponent), std::ldexp(vector[1], -exponent),
          std::ldexp(vector[2], -exponent)};
}

/// Returns the direction of the polygon's area vector, or zero.
SpacePoint face_normal(const std::vector<SpacePoint>& places) noexcept {
  SpacePoint area{};
  SpacePoint before = places[1] - places[0];
  double extent = std::max({std::abs(before[0]), std::abs(before[1]), std::abs(before[2])});
  for (std::size_t at = 2; at < places.size(); ++at) {
    const SpacePoint here = places[at] - places[0];
    area = area + cross(before, here);
    extent = std::max({extent, std::abs(here[0]), std::abs(here[1]), std::abs(here[2])});
    before = here;
  }
  if (!(extent <= max_extent) || !(extent >= min_extent)) return {};
  return as_direction(area);
}

bool is_none(const SpacePoint& vector) noexcept {
  return vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0;
}

/// Returns whether all triangles of the fan about the first corner face the way of the polygon.
bool is_fan(const std::vector<SpacePoint>& places, const SpacePoint& normal) noexcept {
  for (std::size_t at = 2; at < places.size(); ++at)
    if (turn_about(places[0], places[at - 1], places[at], normal) <= 0) return false;
  return true;
}

} // namespace

struct FaceTriangles::Parts {
  std::vector<SpacePoint> places; ///< of a face's corners
  SpacePoint normal{};            ///< of the face; zero if it has none
  EarClipper clipper;
};

FaceTriangles::FaceTriangles(const Mesh& mesh, const Points& places)
    : mesh_(mesh), places_(places) {}

FaceTriangles::~FaceTriangles() = default;

/// Notes the places of the corners. Returns whether the face has a normal.
bool FaceTriangles::take(std::uint32_t begin, std::uint32_t count) {
  if (!parts_) parts_ = std::make_unique<Parts>();
  parts_->places.resize(count);
  for (std::uint32_t at = 0; at < count; ++at)
    parts_->places[at] = space_point(places_, mesh_.face_corners[begin + at]);
  parts_->normal = face_normal(parts_->places);
  return !is_none(parts_->normal);
}

std::span<const Triangle> FaceTriangles::of_polygon(std::uint32_t begin, std::uint32_t count) {
  some_.clear();
  if (count < 3) return some_;
  const bool has_normal = take(begin, count);
  const bool fan = !has_normal || is_fan(parts_->places, parts_->normal);
  if (fan)
    for (std::uint32_t at = 2; at < count; ++at)
      some_.push_back({0, at - 1, at});
  else
    parts_->clipper.run(parts_->places, parts_->normal, some_);
  for (Triangle& triangle : some_)
    for (std::uint32_t& corner : triangle)
      corner += begin;
  if (!fan || !has_normal)
    std::erase_if(some_, [&](const Triangle& triangle) {
      const std::uint32_t a = mesh_.face_corners[triangle[0]];
      const std::uint32_t b = mesh_.face_corners[triangle[1]];
      const std::uint32_t c = mesh_.face_corners[triangle[2]];
      return a == b || b == c || c == a;
    });
  return some_;
}

bool FaceTriangles::is_convex(std::size_t face) {
  const std::uint32_t begin = mesh_.face_starts[face];
  const std::uint32_t count = mesh_.face_starts[face + 1] - begin;
  if (count < 4 || !take(begin, count)) return true;
  const std::vector<SpacePoint>& places = parts_->places;
  for (std::size_t at = 0; at < count; ++at)
    if (turn_about(places[at], places[(at + 1) % count], places[(at + 2) % count], parts_->normal) <
        0)
      return false;
  return true;
}

std::vector<std::uint32_t> corners_of_triangles(const Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  corners.reserve(mesh.face_corners.size());
  for_each_triangle(mesh, [&](const Triangle& triangle) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  });
  return corners;
}

Mesh with_split_faces(const Mesh& mesh, const Points& places, const std::vector<bool>& is_split) {
  Mesh split = mesh;
  split.face_starts.assign(1, 0);
  split.face_corners.clear();
  split.corner_texcoords.clear();
  for (auto* column : face_columns(split.look))
    column->clear();
  FaceTriangles triangles(mesh, places);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    if (!is_split[face]) {
      for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at)
        append_corner(mesh, at, split);
      end_face(mesh, face, split);
      continue;
    }
    for (const Triangle& triangle : triangles.of(face)) {
      for (const std::uint32_t corner : triangle)
        append_corner(mesh, corner, split);
      end_face(mesh, face, split);
    }
  }
  return split;
}

Mesh with_triangles_of(Mesh mesh, const Points& rest) {
  FaceTriangles now(mesh);
  FaceTriangles before(mesh, rest);
  std::vector<bool> differs(mesh.face_count(), false);
  bool any = false;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto begin = mesh.face_corners.begin() + mesh.face_starts[face];
    const auto end = mesh.face_corners.begin() + mesh.face_starts[face + 1];
    const auto is_new = [&](std::uint32_t vertex) { return vertex >= rest.cols(); };
    if (end - begin < 4 || std::any_of(begin, end, is_new)) continue;
    differs[face] = !std::ranges::equal(now.of(face), before.of(face));
    any = any || differs[face];
  }
  return any ? with_split_faces(mesh, rest, differs) : std::move(mesh);
}

Mesh in_shape(const Mesh& model, Points places) {
  Mesh moved = model;
  moved.vertices = std::move(places);
  return with_triangles_of(std::move(moved), model.vertices);
}

} // namespace nendo::deform
