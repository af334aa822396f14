#include "topology/thin_surface.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace nendo::deform {
namespace {

constexpr double gap_of_edge = 0.25;  // between the ends of a neck that has parted
constexpr std::size_t min_faces = 32; // of a part that is no crumb

} // namespace

ThinSurface::ThinSurface(TriangleSurface surface)
    : SurfaceMesh(std::move(surface.faces), surface.points.size()), surface_(std::move(surface)) {
  double sum = 0.0;
  for (std::uint32_t edge = 0; edge < 3 * face_count(); ++edge)
    sum += distance_between(point(from(edge)), point(to(edge)));
  mean_edge_ = sum / static_cast<double>(std::max(1U, 3 * face_count()));
}

std::vector<std::uint32_t> ThinSurface::ring(std::uint32_t number) const {
  std::vector<std::uint32_t> ring;
  if (!has_point(number)) return ring;
  visit_edges(number, [&](std::uint32_t edge) { ring.push_back(edge); });
  // From the first face on, whatever was done before.
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  for (std::uint32_t& edge : ring)
    edge = to(edge);
  return ring;
}

/// The faces around each point of the loop, from the way on to the way back: the left ones, and the
/// others.
bool ThinSurface::find_sides(const Triple& loop, SideOfLoop& left, SideOfLoop& right) const {
  for (SideOfLoop* const side : {&left, &right})
    side->middle = {0.0, 0.0, 0.0};
  std::array<double, 2> counts{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t onward = loop[(k + 1) % 3], back = loop[(k + 2) % 3];
    const std::uint32_t first = edge_between(loop[k], onward);
    if (first == no_index) return false;
    bool is_left = true;
    visit_edges_from(first, [&](std::uint32_t edge) {
      const std::uint32_t one = to(edge);
      if (one == back) is_left = false;
      SideOfLoop& side = is_left ? left : right;
      side.faces.push_back(edge / 3);
      if (one == onward || one == back) return;
      side.middle = side.middle + point(one);
      ++counts[is_left ? 0 : 1];
    });
    if (is_left) return false;
  }
  if (counts[0] == 0.0 || counts[1] == 0.0) return false;
  left.middle = (1.0 / counts[0]) * left.middle;
  right.middle = (1.0 / counts[1]) * right.middle;
  return true;
}

/// Few faces are behind the loop, and no way leads from them to its other side.
bool ThinSurface::is_crumb(const Triple& loop, const SideOfLoop& side,
                           const SideOfLoop& other) const {
  const auto is_of_loop = [&](std::uint32_t point) {
    return std::find(loop.begin(), loop.end(), point) != loop.end();
  };
  std::set<std::uint32_t> seen(side.faces.begin(), side.faces.end());
  const std::set<std::uint32_t> beyond(other.faces.begin(), other.faces.end());
  std::vector<std::uint32_t> left_to_see(seen.begin(), seen.end());
  while (!left_to_see.empty()) {
    const std::uint32_t first = 3 * left_to_see.back();
    left_to_see.pop_back();
    for (std::uint32_t edge = first; edge < first + 3; ++edge) {
      if (is_of_loop(from(edge)) && is_of_loop(to(edge))) continue;
      const std::uint32_t neighbour = other_face(edge);
      if (beyond.contains(neighbour)) return false; // a handle
      if (!seen.insert(neighbour).second) continue;
      if (seen.size() >= min_faces) return false;
      left_to_see.push_back(neighbour);
    }
  }
  return true;
}

