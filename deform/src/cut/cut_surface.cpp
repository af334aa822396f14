#include "cut/cut_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/columns.hpp"

namespace nendo::deform {

CutSurface::CutSurface(const Mesh& mesh, const Points& rest, const HalfEdges& edges,
                       const Blade& blade, double blade_offset, const std::vector<double>& sides)
    : mesh_(mesh), triangles_(mesh, rest), edges_(edges), blade_(blade),
      blade_offset_(blade_offset), sides_(sides), active_(mesh.face_count(), 0) {
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const auto corners = mesh.corners_of(face);
    const bool first = is_up(corners[0]);
    if (std::ranges::any_of(corners, [&](std::uint32_t at) { return is_up(at) != first; }))
      activate(face);
  }
}

SpacePoint CutSurface::point(std::uint32_t vertex) const noexcept {
  const auto old = to_index(mesh_.vertex_count());
  if (vertex >= old) return added_points_[vertex - old];
  return space_point(mesh_.vertices, vertex);
}

/// Takes a face as triangles.
void CutSurface::activate(std::uint32_t face) {
  if (active_[face] != 0) return;
  active_[face] = 1;
  for (const Triangle& corners : triangles_.of(face)) {
    Piece piece{{}, {}, face};
    for (std::size_t k = 0; k < 3; ++k) {
      piece.vertices[k] = mesh_.face_corners[corners[k]];
      piece.texcoords[k] = mesh_.corner_texcoords.empty() ? 0 : mesh_.corner_texcoords[corners[k]];
    }
    pieces_.push_back(piece);
    if (blade_.bends()) index(to_index(pieces_.size() - 1));
  }
}

void CutSurface::index(std::uint32_t piece) {
  const auto& vertices = pieces_[piece].vertices;
  for (std::size_t k = 0; k < 3; ++k)
    piece_of_edge_[edge_key(vertices[k], vertices[(k + 1) % 3])] = piece;
}

bool CutSurface::is_crossed(const Piece& piece) const noexcept {
  const bool first = is_up(piece.vertices[0]);
  return is_up(piece.vertices[1]) != first || is_up(piece.vertices[2]) != first;
}

/// Returns which corner of a crossed piece is alone on its side.
std::uint32_t CutSurface::lone_corner(const Piece& piece) const noexcept {
  const auto& [a, b, c] = piece.vertices;
  return is_up(b) == is_up(c) ? 0 : is_up(a) == is_up(c) ? 1 : 2;
}

/// A blade that bends may bulge through a face without parting its vertices.
void CutSurface::activate_near_bends() {
  const std::size_t faces = mesh_.face_count();
  for (std::uint32_t face = 0; face < faces; ++face) {
    if (active_[face] != 0) continue;
    const std::uint32_t begin = mesh_.face_starts[face];
    const std::uint32_t end = mesh_.face_starts[face + 1];
    double nearest = std::numeric_limits<double>::infinity();
    double longest = 0.0;
    SpacePoint middle{};
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t vertex = mesh_.face_corners[at];
      nearest = std::min(nearest, std::abs(above(vertex)));
      const std::uint32_t after = mesh_.face_corners[edges_.next[at]];
      const SpacePoint edge = point(after) - point(vertex);
      longest = std::max(longest, dot(edge, edge));
      middle = middle + (1.0 / (end - begin)) * point(vertex);
    }
    if (nearest * nearest > longest) continue;
    const bool up = is_up(mesh_.face_corners[begin]);
    bool bulges = (blade_.side(middle) > blade_offset_) != up;
    for (std::uint32_t at = begin; at < end && !bulges; ++at) {
      const SpacePoint half =
          between(point(mesh_.face_corners[at]), point(mesh_.face_corners[edges_.next[at]]), 0.5);
      bulges = (blade_.side(half) > blade_offset_) != up;
    }
    if (bulges) activate(face);
  }
}

