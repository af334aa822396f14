#include "join/live_surface.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "join/triangle_edges.hpp"

namespace nendo::deform {
namespace {

/// Two faces whose normals differ by more than 32 degrees are a feature, and are not flipped.
constexpr double least_flat_cosine = 0.85;
/// The normal of a needle says little: its neighbours' decide.
constexpr double needle = 1e-3;
/// Below it a triangle is not made worse.
constexpr double fair_enough = 0.25;
/// A flip that gains less may be taken back by the next one.
constexpr double least_gain = 1.02;

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
    : surface_(std::move(surface)), edge_at_(surface_.points.size(), no_index),
      gone_(surface_.faces.size(), 0) {
  twins_ = TriangleList(surface_.faces).half_edges(surface_.points.size()).twin;
  for (std::uint32_t edge = 0; edge < twins_.size(); ++edge)
    edge_at_[from(edge)] = edge;
}

void LiveSurface::set_detail(std::vector<VertexDetail> detail) {
  surface_.detail = std::move(detail);
}

std::uint32_t LiveSurface::edge_between(std::uint32_t one, std::uint32_t other) const {
  std::uint32_t found = no_index;
  visit_edges(one, [&](std::uint32_t edge) {
    if (to(edge) == other) found = edge;
  });
  return found;
}

bool LiveSurface::is_border(std::uint32_t edge) const noexcept {
  const std::uint32_t back = twins_[edge];
  if (!(surface_.looks[edge / 3] == surface_.looks[back / 3])) return true;
  if (surface_.face_texture.empty()) return false;
  return texture(edge) != texture(next(back)) || texture(next(edge)) != texture(back);
}

void LiveSurface::set(std::uint32_t edge, std::uint32_t corner, std::uint32_t texture) noexcept {
  surface_.faces[edge / 3][edge % 3] = corner;
  if (!surface_.face_texture.empty()) surface_.face_texture[edge / 3][edge % 3] = texture;
  edge_at_[corner] = edge;
}

std::uint32_t LiveSurface::middle_texture(std::uint32_t edge) {
  if (surface_.face_texture.empty()) return no_index;
  const TexturePoint& a = surface_.texture_points[texture(edge)];
  const TexturePoint& b = surface_.texture_points[texture(next(edge))];
  TexturePoint middle{};
  for (std::size_t k = 0; k < middle.size(); ++k)
    middle[k] = 0.5 * (a[k] + b[k]);
  surface_.texture_points.push_back(middle);
  return static_cast<std::uint32_t>(surface_.texture_points.size() - 1);
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

std::uint32_t LiveSurface::add_face(std::uint32_t like) {
  surface_.faces.push_back({});
  surface_.looks.push_back(surface_.looks[like]);
  if (!surface_.face_texture.empty()) surface_.face_texture.push_back({});
  gone_.push_back(0);
  twins_.resize(twins_.size() + 3);
  return static_cast<std::uint32_t>(3 * (surface_.faces.size() - 1));
}

SpacePoint LiveSurface::area_of(std::uint32_t face) const noexcept {
  const Corners& corner = surface_.faces[face];
  return area_vector(point(corner[0]), point(corner[1]), point(corner[2]));
}

std::uint32_t LiveSurface::split(std::uint32_t edge) {
  const std::uint32_t back = twins_[edge];
  const std::uint32_t a = from(edge);
  const std::uint32_t b = from(back);
  const auto middle = static_cast<std::uint32_t>(surface_.points.size());
  surface_.points.push_back(0.5 * (point(a) + point(b)));
  edge_at_.push_back(no_index);
  add_attributes(a, b);
  const bool is_cut = is_border(edge);
  const std::uint32_t in_face = middle_texture(edge);
  const std::uint32_t in_back = is_cut ? middle_texture(back) : in_face;
  // Each face keeps the half at its edge's beginning; a new one gets the half at its end.
  const auto halve = [&](std::uint32_t side, std::uint32_t middle_in_side) {
    const std::uint32_t fresh = add_face(side / 3);
    const std::uint32_t behind = next(side);
    const std::uint32_t tip = last(side);
    set(fresh, middle, middle_in_side);
    set(next(fresh), from(behind), texture_or_none(behind));
    set(last(fresh), from(tip), texture_or_none(tip));
    link(next(fresh), twins_[behind]);
    set(behind, middle, middle_in_side);
    link(last(fresh), behind);
    edge_at_[from(tip)] = tip;
    return fresh;
  };
  const std::uint32_t to_b = halve(edge, in_face);
  const std::uint32_t to_a = halve(back, in_back);
  link(edge, to_a);
  link(back, to_b);
  edge_at_[a] = edge;
  edge_at_[b] = back;
  note(EdgeOperation::Kind::split, a, b);
  return middle;
}

bool LiveSurface::keeps_links(std::uint32_t edge) const {
  // The ends share exactly the two tips, and no tip loses its last but two faces.
  const std::uint32_t a = from(edge);
  const std::uint32_t b = to(edge);
  std::size_t common = 0;
  visit_edges(b, [&](std::uint32_t at) {
    if (to(at) != a && edge_between(a, to(at)) != no_index) ++common;
  });
  if (common != 2) return false;
  for (const std::uint32_t tip : {from(last(edge)), from(last(twins_[edge]))}) {
    std::size_t faces = 0;
    visit_edges(tip, [&](std::uint32_t) { ++faces; });
    if (faces <= 3) return false;
  }
  return true;
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
    if (at == next(edge) || at == twins_[edge]) return; // these two faces go
    const SpacePoint& p = point(to(at));
    const SpacePoint& q = point(from(last(at)));
    keeps = keeps && distance_between(target, p) <= longest_before;
    if (!keeps || height_of(target, p, q) < limits.thin) return;
    const double before = triangle_fairness(point(b), p, q);
    const SpacePoint old_area = height_of(point(b), p, q) < limits.thin ? around : area_of(at / 3);
    keeps = cosine(area_vector(target, p, q), old_area) >= limits.least_cosine &&
            triangle_fairness(target, p, q) >= std::min(before, fair_enough);
  });
  return keeps;
}

bool LiveSurface::can_collapse(std::uint32_t edge) const {
  return keeps_links(edge) && keeps_borders(edge);
}

bool LiveSurface::collapse(std::uint32_t edge, const CollapseLimits& limits) {
  if (!can_collapse(edge) || !keeps_shape(edge, limits)) return false;
  collapse_now(edge);
  return true;
}

void LiveSurface::collapse_now(std::uint32_t edge) {
  const std::uint32_t back = twins_[edge];
  const std::uint32_t a = from(edge);
  const std::uint32_t b = to(edge);
  // Around the end, from the other side of the edge to this one; a border on the way parts them.
  std::uint32_t texture_of_a = texture_or_none(next(back));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> moved;
  for (std::uint32_t at = back; at != next(edge); at = twins_[last(at)]) {
    if (at != back && is_border(at)) texture_of_a = texture_or_none(edge);
    moved.emplace_back(at, texture_of_a);
  }
  const std::uint32_t c = from(last(edge));
  const std::uint32_t d = from(last(back));
  for (const auto& [out, texture] : moved)
    if (out / 3 != edge / 3 && out / 3 != back / 3) set(out, a, texture);
  const std::uint32_t beyond_c = twins_[next(edge)]; // from c to b before
  const std::uint32_t beside_a = twins_[last(edge)]; // from a to c
  const std::uint32_t beyond_d = twins_[next(back)]; // from d to a
  const std::uint32_t beside_b = twins_[last(back)]; // from b to d before
  link(beyond_c, beside_a);
  link(beyond_d, beside_b);
  gone_[edge / 3] = gone_[back / 3] = 1;
  edge_at_[a] = beside_a;
  edge_at_[c] = beyond_c;
  edge_at_[d] = beyond_d;
  edge_at_[b] = no_index;
  if (!surface_.detail.empty()) surface_.detail[a].is_refined = true;
  note(EdgeOperation::Kind::collapse, a, b);
}

bool LiveSurface::makes_fairer(std::uint32_t edge) const {
  const std::uint32_t back = twins_[edge];
  const std::uint32_t a = from(edge);
  const std::uint32_t b = from(back);
  const std::uint32_t c = from(last(edge));
  const std::uint32_t d = from(last(back));
  const double one = triangle_fairness(point(a), point(b), point(c));
  const double other = triangle_fairness(point(b), point(a), point(d));
  const double then = std::min(triangle_fairness(point(d), point(c), point(a)),
                               triangle_fairness(point(c), point(d), point(b)));
  if (then <= least_gain * std::min(one, other)) return false;
  const SpacePoint both = area_of(edge / 3) + area_of(back / 3);
  if (std::min(one, other) > needle &&
      cosine(area_of(edge / 3), area_of(back / 3)) < least_flat_cosine)
    return false;
  return cosine(area_vector(point(d), point(c), point(a)), both) >= least_flat_cosine &&
         cosine(area_vector(point(c), point(d), point(b)), both) >= least_flat_cosine;
}

bool LiveSurface::can_flip(std::uint32_t edge) const {
  const std::uint32_t back = twins_[edge];
  const std::uint32_t c = from(last(edge));
  const std::uint32_t d = from(last(back));
  if (is_border(edge) || c == d) return false;
  std::size_t at_a = 0;
  std::size_t at_b = 0;
  visit_edges(from(edge), [&](std::uint32_t) { ++at_a; });
  visit_edges(from(back), [&](std::uint32_t) { ++at_b; });
  return at_a > 3 && at_b > 3 && edge_between(c, d) == no_index;
}

bool LiveSurface::flip(std::uint32_t edge) {
  if (is_border(edge) || !makes_fairer(edge) || !can_flip(edge)) return false;
  flip_now(edge);
  return true;
}

void LiveSurface::flip_now(std::uint32_t edge) {
  const std::uint32_t back = twins_[edge];
  const std::uint32_t a = from(edge);
  const std::uint32_t b = from(back);
  const std::uint32_t c = from(last(edge));
  const std::uint32_t d = from(last(back));
  const std::array<std::uint32_t, 4> beyond{twins_[next(edge)], twins_[last(edge)],
                                            twins_[next(back)], twins_[last(back)]};
  const std::uint32_t at_c = texture_or_none(last(edge));
  const std::uint32_t at_d = texture_or_none(last(back));
  const std::uint32_t of_a = texture_or_none(edge);
  const std::uint32_t of_b = texture_or_none(next(edge));
  set(edge, d, at_d);
  set(next(edge), c, at_c);
  set(last(edge), a, of_a);
  set(back, c, at_c);
  set(next(back), d, at_d);
  set(last(back), b, of_b);
  link(next(edge), beyond[1]); // from c to a
  link(last(edge), beyond[2]); // from a to d
  link(next(back), beyond[3]); // from d to b
  link(last(back), beyond[0]); // from b to c
  note(EdgeOperation::Kind::flip, a, b);
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
  std::vector<std::uint32_t> renumbered(surface_.points.size(), no_index);
  TriangleSurface kept;
  for (std::uint32_t at = 0; at < surface_.points.size(); ++at) {
    if (edge_at_[at] == no_index) continue;
    renumbered[at] = static_cast<std::uint32_t>(kept.points.size());
    kept.points.push_back(surface_.points[at]);
    if (!surface_.colours.empty()) kept.colours.push_back(surface_.colours[at]);
    if (!surface_.rest.empty()) kept.rest.push_back(surface_.rest[at]);
    if (!surface_.detail.empty()) kept.detail.push_back(surface_.detail[at]);
  }
  for (std::uint32_t face = 0; face < surface_.faces.size(); ++face) {
    if (gone_[face]) continue;
    Corners corners = surface_.faces[face];
    for (std::uint32_t& corner : corners)
      corner = renumbered[corner];
    kept.faces.push_back(corners);
    kept.looks.push_back(surface_.looks[face]);
    if (!surface_.face_texture.empty()) kept.face_texture.push_back(surface_.face_texture[face]);
  }
  kept.texture_points = std::move(surface_.texture_points);
  if (numbers != nullptr) *numbers = std::move(renumbered);
  *this = LiveSurface(TriangleSurface{});
  return kept;
}

} // namespace nendo::deform
