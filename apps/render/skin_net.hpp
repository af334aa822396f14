#pragma once
// Triangles about a shape that is given by its distance.

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Geometry>

namespace nendo::render {

/// Returns a distance, negative inside, in metres.
using DistanceAt = std::function<float(const Eigen::Vector3f&)>;

struct SkinMesh {
  std::vector<Eigen::Vector3f> places;
  std::vector<std::uint32_t> corners; ///< three for each triangle, counter-clockwise from outside
};

/// What is known of a distance: |distance(a) - distance(b)| <= steepness * |a - b| + slack_m.
struct Steepness {
  float steepness = 1.0F;
  float slack_m = 0.0F;
};

/// Returns the surface where the distance is zero, which must lie within the box and be thicker
/// than a cell. It is closed, has about 1.3 places for each square of a cell's side, and its
/// triangles are nearly even. Allocates.
SkinMesh net_about(const DistanceAt& distance, const Steepness& known,
                   const Eigen::AlignedBox3f& box, float cell_m);

/// Returns for each place those that it shares an edge with.
std::vector<std::vector<std::uint32_t>> neighbours_in(const SkinMesh& mesh);

} // namespace nendo::render