/// Returns how far the blade is from where the triangle is taken to be crossed. Of one that is not
/// crossed: how far the blade bulges through.
double CutSurface::sag_of(const Piece& piece) const noexcept {
  const std::array corners{point(piece.vertices[0]), point(piece.vertices[1]),
                           point(piece.vertices[2])};
  const std::array heights{above(piece.vertices[0]), above(piece.vertices[1]),
                           above(piece.vertices[2])};
  double worst = 0.0;
  // Where the blade does not cut, its bends do not matter.
  const auto look_at = [&](const SpacePoint& at, double sign) {
    const double height = blade_.side(at) - blade_offset_;
    const double sag = sign == 0.0 ? std::abs(height) : sign * height;
    if (sag > worst && blade_.covers(at)) worst = sag;
  };
  if (!is_crossed(piece)) {
    const double beyond = heights[0] > 0.0 ? -1.0 : 1.0;
    for (std::size_t k = 0; k < 3; ++k)
      look_at(between(corners[k], corners[(k + 1) % 3], 0.5), beyond);
    look_at(between(between(corners[0], corners[1], 0.5), corners[2], 1.0 / 3.0), beyond);
    return worst;
  }
  const std::size_t lone = lone_corner(piece);
  const auto chord_end = [&](std::size_t other) {
    return between(corners[lone], corners[other], heights[lone] / (heights[lone] - heights[other]));
  };
  const SpacePoint from = chord_end((lone + 1) % 3);
  const SpacePoint to = chord_end((lone + 2) % 3);
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0})
    look_at(between(from, to, part), 0.0);
  return worst;
}

/// Returns the piece that has this edge, and activates the face whose it is. no_index: pieces of
/// several faces had the edge, and it was split in another one.
std::uint32_t CutSurface::piece_at(std::uint32_t from, std::uint32_t to) {
  auto found = piece_of_edge_.find(edge_key(from, to));
  if (found != piece_of_edge_.end()) return found->second;
  for (const std::uint32_t edge : edges_.out[from]) {
    if (mesh_.face_corners[edges_.next[edge]] != to) continue;
    const auto after = std::upper_bound(mesh_.face_starts.begin(), mesh_.face_starts.end(), edge);
    activate(static_cast<std::uint32_t>(after - mesh_.face_starts.begin() - 1));
    break;
  }
  found = piece_of_edge_.find(edge_key(from, to));
  return found == piece_of_edge_.end() ? no_index : found->second;
}

/// Puts a vertex between the ends of an edge, near its middle, but not on the blade.
void CutSurface::halve(std::uint32_t from, std::uint32_t to, std::vector<std::uint32_t>& changed) {
  double part = 0.5;
  SpacePoint middle{};
  double best = -1.0;
  for (const double candidate : {0.5, 0.46, 0.54, 0.42, 0.58}) {
    const SpacePoint at = between(point(from), point(to), candidate);
    const double height = std::abs(blade_.side(at) - blade_offset_);
    if (height > best) {
      best = height;
      part = candidate;
      middle = at;
    }
    // A gap as wide as a hundredth of the edge is wide enough.
    if (best > 0.01 * length_of(point(to) - point(from))) break;
  }
  const std::uint32_t vertex = vertex_count();
  sides_.push_back(blade_.side(middle));
  added_points_.push_back(middle);
  added_.push_back({from, to, part});
  split(from, to, vertex, part, changed);
  split(to, from, vertex, 1.0 - part, changed);
}

void CutSurface::split(std::uint32_t from, std::uint32_t to, std::uint32_t middle, double part,
                       std::vector<std::uint32_t>& changed) {
  const std::uint32_t number = piece_at(from, to);
  if (number == no_index) return;
  const Piece old = pieces_[number];
  std::size_t k = 0;
  while (old.vertices[k] != from)
    ++k;
  const std::size_t other = (k + 1) % 3;
  const std::size_t apex = (k + 2) % 3;
  const std::uint32_t texcoord =
      mesh_.corner_texcoords.empty()
          ? 0
          : texcoord_between(middle, old.texcoords[k], old.texcoords[other], part);
  piece_of_edge_.erase(edge_key(from, to));
  pieces_[number] = {{from, middle, old.vertices[apex]},
                     {old.texcoords[k], texcoord, old.texcoords[apex]},
                     old.face};
  pieces_.push_back({{middle, to, old.vertices[apex]},
                     {texcoord, old.texcoords[other], old.texcoords[apex]},
                     old.face});
  const auto more = to_index(pieces_.size() - 1);
  active_[old.face] = 2;
  index(number);
  index(more);
  changed.insert(changed.end(), {number, more});
}

bool CutSurface::refine(double sag) {
  constexpr std::size_t most = 200'000;
  if (!blade_.bends()) return true;
  activate_near_bends();
  std::vector<std::uint32_t> open = all_indices(pieces_.size());
  for (std::size_t at = 0; at < open.size(); ++at) {
    const Piece& piece = pieces_[open[at]];
    if (sag_of(piece) <= sag) continue;
    if (added_.size() >= most) return false;
    std::size_t longest = 0;
    double squared = -1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const SpacePoint edge = point(piece.vertices[(k + 1) % 3]) - point(piece.vertices[k]);
      if (dot(edge, edge) > squared) {
        squared = dot(edge, edge);
        longest = k;
      }
    }
    // Where the blade is so sharply bent, shorter edges do not help.
    if (squared < sag * sag / 16.0) continue;
    halve(piece.vertices[longest], piece.vertices[(longest + 1) % 3], open);
  }
  return true;
}

