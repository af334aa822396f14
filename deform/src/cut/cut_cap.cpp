#include "cut/cut_cap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nendo/deform/index.hpp>

namespace nendo::deform {
namespace {

double distance(const PlanePoint& a, const PlanePoint& b) noexcept {
  return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]));
}

struct PlaneBox {
  static constexpr double far = std::numeric_limits<double>::infinity();
  PlanePoint low{far, far}, high{-far, -far};
};

PlaneBox box_of(std::span<const CapLoop> loops) noexcept {
  PlaneBox box;
  for (const CapLoop& loop : loops)
    for (const PlanePoint& place : loop.places)
      for (std::size_t k = 0; k < 2; ++k) {
        box.low[k] = std::min(box.low[k], place[k]);
        box.high[k] = std::max(box.high[k], place[k]);
      }
  return box;
}

/// Points by the square cells in which they lie, for "is one nearer than this?".
class NearPlaces {
public:
  NearPlaces(const PlaneBox& box, double cell) : box_(box) {
    constexpr double most = 2048.0;
    const PlanePoint span{box.high[0] - box.low[0], box.high[1] - box.low[1]};
    cell_ = std::max(cell, std::max(span[0], span[1]) / most);
    for (std::size_t axis = 0; axis < 2; ++axis)
      counts_[axis] = static_cast<std::size_t>(span[axis] / cell_) + 1;
    heads_.assign(counts_[0] * counts_[1], no_index);
  }
  void add(const PlanePoint& place) {
    std::uint32_t& head = heads_[cell_at(place[1], 1) * counts_[0] + cell_at(place[0], 0)];
    places_.push_back({place, head});
    head = to_index(places_.size() - 1);
  }
  bool has_nearer(const PlanePoint& to, double than) const noexcept {
    const std::size_t last_x = cell_at(to[0] + than, 0), last_y = cell_at(to[1] + than, 1);
    for (std::size_t y = cell_at(to[1] - than, 1); y <= last_y; ++y)
      for (std::size_t x = cell_at(to[0] - than, 0); x <= last_x; ++x)
        for (std::uint32_t at = heads_[y * counts_[0] + x]; at != no_index; at = places_[at].next)
          if (distance(places_[at].place, to) < than) return true;
    return false;
  }

private:
  struct Linked {
    PlanePoint place;
    std::uint32_t next;
  };
  std::size_t cell_at(double coordinate, std::size_t axis) const noexcept {
    const double cells = std::max((coordinate - box_.low[axis]) / cell_, 0.0);
    return std::min(static_cast<std::size_t>(cells), counts_[axis] - 1);
  }

  PlaneBox box_;
  double cell_;
  std::array<std::size_t, 2> counts_{}; ///< of cells along each axis
  std::vector<std::uint32_t> heads_;
  std::vector<Linked> places_;
};

/// Calls visit(from, to) with the places of each segment of the rims.
template <class Visit>
void for_each_segment(std::span<const CapLoop> loops, const Visit& visit) {
  for (const CapLoop& loop : loops)
    for (std::size_t k = 0; k < loop.places.size(); ++k)
      visit(loop.places[k], loop.places[(k + 1) % loop.places.size()]);
}

PlanePoint part_way(const PlanePoint& from, const PlanePoint& to, double part) noexcept {
  return {(1.0 - part) * from[0] + part * to[0], (1.0 - part) * from[1] + part * to[1]};
}

/// All rims as points that are at most `step` apart.
NearPlaces sampled_rims(std::span<const CapLoop> loops, const PlaneBox& box, double step,
                        double cell) {
  NearPlaces places(box, cell);
  for_each_segment(loops, [&](const PlanePoint& from, const PlanePoint& to) {
    const int parts = 1 + static_cast<int>(std::min(distance(from, to) / step, 1000.0));
    for (int part = 0; part < parts; ++part)
      places.add(part_way(from, to, static_cast<double>(part) / parts));
  });
  return places;
}

/// A point beside each segment of the rims, inside, at half its length; none that is nearer to
/// another part of a rim or to another point of the row.
void add_rows(std::span<const CapLoop> loops, const std::vector<std::uint8_t>& on_left,
              const PlaneBox& box, ConstrainedTriangulation& plane) {
  double total = 0.0;
  std::size_t count = 0;
  for_each_segment(loops, [&](const PlanePoint& from, const PlanePoint& to) {
    total += distance(from, to);
    ++count;
  });
  const double mean = total / static_cast<double>(count);
  NearPlaces near = sampled_rims(loops, box, 0.3 * mean, mean);
  for (std::size_t number = 0; number < loops.size(); ++number) {
    const CapLoop& loop = loops[number];
    for (std::size_t k = 0; k < loop.places.size(); ++k) {
      const PlanePoint& from = loop.places[k];
      const PlanePoint& to = loop.places[(k + 1) % loop.places.size()];
      const double length = distance(from, to);
      const double deep = 0.5 * std::max(length, 0.5 * mean);
      const double along = (on_left[number] != 0 ? deep : -deep) / length;
      const PlanePoint place{(from[0] + to[0]) / 2.0 - along * (to[1] - from[1]),
                             (from[1] + to[1]) / 2.0 + along * (to[0] - from[0])};
      if (near.has_nearer(place, 0.9 * deep)) continue;
      if (plane.add(place) == PlaneFault::none) near.add(place);
    }
  }
}

