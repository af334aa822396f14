// JPEG files, by libjpeg-turbo.

#include "render/jpeg.hpp"

#include <memory>
#include <vector>

#include <turbojpeg.h>

namespace nendo::render {

namespace {

using Decoder = std::unique_ptr<void, int (*)(tjhandle)>;

Error damaged_jpeg() {
  return {Errc::bad_input, "is a damaged JPEG picture; export it once more"};
}

const unsigned char* bytes_of(std::string_view contents) noexcept {
  return reinterpret_cast<const unsigned char*>(contents.data());
}

Result<Size> read_header(const Decoder& decoder, std::string_view contents) {
  if (!decoder) return Error{Errc::bad_input, "cannot be decoded, for want of memory"};
  Size size;
  int sampling = 0;
  int space = 0;
  if (tjDecompressHeader3(decoder.get(), bytes_of(contents), contents.size(), &size.width,
                          &size.height, &sampling, &space) != 0 ||
      size.width < 1 || size.height < 1)
    return damaged_jpeg();
  if (space == TJCS_CMYK || space == TJCS_YCCK)
    return Error{Errc::bad_input, "is a JPEG in CMYK, which is not read; save it in RGB"};
  if (size.width > Size::most || size.height > Size::most) return too_many_pixels();
  return size;
}

} // namespace

Result<Size> size_of_jpeg(std::string_view contents) {
  return read_header(Decoder(tjInitDecompress(), &tjDestroy), contents);
}

Result<DecodedJpeg> decode_jpeg(std::string_view contents) {
  const Decoder decoder(tjInitDecompress(), &tjDestroy);
  const auto size = read_header(decoder, contents);
  if (!size) return size.error();
  std::vector<Pixel> pixels(static_cast<std::size_t>(size->width) *
                            static_cast<std::size_t>(size->height));
  // A hostile file may have scans without end.
  const int flags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;
  const int done =
      tjDecompress2(decoder.get(), bytes_of(contents), contents.size(), pixels.front().data(),
                    size->width, 0, size->height, TJPF_RGB, flags);
  if (done != 0 && tjGetErrorCode(decoder.get()) != TJERR_WARNING) return damaged_jpeg();
  return DecodedJpeg{Image(*size, std::move(pixels)), done == 0};
}

} // namespace nendo::render
