#pragma once
// Joins overlapping parts into one: an exact union, with a sharp or blended seam. JOINING.md
// describes the algorithm and its guarantees.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct JoinPart {
  const Mesh* mesh = nullptr;
  std::string name; ///< name in messages
};

struct JoinOptions {
  /// Blend width of the seam to each side, along the surface, in model units; 0: sharp.
  double seam_width = 0.0;
};

/// The result of joining one more part.
struct JoinStep {
  std::size_t crossings = 0; ///< points where an edge of one part crosses a face of the other
  bool swallowed = false;    ///< one part is inside the other, and disappears
  /// The seam's actual width: less than requested if the seam would intersect itself, and 0 if it
  /// would do so even at a quarter of the request.
  double seam_width = 0.0;
  double sharp_volume = 0.0; ///< volume of the union before the seam was blended
  double volume = 0.0;
  /// Upper bound of the difference of both volumes: the area of the faces that the blend moved,
  /// times the max displacement.
  double volume_bound = 0.0;
};

struct Joined {
  Mesh mesh;                   ///< triangles
  std::vector<JoinStep> steps; ///< one per part after the first
};

/// Joins the parts one after another. The result is closed, two-manifold, and free of
/// self-intersections that the parts did not have; this is verified. Vertices outside the seam keep
/// their bits, in the order of the parts; faces become triangles, which keep their texture
/// coordinates, colours, materials, groups and objects. Deterministic to the bit. Errors: bad_input
/// (a part is not closed or not two-manifold, faces inwards, or is too large or too small to
/// compute with), failed (parts do not touch, or no union was found). Does not change the parts.
/// Allocates; blocks for about 80 ms with two parts of 30,000 triangles.
NENDO_API Result<Joined> join(std::span<const JoinPart> parts, const JoinOptions& options);

} // namespace nendo::deform
