#include "render/picture_kind.hpp"

#include <array>
#include <cstddef>

#include "render/tga_bmp.hpp"

namespace nendo::render {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::size_t at;
  std::string_view bytes;
  std::string_view format;
};

constexpr std::array signatures{
    Signature{8, "WEBP"sv, "a WebP picture"},
    Signature{0, "\xABKTX 20\xBB"sv, "a KTX2 texture"},
    Signature{0, "\xABKTX 11\xBB"sv, "a KTX texture"},
    Signature{0, "sB\x13\x00"sv, "a Basis texture"},
    Signature{0, "DDS "sv, "a DDS texture"},
    Signature{0, "II*\0"sv, "a TIFF picture"},
    Signature{0, "MM\0*"sv, "a TIFF picture"},
    Signature{0, "II+\0"sv, "a TIFF picture"},
    Signature{0, "8BPS"sv, "a Photoshop picture"},
    Signature{0, "v/1\x01"sv, "an OpenEXR picture"},
    Signature{0, "#?RADIANCE"sv, "a Radiance picture"},
    Signature{0, "#?RGBE"sv, "a Radiance picture"},
    Signature{0, "GIF8"sv, "a GIF picture"},
    Signature{4, "ftypavif"sv, "an AVIF picture"},
    Signature{4, "ftyphei"sv, "a HEIC picture"},
    Signature{4, "ftypmif1"sv, "a HEIC picture"},
    Signature{0, "\0\0\0\x0CjP  "sv, "a JPEG 2000 picture"},
    Signature{0, "\xFFO\xFFQ"sv, "a JPEG 2000 picture"},
    Signature{0, "\xFF\x0A"sv, "a JPEG XL picture"},
    Signature{0, "\0\0\0\x0CJXL "sv, "a JPEG XL picture"},
    Signature{0, "gimp xcf"sv, "a GIMP picture"},
    Signature{0, "%PDF"sv, "a PDF document"},
    Signature{0, "<svg"sv, "an SVG drawing"},
    Signature{0, "version https://git-lfs"sv, "a pointer of Git LFS"},
    Signature{0, "<!DOCTYPE"sv, "an HTML page"},
    Signature{0, "<!doctype"sv, "an HTML page"},
    Signature{0, "<html"sv, "an HTML page"},
};

} // namespace

PictureKind picture_kind_of(std::string_view contents) noexcept {
  if (contents.starts_with("\x89PNG\r\n\x1A\n")) return PictureKind::png;
  if (contents.starts_with("\xFF\xD8\xFF")) return PictureKind::jpeg;
  if (is_bmp(contents)) return PictureKind::bmp;
  // TGA has no mark, and one may begin like another format by chance.
  if (foreign_format_of(contents).empty() && is_tga(contents)) return PictureKind::tga;
  return PictureKind::none;
}

std::string_view foreign_format_of(std::string_view contents) noexcept {
  for (const Signature& signature : signatures)
    if (contents.size() > signature.at &&
        contents.substr(signature.at).starts_with(signature.bytes))
      return signature.format;
  return {};
}

} // namespace nendo::render