double CutSurface::crossing_part(std::uint32_t from, std::uint32_t to) const noexcept {
  const double at_from = above(from);
  double part = at_from / (at_from - above(to));
  if (!blade_.bends()) return part;
  // By halving and by chords in turn.
  double low = 0.0, high = 1.0;
  double at_low = at_from, at_high = above(to);
  for (int round = 0; round < 60 && high - low > 1e-15; ++round) {
    part = round % 3 == 2
               ? (low + high) / 2.0
               : low + (high - low) * std::clamp(at_low / (at_low - at_high), 0.01, 0.99);
    const double here = blade_.side(between(point(from), point(to), part)) - blade_offset_;
    if (here == 0.0) break;
    if ((here > 0.0) == (at_from > 0.0)) {
      low = part;
      at_low = here;
    } else {
      high = part;
      at_high = here;
    }
  }
  return part;
}

std::uint32_t CutSurface::crossing(std::uint32_t one, std::uint32_t other) {
  const auto number = to_index(crossings_.size());
  const auto [from, to] = std::minmax(one, other);
  const auto [found, is_new] = crossing_of_edge_.try_emplace(edge_key(from, to), number);
  if (is_new) {
    const double part = crossing_part(from, to);
    crossings_.push_back({from, to, part});
    crossing_points_.push_back(between(point(from), point(to), part));
  }
  return found->second;
}

bool CutSurface::cross() {
  for (std::uint32_t number = 0; number < pieces_.size(); ++number) {
    const Piece& piece = pieces_[number];
    if (!is_crossed(piece)) continue;
    const std::uint32_t lone = lone_corner(piece);
    const std::uint32_t corner = piece.vertices[lone];
    const std::uint32_t after = crossing(corner, piece.vertices[(lone + 1) % 3]);
    const std::uint32_t before = crossing(corner, piece.vertices[(lone + 2) % 3]);
    crossed_.push_back({number, lone, after, before});
  }
  return link_loops();
}

/// On a closed two-manifold each crossing has one before it and one after it, so all form loops.
/// Triangles are another surface than the faces where two diagonals have the same ends.
bool CutSurface::link_loops() {
  std::vector<std::uint32_t> next(crossings_.size(), no_index);
  loop_of_.assign(crossings_.size(), no_index);
  for (const CrossedPiece& crossed : crossed_) {
    const bool lone_is_up = is_up(pieces_[crossed.piece].vertices[crossed.lone]);
    const std::uint32_t from = lone_is_up ? crossed.after : crossed.before;
    if (next[from] != no_index) return false;
    next[from] = lone_is_up ? crossed.before : crossed.after;
  }
  if (std::find(next.begin(), next.end(), no_index) != next.end()) return false;
  for (std::uint32_t first = 0; first < crossings_.size(); ++first) {
    if (loop_of_[first] != no_index) continue;
    const auto number = to_index(loops_.size());
    loops_.emplace_back();
    for (std::uint32_t at = first; loop_of_[at] == no_index; at = next[at]) {
      loop_of_[at] = number;
      loops_.back().push_back(at);
    }
  }
  return true;
}

TexturePoint CutSurface::texcoord(std::uint32_t index) const noexcept {
  const auto old = static_cast<std::uint32_t>(mesh_.texcoords.cols());
  return index < old ? texture_point_of(mesh_, index) : new_texcoords_[index - old];
}

std::uint32_t CutSurface::texcoord_between(std::uint64_t point, std::uint32_t from,
                                           std::uint32_t to, double part) {
  std::vector<PointTexcoord>& known = texcoords_of_point_[point];
  for (const PointTexcoord& one : known)
    if ((one.from == from && one.to == to) || (one.from == to && one.to == from)) return one.index;
  const auto number = static_cast<std::uint32_t>(static_cast<std::size_t>(mesh_.texcoords.cols()) +
                                                 new_texcoords_.size());
  TexturePoint mixed = texcoord(from);
  const TexturePoint other = texcoord(to);
  for (std::size_t k = 0; k < mixed.size(); ++k)
    mixed[k] = (1.0 - part) * mixed[k] + part * other[k];
  new_texcoords_.push_back(mixed);
  known.push_back({from, to, number});
  return number;
}

} // namespace nendo::deform
