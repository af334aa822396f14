#pragma once
// Joins parts that overlap into one: an exact union, with a seam from sharp to smeared. What it
// guarantees, and how it works, says JOINING.md.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct JoinPart {
  const Mesh* mesh = nullptr;
  std::string name; ///< what messages call it
};

struct JoinOptions {
  /// Blend width of the seam to each side, along the surface, in model units; 0: sharp.
  double seam_width = 0.0;
};

/// What one more part did.
struct JoinStep {
  std::size_t crossings = 0; ///< points at which an edge of one goes through a face of the other
  bool swallowed = false; ///< one of both lies wholly inside of the other, so nothing of it is left
  /// The width that the seam has: less than was asked for if it would cut itself otherwise, and 0
  /// if it would at a quarter of it.
  double seam_width = 0.0;
  double sharp_volume = 0.0; ///< the union's before the seam was smeared
  double volume = 0.0;
  /// By how much these two can differ at most: the area of the faces that the smear moved, times
  /// the farthest motion.
  double volume_bound = 0.0;
};

struct Joined {
  Mesh mesh;                   ///< triangles
  std::vector<JoinStep> steps; ///< one less than the parts
};

/// Joins the parts one after another. The result is closed, two-manifold, and free of
/// self-intersections that the parts did not have; it is checked before it is handed out. Vertices
/// that are not at the seam keep their bits and come in the order of the parts; faces become
/// triangles, which keep their texture coordinates, colours, materials, groups and objects. The
/// same parts make the same bits.
/// Errors: bad_input (a part is not closed or not two-manifold, faces inwards, or is too large or
/// too small to compute with), failed (parts do not touch, or no union was found). The parts stay
/// as they were. Allocates; blocks for some 80 ms with two parts of 30,000 triangles.
NENDO_API Result<Joined> join(std::span<const JoinPart> parts, const JoinOptions& options);

} // namespace nendo::deform