/// Points of a triangular lattice inside, none near a rim.
void add_lattice(std::span<const CapLoop> loops, const PlaneBox& box, double edge,
                 ConstrainedTriangulation& plane) {
  const double height = edge * std::sqrt(0.75);
  const auto rows = static_cast<std::size_t>((box.high[1] - box.low[1]) / height) + 1;
  NearPlaces near = sampled_rims(loops, box, 0.5 * edge, edge);
  for (std::uint32_t number = 0; number < plane.point_count(); ++number)
    near.add(plane.point(number));
  const double first = box.low[1] + 0.5 * height;
  std::vector<std::vector<double>> rims_of_row(rows);
  for_each_segment(loops, [&](const PlanePoint& from, const PlanePoint& to) {
    const auto [low, high] = std::minmax(from[1], to[1]);
    const double begin = std::max(0.0, std::ceil((low - first) / height));
    for (auto row = static_cast<std::size_t>(begin); row < rows; ++row) {
      const double y = first + height * static_cast<double>(row);
      if (y >= high) break;
      if (y < low) continue;
      rims_of_row[row].push_back(from[0] + (y - from[1]) / (to[1] - from[1]) * (to[0] - from[0]));
    }
  });
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<double>& rims = rims_of_row[row];
    std::sort(rims.begin(), rims.end());
    const double y = first + height * static_cast<double>(row);
    const double offset = box.low[0] + (row % 2 == 0 ? 0.25 : 0.75) * edge;
    std::vector<PlanePoint> places;
    for (std::size_t k = 0; k + 1 < rims.size(); k += 2)
      for (double step = std::ceil((rims[k] - offset) / edge); offset + step * edge < rims[k + 1];
           ++step)
        places.push_back({offset + step * edge, y});
    // Back and forth, because the search for a point's triangle begins at the point before.
    if (row % 2 == 1) std::reverse(places.begin(), places.end());
    for (const PlanePoint& place : places)
      if (!near.has_nearer(place, 0.7 * edge)) plane.add(place);
  }
}

PlaneFault add_rims(std::span<const CapLoop> loops, ConstrainedTriangulation& plane) {
  for (const CapLoop& loop : loops)
    for (const PlanePoint& place : loop.places)
      if (const PlaneFault fault = plane.add(place); fault != PlaneFault::none) return fault;
  std::uint32_t first = 0;
  for (const CapLoop& loop : loops) {
    const auto count = to_index(loop.places.size());
    for (std::uint32_t k = 0; k < count; ++k)
      if (const PlaneFault fault = plane.constrain(first + k, first + (k + 1) % count);
          fault != PlaneFault::none)
        return fault;
    first += count;
  }
  return PlaneFault::none;
}

/// On which side of each loop the inside lies, by the triangles at its segments.
std::vector<std::uint8_t> sides_of(std::span<const CapLoop> loops,
                                   const std::vector<Corners>& triangles) {
  struct Neighbour {
    std::uint32_t loop, next;
  };
  std::vector<Neighbour> after;
  for (std::uint32_t number = 0; number < loops.size(); ++number) {
    const auto first = to_index(after.size());
    const auto count = static_cast<std::uint32_t>(loops[number].places.size());
    for (std::uint32_t k = 0; k < count; ++k)
      after.push_back({number, first + (k + 1) % count});
  }
  std::vector<std::uint8_t> on_left(loops.size(), 0);
  for (const Corners& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (triangle[k] < after.size() && after[triangle[k]].next == triangle[(k + 1) % 3])
        on_left[after[triangle[k]].loop] = 1;
  return on_left;
}

} // namespace

Cap make_cap(std::span<const CapLoop> loops, std::uint32_t crossings, const CapOptions& options) {
  Cap cap;
  if (loops.empty()) return cap;
  const PlaneBox box = box_of(loops);
  ConstrainedTriangulation plane(box.low, box.high);
  cap.fault = add_rims(loops, plane);
  if (cap.fault != PlaneFault::none) return cap;
  const auto rim = to_index(plane.point_count());
  if (options.bends) add_rows(loops, sides_of(loops, plane.triangles(PlaneFill::odd)), box, plane);
  if (options.edge > 0.0) add_lattice(loops, box, options.edge, plane);
  plane.improve();
  cap.triangles = plane.triangles(PlaneFill::odd);
  cap.on_left = sides_of(loops, cap.triangles);
  std::vector<std::uint32_t> corner_of(plane.point_count(), no_index);
  std::uint32_t number = 0;
  for (const CapLoop& loop : loops)
    for (const std::uint32_t crossing : loop.crossings)
      corner_of[number++] = crossing;
  for (Corners& triangle : cap.triangles)
    for (std::uint32_t& corner : triangle) {
      if (corner >= rim && corner_of[corner] == no_index) {
        corner_of[corner] = crossings + to_index(cap.inner.size());
        cap.inner.push_back(plane.point(corner));
      }
      corner = corner_of[corner];
    }
  return cap;
}

} // namespace nendo::deform
