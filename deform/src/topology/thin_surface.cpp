#include "topology/thin_surface.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace nendo::deform {

namespace {

constexpr double gap_of_edge = 0.25;    // between the ends of a neck that has parted
constexpr std::size_t least_faces = 32; // of what is no crumb

std::size_t place_in(const Corners& corners, std::uint32_t point) {
  return corners[0] == point ? 0 : corners[1] == point ? 1 : 2;
}

/// The corner behind that one, and the one before it.
std::uint32_t after(const Corners& corners, std::uint32_t point) {
  return corners[(place_in(corners, point) + 1) % 3];
}
std::uint32_t before(const Corners& corners, std::uint32_t point) {
  return corners[(place_in(corners, point) + 2) % 3];
}

} // namespace

ThinSurface::ThinSurface(TriangleSurface surface)
    : surface_(std::move(surface)), faces_at_(surface_.points.size()),
      gone_(surface_.faces.size(), 0) {
  double sum = 0.0;
  for (std::uint32_t face = 0; face < surface_.faces.size(); ++face)
    for (const std::uint32_t corner : surface_.faces[face]) {
      faces_at_[corner].push_back(face);
      sum += distance_between(point(corner), point(after(surface_.faces[face], corner)));
    }
  mean_edge_ = sum / static_cast<double>(std::max<std::size_t>(1, 3 * surface_.faces.size()));
}

std::vector<std::uint32_t> ThinSurface::ring(std::uint32_t number) const {
  std::vector<std::uint32_t> ring;
  const auto& faces = faces_at_[number];
  if (faces.empty()) return ring;
  const std::uint32_t first = after(surface_.faces[faces.front()], number);
  std::uint32_t at = first;
  do {
    ring.push_back(at);
    const std::uint32_t face = face_with(number, at);
    if (face == no_index || ring.size() > faces.size()) return {};
    at = before(surface_.faces[face], number);
  } while (at != first);
  return ring;
}

std::uint32_t ThinSurface::face_with(std::uint32_t from, std::uint32_t to) const noexcept {
  for (const std::uint32_t face : faces_at_[from])
    if (after(surface_.faces[face], from) == to) return face;
  return no_index;
}

SpacePoint ThinSurface::normal(std::uint32_t number) const {
  SpacePoint sum{0.0, 0.0, 0.0};
  for (const std::uint32_t face : faces_at_[number]) {
    const Corners& corners = surface_.faces[face];
    sum = sum + area_vector(point(corners[0]), point(corners[1]), point(corners[2]));
  }
  return sum;
}

/// The faces around each point of the loop, from the way on to the way back: the left ones, and the
/// others.
bool ThinSurface::find_sides(const Triple& loop, SideOfLoop& left, SideOfLoop& right) const {
  for (SideOfLoop* const side : {&left, &right})
    side->middle = {0.0, 0.0, 0.0};
  std::array<double, 2> counts{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t here = loop[k], next = loop[(k + 1) % 3], last = loop[(k + 2) % 3];
    const std::vector<std::uint32_t> around = ring(here);
    const auto begin = std::find(around.begin(), around.end(), next);
    if (begin == around.end()) return false;
    bool is_left = true;
    for (std::size_t step = 0; step < around.size(); ++step) {
      const auto from = static_cast<std::size_t>(begin - around.begin()) + step;
      const std::uint32_t one = around[from % around.size()];
      if (one == last) is_left = false;
      SideOfLoop& side = is_left ? left : right;
      side.faces.push_back(face_with(here, one));
      if (one == next || one == last) continue;
      side.middle = side.middle + point(one);
      ++counts[is_left ? 0 : 1];
    }
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
    const Corners corners = surface_.faces[left_to_see.back()];
    left_to_see.pop_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
      if (is_of_loop(from) && is_of_loop(to)) continue;
      const std::uint32_t neighbour = face_with(to, from);
      if (beyond.contains(neighbour)) return false; // a handle
      if (!seen.insert(neighbour).second) continue;
      if (seen.size() >= least_faces) return false;
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
  const std::uint32_t like_left = face_with(loop[0], loop[1]);
  const std::uint32_t like_right = face_with(loop[1], loop[0]);
  Triple copies{};
  for (std::size_t k = 0; k < 3; ++k)
    copies[k] = copy_point(loop[k]);
  for (const std::uint32_t face : right.faces)
    for (std::uint32_t& corner : surface_.faces[face]) {
      const auto at = std::find(loop.begin(), loop.end(), corner);
      if (at != loop.end()) corner = copies[static_cast<std::size_t>(at - loop.begin())];
    }
  std::sort(right.faces.begin(), right.faces.end());
  right.faces.erase(std::unique(right.faces.begin(), right.faces.end()), right.faces.end());
  for (const std::uint32_t face : right.faces)
    for (const std::uint32_t corner : surface_.faces[face]) {
      const auto at = std::find(copies.begin(), copies.end(), corner);
      if (at == copies.end()) continue;
      std::erase(faces_at_[loop[static_cast<std::size_t>(at - copies.begin())]], face);
      faces_at_[corner].push_back(face);
    }
  add_face({loop[1], loop[0], loop[2]}, like_left);
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
    faces.insert(faces_at_[point].begin(), faces_at_[point].end());
  return faces;
}

ThinSurface::Rims ThinSurface::rims_of(const std::set<std::uint32_t>& faces) const {
  std::map<std::uint32_t, std::uint32_t> next;
  Rims rims;
  for (const std::uint32_t face : faces) {
    const Corners& corners = surface_.faces[face];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
      if (!faces.contains(face_with(to, from)) && !next.emplace(from, to).second)
        rims.doubled.push_back(from);
    }
  }
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
  constexpr int most_rounds = 16;
  for (int round = 0; round < most_rounds; ++round) {
    const Rims rims = rims_of(faces);
    for (const std::uint32_t point : rims.doubled)
      faces.insert(faces_at_[point].begin(), faces_at_[point].end());
    if (rims.doubled.empty() && rims.loops.size() <= 2) break;
    for (std::size_t at = 2; at < rims.loops.size(); ++at)
      if (!fill(rims.loops[at], faces)) return {};
  }
  return faces;
}

