// JPEG files, by libjpeg-turbo.

#include "render/jpeg.hpp"

#include <memory>

#include <turbojpeg.h>

namespace nendo::render {

std::optional<Image> decode_jpeg(std::string_view contents) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), &tjDestroy);
  if (!decoder) return std::nullopt;
  const auto* const bytes = reinterpret_cast<const unsigned char*>(contents.data());
  Size size;
  int sampling = 0;
  int space = 0;
  if (tjDecompressHeader3(decoder.get(), bytes, contents.size(), &size.width, &size.height,
                          &sampling, &space) != 0)
    return std::nullopt;
  if (size.width < 1 || size.height < 1 || size.width > Size::most || size.height > Size::most)
    return std::nullopt;
  std::vector<Pixel> pixels(static_cast<std::size_t>(size.width) *
                            static_cast<std::size_t>(size.height));
  // A hostile file may have scans without end.
  const int flags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;
  const int done = tjDecompress2(decoder.get(), bytes, contents.size(), pixels.front().data(),
                                 size.width, 0, size.height, TJPF_RGB, flags);
  if (done != 0 && tjGetErrorCode(decoder.get()) != TJERR_WARNING) return std::nullopt;
  return Image(size, std::move(pixels));
}

} // namespace nendo::render