bool ThinSurface::part(const Triple& loop) {
  SideOfLoop left, right;
  if (!find_sides(loop, left, right) || is_crumb(loop, left, right) || is_crumb(loop, right, left))
    return false;
  const SpacePoint plane = area_vector(point(loop[0]), point(loop[1]), point(loop[2]));
  const double area = length_of(plane);
  const double way = dot(left.middle - right.middle, plane);
  if (!(area > 0.0) || way == 0.0) return false;
  std::array<std::uint32_t, 3> edges{};
  for (std::size_t k = 0; k < 3; ++k)
    edges[k] = edge_between(loop[k], loop[(k + 1) % 3]);
  const std::uint32_t like_right = other_face(edges[0]);
  const Triple copies{point_count(), point_count() + 1, point_count() + 2};
  open(edges);
  surface_.copy_points(loop);
  add_face({loop[1], loop[0], loop[2]}, edges[0] / 3);
  add_face({copies[0], copies[1], copies[2]}, like_right);
  for (std::size_t k = 0; k < 3; ++k) {
    const double half = 0.5 * gap_of_edge * wanted(loop[k]) / area * (way > 0.0 ? 1.0 : -1.0);
    surface_.points[loop[k]] = surface_.points[loop[k]] + half * plane;
    surface_.points[copies[k]] = surface_.points[copies[k]] + -half * plane;
    note_around(loop[k]);
    note_around(copies[k]);
  }
  return true;
}

std::set<std::uint32_t> ThinSurface::faces_around(const std::vector<std::uint32_t>& points) const {
  std::set<std::uint32_t> faces;
  for (const std::uint32_t point : points)
    if (has_point(point)) visit_edges(point, [&](std::uint32_t edge) { faces.insert(edge / 3); });
  return faces;
}

ThinSurface::Rims ThinSurface::rims_of(const std::set<std::uint32_t>& faces) const {
  std::map<std::uint32_t, std::uint32_t> next;
  Rims rims;
  for (const std::uint32_t face : faces)
    for (std::uint32_t edge = 3 * face; edge < 3 * face + 3; ++edge)
      if (!faces.contains(other_face(edge)) && !next.emplace(from(edge), to(edge)).second)
        rims.doubled.push_back(from(edge));
  while (rims.doubled.empty() && !next.empty()) {
    std::vector<std::uint32_t>& loop = rims.loops.emplace_back();
    for (auto at = next.begin(); at != next.end(); at = next.find(loop.back())) {
      loop.push_back(at->second);
      next.erase(at);
    }
  }
  std::stable_sort(rims.loops.begin(), rims.loops.end(),
                   [](const auto& one, const auto& other) { return one.size() > other.size(); });
  return rims;
}

/// Only the two longest rims stay, which meet no point twice, if few rounds lead there.
std::set<std::uint32_t> ThinSurface::without_islands(std::set<std::uint32_t> faces) const {
  constexpr int max_rounds = 16;
  for (int round = 0; round < max_rounds; ++round) {
    const Rims rims = rims_of(faces);
    faces.merge(faces_around(rims.doubled));
    if (rims.doubled.empty() && rims.loops.size() <= 2) break;
    for (std::size_t at = 2; at < rims.loops.size(); ++at)
      if (!fill(rims.loops[at], faces)) return {};
  }
  return faces;
}

/// Adds what is within a rim, unless it is much.
bool ThinSurface::fill(const std::vector<std::uint32_t>& rim,
                       std::set<std::uint32_t>& faces) const {
  constexpr std::size_t max_faces = 512;
  std::vector<std::uint32_t> found;
  const auto find = [&](std::uint32_t face) {
    if (faces.insert(face).second) found.push_back(face);
  };
  for (std::size_t at = 0; at < rim.size(); ++at)
    find(edge_between(rim[(at + 1) % rim.size()], rim[at]) / 3);
  for (std::size_t at = 0; at < found.size(); ++at) {
    if (found.size() > max_faces) return false;
    for (const std::uint32_t face : faces_beside(found[at]))
      find(face);
  }
  return true;
}

/// Faces are of one if a way over edges leads from the one to the other.
int ThinSurface::count_patches(const std::set<std::uint32_t>& faces) const {
  std::set<std::uint32_t> unseen = faces;
  int patches = 0;
  for (; !unseen.empty(); ++patches) {
    std::vector<std::uint32_t> to_see{*unseen.begin()};
    unseen.erase(unseen.begin());
    while (!to_see.empty()) {
      const Triple beside = faces_beside(to_see.back());
      to_see.pop_back();
      for (const std::uint32_t face : beside)
        if (unseen.erase(face) > 0) to_see.push_back(face);
    }
  }
  return patches;
}

