#pragma once
// Draws pictures of scenes on the processor, without a screen or a GPU. The same input gives the
// same bytes on any machine and with any number of threads. It is meant for documents and tests: a
// picture a thousand pixels wide takes some tenths of a second, and that of a million triangles
// about 2 seconds.

#include <memory>
#include <string>
#include <vector>

#include "render/camera.hpp"
#include "render/image.hpp"
#include "render/scene.hpp"

namespace nendo::render {

/// The shadows of the key light, and how much of the sky each vertex sees. Neither depends on the
/// camera.
class Lighting {
public:
  /// Places the lights relative to a camera that looks from that azimuth, so that every view shows
  /// the shapes well. The scene must not change while this is used. Uses `threads` threads. Takes
  /// some tenths of a second; above a million triangles, about a second. Allocates. `samples` are
  /// those of the key light's shadow along a side; 512 are enough for pictures of 100 pixels.
  explicit Lighting(const Scene& scene, double azimuth_deg = 0.0, unsigned threads = 2,
                    int samples = 2048);
  ~Lighting();
  Lighting(Lighting&&) noexcept;

  struct Maps;
  const Scene& scene() const noexcept { return *scene_; }
  const Maps& maps() const noexcept { return *maps_; }

private:
  const Scene* scene_;
  std::unique_ptr<Maps> maps_;
};

/// Draws a picture with four samples for each pixel. Triangles that reach behind the camera are
/// left out. Uses `threads` threads. Blocks.
Image draw(const Lighting& lighting, const Camera& camera, Size size, unsigned threads = 2);

/// Returns a picture that is white where the model or a hand covers the middle of a pixel, and
/// black elsewhere. Tests compare renderers by it.
Image silhouette(const Scene& scene, const Camera& camera, Size size);

/// One picture of a sheet and the caption below it.
struct Panel {
  Image image;
  std::string caption; ///< may be empty
};

/// Arranges the panels, which must have the same size, row by row with `columns` in each row. With
/// 0 columns the sheet is as square as possible.
Image contact_sheet(const std::vector<Panel>& panels, int columns = 0);

} // namespace nendo::render
