#pragma once
// Pictures of scenes, drawn by the processor: no screen, no GPU, the same bytes for the same input
// whatever the machine and however many threads. For documents and tests; a picture of a thousand
// pixels takes about a second.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/viewer/camera.hpp>
#include <nendo/viewer/image.hpp>
#include <nendo/viewer/scene.hpp>

namespace nendo::viewer {

/// Shadows of the key light and what of the sky each vertex sees; they do not depend on the camera.
class Lighting {
public:
  /// The lights stand about a camera that looks from that azimuth, so that any view has its form
  /// shown. The scene must not change while this is used. Takes some tenths of a second. Allocates.
  explicit Lighting(const Scene& scene, double azimuth_deg = 0.0);
  ~Lighting();
  Lighting(Lighting&&) noexcept;

  struct Maps;
  const Scene& scene() const noexcept { return *scene_; }
  const Maps& maps() const noexcept { return *maps_; }

private:
  const Scene* scene_;
  std::unique_ptr<Maps> maps_;
};

/// Four samples a pixel. Triangles that reach behind the camera are left out. Uses `threads`
/// threads; blocks.
Image draw(const Lighting& lighting, const Camera& camera, Size size, unsigned threads = 2);

/// White where the model or a hand covers a pixel's middle, black elsewhere: what tests compare
/// renderers by.
Image silhouette(const Scene& scene, const Camera& camera, Size size);

/// One picture of a sheet, and what is written under it.
struct Panel {
  Image image;
  std::string caption; ///< may be empty
};

/// All panels, which are of one size, row by row, `columns` in each; 0: as square as may be.
Image contact_sheet(const std::vector<Panel>& panels, int columns = 0);

} // namespace nendo::viewer