/// By an edge of a face that is none of these.
bool ThinSurface::are_tied(std::uint32_t a, std::uint32_t b,
                           const std::set<std::uint32_t>& without) const {
  for (const std::uint32_t edge : {edge_between(a, b), edge_between(b, a)})
    if (edge != no_index && !without.contains(edge / 3)) return true;
  return false;
}

/// Returns faces from rim to rim, along the one and back along the other, from the nearest points
/// on; nothing if some edge would be there twice.
std::vector<Corners> ThinSurface::between(const std::vector<std::uint32_t>& u,
                                          const std::vector<std::uint32_t>& v) const {
  std::size_t first_u = 0, first_v = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t j = 0; j < v.size(); ++j) {
      const double distance = distance_between(point(u[i]), point(v[j]));
      if (!(distance < nearest)) continue;
      nearest = distance;
      first_u = i;
      first_v = j;
    }
  const auto of_u = [&](std::size_t step) { return u[(first_u + step) % u.size()]; };
  const auto of_v = [&](std::size_t step) { return v[(first_v + v.size() * 2 - step) % v.size()]; };
  const auto across = [&](std::size_t i, std::size_t j) {
    return distance_between(point(of_u(i)), point(of_v(j)));
  };
  std::vector<Corners> faces;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges{{of_u(0), of_v(0)}};
  std::size_t i = 0, j = 0;
  while (i < u.size() || j < v.size()) {
    if (j == v.size() || (i < u.size() && across(i + 1, j) <= across(i, j + 1))) {
      faces.push_back({of_u(i), of_u(i + 1), of_v(j)});
      ++i;
    } else {
      faces.push_back({of_v(j + 1), of_v(j), of_u(i)});
      ++j;
    }
    const bool is_end = i == u.size() && j == v.size();
    if (!is_end && !edges.insert({of_u(i), of_v(j)}).second) return {};
  }
  return faces;
}

int ThinSurface::join_rims(const std::vector<std::uint32_t>& points) {
  const std::set<std::uint32_t> faces = without_islands(faces_around(points));
  const std::vector<std::vector<std::uint32_t>> rims = rims_of(faces).loops;
  if (rims.size() != 2 || rims[0].size() < 3 || rims[1].size() < 3) return 0;
  for (const std::uint32_t a : rims[0])
    for (const std::uint32_t b : rims[1])
      if (a == b || are_tied(a, b, faces)) return 0;
  const std::vector<Corners> joining = between(rims[0], rims[1]);
  if (joining.empty()) return 0;
  const int patches = count_patches(faces);
  remove_faces(std::vector<std::uint32_t>(faces.begin(), faces.end()));
  for (const Corners& corners : joining)
    add_face(corners, *faces.begin());
  return patches;
}

/// With the look of another face, and the texture of one of its corners.
void ThinSurface::add_face(const Corners& corners, std::uint32_t like) {
  changed_.push_back(SurfaceMesh::add_face(corners));
  surface_.looks.push_back(surface_.looks[like]);
  if (surface_.face_texture.empty()) return;
  const std::uint32_t texture = surface_.face_texture[like][0];
  surface_.face_texture.push_back({texture, texture, texture});
}

void ThinSurface::note_around(std::uint32_t number) {
  visit_edges(number, [&](std::uint32_t edge) { changed_.push_back(edge / 3); });
}

std::vector<std::uint32_t> ThinSurface::take_changed() {
  std::vector<std::uint32_t> changed = std::exchange(changed_, {});
  std::erase_if(changed, [this](std::uint32_t face) { return !has_face(face); });
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

TriangleSurface ThinSurface::take(Renumbering& numbers) {
  surface_.faces = SurfaceMesh::take(numbers);
  surface_.renumber_columns(numbers);
  return std::exchange(surface_, {});
}

} // namespace nendo::deform
