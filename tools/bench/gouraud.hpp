#pragma once
// Draws a surface on the processor as graphics cards did in 2004: the light is computed at the
// vertices and interpolated between them (Gouraud), with one sample a pixel, a depth buffer and no
// shadows. It takes milliseconds where draw() takes a second, so a frame's drawing can be timed on
// a machine without a graphics card.

#include <array>
#include <vector>

#include "render/camera.hpp"
#include "render/image.hpp"
#include "render/raster.hpp"
#include "render/surface.hpp"

namespace nendo::bench {

class GouraudRenderer {
public:
  /// Allocates for pictures of that size.
  explicit GouraudRenderer(render::Size size);

  /// Draws the surface, which needs a normal for each place. Both sides of a triangle are lit.
  /// Triangles that reach behind the camera are left out. The image is valid until the next call.
  /// Allocates if the surface has more places than any before.
  const render::Image& draw(const render::Surface& surface, const render::Camera& camera);

private:
  /// A vertex as the camera sees it.
  struct Corner {
    render::GridCorner at;
    float inverse_depth = 0.0F; ///< 0: behind the camera
    Eigen::Vector3f colour;     ///< encoded, 0 to 255
  };

  void clear();
  void see(const render::Surface& surface, const render::Camera& camera);
  void fill(const std::array<const Corner*, 3>& corners);

  render::Image image_;
  std::vector<render::Pixel> empty_row_colours_; ///< the background, a colour for each row
  std::vector<float> nearest_;                   ///< inverse depths; 0 where there is nothing
  std::vector<Corner> corners_;
};

} // namespace nendo::bench
