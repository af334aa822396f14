#pragma once
// Times frames as the paper's Table 1 did: each one has the deformation with the linear polynomial
// p(x), the normals of all vertices, and the drawing.

#include <array>
#include <memory>

#include <nendo/deform/mesh.hpp>

#include "render/image.hpp"

namespace nendo::bench {

/// Describes the drawing of a whole frame.
inline constexpr auto whole_frame_drawing = "640x480 pixels by the processor";

class WholeFrame {
public:
  /// Keeps the mesh, which must outlive it. `starts`: 3 by 10. Allocates.
  WholeFrame(const deform::Mesh& mesh, const deform::Points& starts, double radius);
  ~WholeFrame();

  /// Measures for about this number of seconds, but at least one turn of each type. Returns the
  /// frames per second of Type-1 and Type-2, on one thread.
  std::array<double, 2> measure(double seconds);
  /// Returns the last picture, or null before the first.
  const render::Image* picture() const noexcept;
  /// Returns how much of the last picture the plane covers, 0 to 1.
  double covered_share() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::bench