/// Adds what is within a rim, unless it is much.
bool ThinSurface::fill(const std::vector<std::uint32_t>& rim,
                       std::set<std::uint32_t>& faces) const {
  constexpr std::size_t most_faces = 512;
  std::vector<std::uint32_t> found;
  const auto find = [&](std::uint32_t face) {
    if (faces.insert(face).second) found.push_back(face);
  };
  for (std::size_t at = 0; at < rim.size(); ++at)
    find(face_with(rim[(at + 1) % rim.size()], rim[at]));
  for (std::size_t at = 0; at < found.size(); ++at) {
    if (found.size() > most_faces) return false;
    const Corners corners = surface_.faces[found[at]];
    for (std::size_t k = 0; k < 3; ++k)
      find(face_with(corners[(k + 1) % 3], corners[k]));
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
      const Corners corners = surface_.faces[to_see.back()];
      to_see.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t neighbour = face_with(corners[(k + 1) % 3], corners[k]);
        if (unseen.erase(neighbour) > 0) to_see.push_back(neighbour);
      }
    }
  }
  return patches;
}

/// By an edge of a face that is none of these.
bool ThinSurface::are_tied(std::uint32_t a, std::uint32_t b,
                           const std::set<std::uint32_t>& without) const {
  for (const std::uint32_t face : {face_with(a, b), face_with(b, a)})
    if (face != no_index && !without.contains(face)) return true;
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
  for (const std::uint32_t face : faces)
    remove_face(face);
  for (const Corners& corners : joining)
    add_face(corners, *faces.begin());
  return patches;
}

std::uint32_t ThinSurface::copy_point(std::uint32_t number) {
  const auto copy = point_count();
  surface_.points.push_back(surface_.points[number]);
  if (!surface_.colours.empty()) surface_.colours.push_back(surface_.colours[number]);
  if (!surface_.detail.empty()) surface_.detail.push_back(surface_.detail[number]);
  faces_at_.emplace_back();
  return copy;
}

/// With the look of another face, and the texture of one of its corners.
void ThinSurface::add_face(const Corners& corners, std::uint32_t like) {
  const auto face = static_cast<std::uint32_t>(surface_.faces.size());
  surface_.faces.push_back(corners);
  surface_.looks.push_back(surface_.looks[like]);
  if (!surface_.face_texture.empty()) {
    const std::uint32_t texture = surface_.face_texture[like][0];
    surface_.face_texture.push_back({texture, texture, texture});
  }
  gone_.push_back(0);
  for (const std::uint32_t corner : corners)
    faces_at_[corner].push_back(face);
  changed_.push_back(face);
}

void ThinSurface::remove_face(std::uint32_t face) {
  gone_[face] = 1;
  for (const std::uint32_t corner : surface_.faces[face])
    std::erase(faces_at_[corner], face);
}

void ThinSurface::note_around(std::uint32_t number) {
  changed_.insert(changed_.end(), faces_at_[number].begin(), faces_at_[number].end());
}

std::vector<std::uint32_t> ThinSurface::take_changed() {
  std::vector<std::uint32_t> changed = std::exchange(changed_, {});
  std::erase_if(changed, [this](std::uint32_t face) { return gone_[face] != 0; });
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

TriangleSurface ThinSurface::take(std::vector<std::uint32_t>& numbers,
                                  std::vector<std::uint32_t>& faces) {
  TriangleSurface kept;
  kept.texture_points = std::move(surface_.texture_points);
  numbers.assign(surface_.points.size(), no_index);
  for (std::uint32_t at = 0; at < surface_.points.size(); ++at) {
    if (faces_at_[at].empty()) continue;
    numbers[at] = static_cast<std::uint32_t>(kept.points.size());
    kept.points.push_back(surface_.points[at]);
    if (!surface_.colours.empty()) kept.colours.push_back(surface_.colours[at]);
    if (!surface_.detail.empty()) kept.detail.push_back(surface_.detail[at]);
  }
  faces.assign(surface_.faces.size(), no_index);
  for (std::uint32_t face = 0; face < surface_.faces.size(); ++face) {
    if (gone_[face]) continue;
    faces[face] = static_cast<std::uint32_t>(kept.faces.size());
    const Corners& corners = surface_.faces[face];
    kept.faces.push_back({numbers[corners[0]], numbers[corners[1]], numbers[corners[2]]});
    kept.looks.push_back(surface_.looks[face]);
    if (!surface_.face_texture.empty()) kept.face_texture.push_back(surface_.face_texture[face]);
  }
  surface_ = {};
  return kept;
}

} // namespace nendo::deform
