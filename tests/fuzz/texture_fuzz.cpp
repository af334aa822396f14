// Whatever the bytes are, a texture's file gives a sentence, or a picture of as many pixels as it
// says; and the PNG that browsers get of it is that picture.

#include <cstdint>
#include <memory>
#include <string>

#include "laws.hpp"
#include "render/texture_image.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nendo::render;
  const auto contents =
      std::make_shared<const std::string>(reinterpret_cast<const char*>(data), size);
  const auto image = decode_picture(*contents);
  if (!image) {
    require(!image.error().message.empty());
    return 0;
  }
  require(image->size().width > 0 && image->size().width <= Size::most);
  require(image->size().height > 0 && image->size().height <= Size::most);
  require(image->pixels().size() == static_cast<std::size_t>(image->size().width) *
                                        static_cast<std::size_t>(image->size().height));
  constexpr std::size_t few = 1 << 16; // a larger one takes long
  if (image->pixels().size() > few) return 0;
  const auto png = as_png_or_jpeg(contents);
  require(png != nullptr);
  if (png == contents) return 0;
  const auto same = decode_picture(*png);
  require(same && same->pixels() == image->pixels());
  return 0;
}
