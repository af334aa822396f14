#include "join/live_surface.hpp"

#include <algorithm>
#include <numbers>

namespace nendo::deform {
namespace {

/// Two faces whose normals differ by more than 32 degrees are a feature, and are not flipped.
constexpr double min_flat_cosine = 0.85;
/// The normal of a needle says little: its neighbours' decide.
constexpr double needle = 1e-3;
/// Below it a triangle is not made worse.
constexpr double fair_enough = 0.25;
/// A flip that gains less may be undone by the next one.
constexpr double min_gain = 1.02;

/// The least height of a triangle.
double height_of(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept {
  const double longest =
      std::max({distance_between(a, b), distance_between(b, c), distance_between(c, a)});
  return longest > 0.0 ? length_of(area_vector(a, b, c)) / longest : 0.0;
}

double cosine(const SpacePoint& a, const SpacePoint& b) noexcept {
  const double lengths = length_of(a) * length_of(b);
  return lengths > 0.0 ? dot(a, b) / lengths : -1.0;
}

} // namespace

double triangle_fairness(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept {
  const SpacePoint ab = b - a;
  const SpacePoint bc = c - b;
  const SpacePoint ca = a - c;
  const double squares = dot(ab, ab) + dot(bc, bc) + dot(ca, ca);
  return squares > 0.0 ? 2.0 * std::numbers::sqrt3 * length_of(cross(ab, ca)) / squares : 0.0;
}

LiveSurface::LiveSurface(TriangleSurface surface)
    : SurfaceMesh(std::move(surface.faces), surface.points.size()), surface_(std::move(surface)) {}

void LiveSurface::set_detail(std::vector<VertexDetail> detail) {
  surface_.detail = std::move(detail);
}

bool LiveSurface::is_border(std::uint32_t edge) const noexcept {
  const std::uint32_t back = twin(edge);
  if (!(surface_.looks[edge / 3] == surface_.looks[back / 3])) return true;
  if (surface_.face_texture.empty()) return false;
  return texture(edge) != texture(next(back)) || texture(next(edge)) != texture(back);
}

std::uint32_t LiveSurface::middle_texture(std::uint32_t edge) {
  if (surface_.face_texture.empty()) return no_index;
  const TexturePoint& a = surface_.texture_points[texture(edge)];
  const TexturePoint& b = surface_.texture_points[texture(next(edge))];
  TexturePoint middle{};
  for (std::size_t k = 0; k < middle.size(); ++k)
    middle[k] = 0.5 * (a[k] + b[k]);
  surface_.texture_points.push_back(middle);
  return to_index(surface_.texture_points.size() - 1);
}

/// Of a new point between two.
void LiveSurface::add_attributes(std::uint32_t a, std::uint32_t b) {
  if (!surface_.colours.empty()) {
    Colour mixed = surface_.colours[a];
    for (std::size_t k = 0; k < mixed.size(); ++k)
      mixed[k] = 0.5f * (mixed[k] + surface_.colours[b][k]);
    surface_.colours.push_back(mixed);
  }
  if (!surface_.rest.empty()) surface_.rest.push_back(0.5 * (surface_.rest[a] + surface_.rest[b]));
  if (!surface_.detail.empty())
    surface_.detail.push_back({0.5f * (surface_.detail[a].edge + surface_.detail[b].edge), true});
}

/// Of the face at an edge's beginning, and of the new face at its end.
void LiveSurface::split_look(std::uint32_t edge, std::uint32_t middle_texture) {
  surface_.looks.push_back(surface_.looks[edge / 3]);
  if (surface_.face_texture.empty()) return;
  surface_.face_texture.push_back({middle_texture, texture(next(edge)), texture(last(edge))});
  set_texture(next(edge), middle_texture);
}

SpacePoint LiveSurface::area_of(std::uint32_t face) const noexcept {
  const Corners& corner = corners(face);
  return area_vector(point(corner[0]), point(corner[1]), point(corner[2]));
}

std::uint32_t LiveSurface::split(std::uint32_t edge) {
  const std::uint32_t back = twin(edge);
  const std::uint32_t a = from(edge);
  const std::uint32_t b = from(back);
  surface_.points.push_back(0.5 * (point(a) + point(b)));
  add_attributes(a, b);
  const bool is_cut = is_border(edge);
  const std::uint32_t in_face = middle_texture(edge);
  split_look(edge, in_face);
  split_look(back, is_cut ? middle_texture(back) : in_face);
  note(EdgeOperation::Kind::split, a, b);
  return SurfaceMesh::split(edge);
}

bool LiveSurface::keeps_borders(std::uint32_t edge) const {
  std::size_t borders = 0;
  visit_edges(to(edge), [&](std::uint32_t at) { borders += is_border(at) ? 1u : 0u; });
  return borders == 0 || (borders == 2 && is_border(edge));
}

bool LiveSurface::keeps_shape(std::uint32_t edge, const CollapseLimits& limits) const {
  const SpacePoint& target = point(from(edge));
  const std::uint32_t b = to(edge);
  SpacePoint around{};
  double longest_before = limits.longest;
  visit_edges(b, [&](std::uint32_t at) {
    around = around + area_of(at / 3);
    longest_before = std::max(longest_before, edge_length(at));
  });
  bool keeps = true;
  visit_edges(b, [&](std::uint32_t at) {
    if (at == next(edge) || at == twin(edge)) return; // these two faces go
    const SpacePoint& p = point(to(at));
    const SpacePoint& q = point(from(last(at)));
    keeps = keeps && distance_between(target, p) <= longest_before;
    if (!keeps || height_of(target, p, q) < limits.thin) return;
    const double before = triangle_fairness(point(b), p, q);
    const SpacePoint old_area = height_of(point(b), p, q) < limits.thin ? around : area_of(at / 3);
    keeps = cosine(area_vector(target, p, q), old_area) >= limits.min_cosine &&
            triangle_fairness(target, p, q) >= std::min(before, fair_enough);
  });
  return keeps;
}

bool LiveSurface::collapse(std::uint32_t edge, const CollapseLimits& limits) {
  if (!can_collapse(edge) || !keeps_shape(edge, limits)) return false;
  collapse_now(edge);
  return true;
}

void LiveSurface::collapse_now(std::uint32_t edge) {
  const std::uint32_t a = from(edge);
  note(EdgeOperation::Kind::collapse, a, to(edge));
  if (!surface_.face_texture.empty()) move_texture(edge);
  if (!surface_.detail.empty()) surface_.detail[a].is_refined = true;
  SurfaceMesh::collapse(edge);
}

/// Around the end, from the other side of the edge to this one; a border on the way parts them.
void LiveSurface::move_texture(std::uint32_t edge) {
  const std::uint32_t back = twin(edge);
  std::uint32_t texture_of_a = texture(next(back));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> moved;
  for (std::uint32_t at = back; at != next(edge); at = twin(last(at))) {
    if (at != back && is_border(at)) texture_of_a = texture(edge);
    moved.emplace_back(at, texture_of_a);
  }
  for (const auto& [out, texture] : moved)
    set_texture(out, texture);
}

bool LiveSurface::makes_fairer(std::uint32_t edge) const {
  const auto [a, b, c, d] = points_at(edge);
  const double one = triangle_fairness(point(a), point(b), point(c));
  const double other = triangle_fairness(point(b), point(a), point(d));
  const double then = std::min(triangle_fairness(point(d), point(c), point(a)),
                               triangle_fairness(point(c), point(d), point(b)));
  if (then <= min_gain * std::min(one, other)) return false;
  const SpacePoint both = area_of(edge / 3) + area_of(twin(edge) / 3);
  if (std::min(one, other) > needle &&
      cosine(area_of(edge / 3), area_of(twin(edge) / 3)) < min_flat_cosine)
    return false;
  return cosine(area_vector(point(d), point(c), point(a)), both) >= min_flat_cosine &&
         cosine(area_vector(point(c), point(d), point(b)), both) >= min_flat_cosine;
}

bool LiveSurface::flip(std::uint32_t edge) {
  if (is_border(edge) || !makes_fairer(edge) || !can_flip(edge)) return false;
  flip_now(edge);
  return true;
}

void LiveSurface::flip_now(std::uint32_t edge) {
  const std::uint32_t back = twin(edge);
  note(EdgeOperation::Kind::flip, from(edge), from(back));
  if (!surface_.face_texture.empty()) {
    const std::uint32_t at_c = texture(last(edge));
    const std::uint32_t at_d = texture(last(back));
    set_texture(last(edge), texture(edge));
    set_texture(last(back), texture(next(edge)));
    set_texture(edge, at_d);
    set_texture(next(edge), at_c);
    set_texture(back, at_c);
    set_texture(next(back), at_d);
  }
  SurfaceMesh::flip(edge);
}

bool LiveSurface::repeat(const EdgeOperation& operation) {
  if (operation.from >= point_count() || operation.to >= point_count() ||
      !has_point(operation.from) || !has_point(operation.to))
    return false;
  const std::uint32_t edge = edge_between(operation.from, operation.to);
  if (edge == no_index) return false;
  switch (operation.kind) {
  case EdgeOperation::Kind::split:
    split(edge);
    return true;
  case EdgeOperation::Kind::collapse:
    if (!can_collapse(edge)) return false;
    collapse_now(edge);
    return true;
  case EdgeOperation::Kind::flip:
    if (!can_flip(edge)) return false;
    flip_now(edge);
    return true;
  }
  return false;
}

TriangleSurface LiveSurface::take(std::vector<std::uint32_t>* numbers) {
  Renumbering made;
  surface_.faces = SurfaceMesh::take(made);
  surface_.renumber_columns(made);
  if (numbers != nullptr) *numbers = std::move(made.points);
  return std::exchange(surface_, {});
}

} // namespace nendo::deform
