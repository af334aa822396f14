// Whatever the text is, camera_from_toml gives an error or a camera that can be used, and that is
// written and read back to the same text.

#include <cmath>
#include <cstdint>
#include <string>

#include "laws.hpp"
#include "markers/camera_model.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nendo::markers;
  const auto camera = camera_from_toml(text_of(data, size), "fuzz");
  if (!camera) {
    require_one_line(camera.error());
    return 0;
  }
  require(camera->width_px >= 16 && camera->height_px >= 16);
  for (const double number : camera->matrix().val)
    require(std::isfinite(number));
  for (const double number : camera->distortion)
    require(std::isfinite(number));
  require(static_cast<bool>(scaled_to(*camera, 2 * camera->width_px, 2 * camera->height_px)));
  const std::string written = to_toml(*camera);
  const auto back = camera_from_toml(written, "back");
  require(back && to_toml(*back) == written);
  return 0;
}
