#include "render/surface.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "render/exact_trig.hpp"

namespace nendo::render {

using Eigen::Vector3f;

void compute_normals(std::span<const Vector3f> places, std::span<const std::uint32_t> corners,
                     std::vector<Vector3f>& normals) {
  normals.assign(places.size(), Vector3f::Zero());
  for (std::size_t at = 0; at + 2 < corners.size(); at += 3) {
    const Vector3f& a = places[corners[at]];
    const Vector3f area = (places[corners[at + 1]] - a).cross(places[corners[at + 2]] - a);
    for (std::size_t corner = at; corner < at + 3; ++corner)
      normals[corners[corner]] += area;
  }
  for (auto& normal : normals) {
    const float length = normal.norm();
    normal = length > 0.0F && std::isfinite(length) ? Vector3f(normal / length) : Vector3f::Zero();
  }
}

namespace {

struct Ring {
  Vector3f middle;
  float radius = 0.0F;
  float lean = 0.0F; ///< the normal's coordinate along the axis, -1 to 1
};

// A surface of revolution, from its first ring to its last one.
void add_rings(Surface& surface, const std::vector<Ring>& rings, const Vector3f& axis, int sides) {
  const Vector3f other = std::abs(axis.y()) < 0.9F ? Vector3f::UnitY() : Vector3f::UnitX();
  const Vector3f u = axis.cross(other).normalized();
  const Vector3f v = axis.cross(u);
  const auto first = static_cast<std::uint32_t>(surface.places.size());
  for (const Ring& ring : rings) {
    const float outward = std::sqrt(std::max(0.0F, 1.0F - ring.lean * ring.lean));
    for (int side = 0; side < sides; ++side) {
      const double turn = 2.0 * std::numbers::pi * side / sides;
      const Vector3f out =
          static_cast<float>(exact_cosine(turn)) * u + static_cast<float>(exact_sine(turn)) * v;
      surface.places.emplace_back(ring.middle + ring.radius * out);
      surface.normals.emplace_back(outward * out + ring.lean * axis);
    }
  }
  const auto around = static_cast<std::uint32_t>(sides);
  for (std::uint32_t ring = 0; ring + 1 < rings.size(); ++ring)
    for (std::uint32_t side = 0; side < around; ++side) {
      const std::uint32_t a = first + ring * around + side;
      const std::uint32_t b = first + ring * around + (side + 1) % around;
      surface.corners.insert(surface.corners.end(), {a, b, b + around, a, b + around, a + around});
    }
}

// The half of a ball that looks along `sign` times the axis.
void add_cap(std::vector<Ring>& rings, const Vector3f& middle, const Vector3f& axis, float radius,
             bool begins, int steps) {
  for (int step = 0; step <= steps; ++step) {
    const int at = begins ? step - steps : step; // -steps to 0, or 0 to steps
    const double angle = std::numbers::pi / 2 * at / steps;
    const auto along = static_cast<float>(exact_sine(angle));
    rings.push_back(
        {middle + radius * along * axis, radius * static_cast<float>(exact_cosine(angle)), along});
  }
}

} // namespace

Surface part_of(const Surface& whole, const Material& material,
                const std::function<bool(std::span<const std::uint32_t, 3> corners)>& takes) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  Surface part{{}, {}, {}, material};
  std::vector<std::uint32_t> place_in_part(whole.places.size(), unused);
  for (std::size_t at = 0; at + 2 < whole.corners.size(); at += 3) {
    const std::span<const std::uint32_t, 3> corners(&whole.corners[at], 3);
    if (!takes(corners)) continue;
    for (const std::uint32_t from : corners) {
      std::uint32_t& place = place_in_part[from];
      if (place == unused) {
        place = static_cast<std::uint32_t>(part.places.size());
        part.places.push_back(whole.places[from]);
        part.normals.push_back(whole.normals[from]);
      }
      part.corners.push_back(place);
    }
  }
  return part;
}

void add_capsule(Surface& surface, const Vector3f& from, const Vector3f& to, float from_radius,
                 float to_radius, int sides) {
  const Vector3f way = to - from;
  const float length = way.norm();
  const Vector3f axis = length > 0.0F ? Vector3f(way / length) : Vector3f::UnitY();
  std::vector<Ring> rings;
  add_cap(rings, from, axis, from_radius, true, sides / 4);
  add_cap(rings, to, axis, to_radius, false, sides / 4);
  add_rings(surface, rings, axis, sides);
}

void add_sphere(Surface& surface, const Vector3f& middle, float radius, int sides) {
  add_capsule(surface, middle, middle, radius, radius, sides);
}

void add_arrow(Surface& surface, const Vector3f& from, const Vector3f& to, float width) {
  const Vector3f way = to - from;
  const float length = way.norm();
  if (!(length > width)) return;
  const Vector3f axis = way / length;
  const float head = std::min(3.5F * width, 0.6F * length);
  const Vector3f neck = to - head * axis;
  const float shaft = 0.5F * width;
  const float lean = 0.45F;
  add_rings(surface,
            {{from, 0.0F, -1.0F},
             {from, shaft, -1.0F},
             {from, shaft, 0.0F},
             {neck, shaft, 0.0F},
             {neck, shaft, -1.0F},
             {neck, 1.5F * width, -1.0F},
             {neck, 1.5F * width, lean},
             {to, 0.0F, lean}},
            axis, 16);
}

} // namespace nendo::render
