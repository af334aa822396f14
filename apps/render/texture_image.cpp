#include "render/texture_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <turbojpeg.h>

namespace nendo::render {

using Eigen::Vector3f;

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

struct DecodedJpeg {
  Image image;
  bool is_whole = true; ///< false: some of it is damaged, or, where the file is cut off, grey
};

using Decoder = std::unique_ptr<void, int (*)(tjhandle)>;

Error damaged_jpeg() {
  return {Errc::bad_input, "is a damaged JPEG picture; export it once more"};
}

const unsigned char* bytes_of(std::string_view contents) noexcept {
  return reinterpret_cast<const unsigned char*>(contents.data());
}

/// Errors end a sentence that begins with the file's name.
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

// The linear value of each byte (IEC 61966-2-1). In double, so that every machine rounds alike.
const std::array<float, 256>& linear_bytes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t byte = 0; byte < values.size(); ++byte) {
      const double part = static_cast<double>(byte) / 255.0;
      values[byte] = static_cast<float>(part <= 0.04045 ? part / 12.92
                                                        : std::pow((part + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  return table;
}

Image halved(const Image& image) {
  const Size size{std::max(1, image.size().width / 2), std::max(1, image.size().height / 2)};
  Image half(size);
  const int right = image.size().width > 1 ? 1 : 0;
  const int below = image.size().height > 1 ? 1 : 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto of = [&](int dx, int dy) {
          return static_cast<int>(image.at(x + (x + dx), y + (y + dy))[channel]);
        };
        half.at(x, y)[channel] = static_cast<std::uint8_t>(
            (of(0, 0) + of(right, 0) + of(0, below) + of(right, below) + 2) / 4);
      }
  return half;
}

/// A coordinate's pixel and the next one, and how much of the next one there is.
struct Between {
  int first, second;
  float share;
};

Between between(float part, int count) noexcept {
  const float wrapped = part - std::floor(part); // 0 to 1; NaN and infinity are caught below
  const float at = wrapped * static_cast<float>(count) - 0.5F;
  if (!(at > -1.0F && at < static_cast<float>(count))) return {0, 0, 0.0F};
  const float whole = std::floor(at);
  const int first = static_cast<int>(whole);
  return {(first + count) % count, (first + 1) % count, at - whole};
}

/// The longer side that a PNG's header says, in pixels; 0 if there is none.
std::uint32_t longer_side_of_png(std::string_view contents) noexcept {
  constexpr std::size_t width_at = 16, height_at = 20;
  if (contents.size() < height_at + 4) return 0;
  const auto number_at = [&](std::size_t at) {
    std::uint32_t number = 0; // the most significant byte first
    for (std::size_t k = 0; k < 4; ++k)
      number = number << 8 | static_cast<unsigned char>(contents[at + k]);
    return number;
  };
  const std::uint32_t width = number_at(width_at), height = number_at(height_at);
  return width == 0 || height == 0 ? 0 : std::max(width, height);
}

/// Returns whether a picture's header and end show that it is whole, for decoding a large one twice
/// would be felt. A PNG ends with its mark; a JPEG has its mark nowhere among the pixels, though
/// one that belongs to a small picture may come before them. Others are quick to decode.
bool looks_whole(std::string_view contents) {
  const PictureKind kind = picture_kind_of(contents);
  if (kind == PictureKind::jpeg) {
    constexpr std::size_t before_pixels = std::size_t{1} << 16;
    return read_header(Decoder(tjInitDecompress(), &tjDestroy), contents) &&
           contents.find("\xFF\xD9", before_pixels) != std::string_view::npos;
  }
  if (kind != PictureKind::png) return false;
  constexpr std::size_t end_bytes = 12;
  const std::uint32_t side = longer_side_of_png(contents);
  return side >= 1 && side <= Size::most &&
         contents.substr(contents.size() - end_bytes).find("IEND") != std::string_view::npos;
}

Result<Image> decode_png_texture(std::string_view contents) {
  auto image = decode_png(contents, "texture");
  if (image) return image;
  if (longer_side_of_png(contents) > Size::most) return too_many_pixels();
  return Error{Errc::bad_input, "is a damaged PNG picture; export it once more"};
}

// Of a file that is not decoded here, with its article; empty if it is not known either.
std::string_view foreign_format_of(std::string_view contents) noexcept {
  for (const Signature& signature : signatures)
    if (contents.size() > signature.at &&
        contents.substr(signature.at).starts_with(signature.bytes))
      return signature.format;
  return {};
}

} // namespace

PictureKind picture_kind_of(std::string_view contents) noexcept {
  if (contents.starts_with("\x89PNG\r\n\x1A\n")) return PictureKind::png;
  if (contents.starts_with("\xFF\xD8\xFF")) return PictureKind::jpeg;
  if (is_bmp(contents)) return PictureKind::bmp;
  // TGA has no mark, and one may begin like another format by chance.
  if (foreign_format_of(contents).empty() && is_tga(contents)) return PictureKind::tga;
  return PictureKind::none;
}

Result<Image> decode_picture(std::string_view contents) {
  switch (picture_kind_of(contents)) {
  case PictureKind::png:
    return decode_png_texture(contents);
  case PictureKind::jpeg: {
    auto decoded = decode_jpeg(contents);
    if (!decoded) return decoded.error();
    return std::move(decoded->image);
  }
  case PictureKind::bmp:
    return decode_bmp(contents);
  case PictureKind::tga:
    return decode_tga(contents);
  case PictureKind::none:
    break;
  }
  const std::string format(foreign_format_of(contents));
  if (format.empty())
    return Error{Errc::bad_input, "is no picture; PNG, JPEG, TGA and BMP are read"};
  if (format == "a pointer of Git LFS")
    return Error{Errc::bad_input, "is a pointer of Git LFS; `git lfs pull` fetches the picture"};
  if (format == "an HTML page")
    return Error{Errc::bad_input, "is an HTML page; download the picture itself"};
  return Error{Errc::bad_input, "is " + format + ", which is not read; save it as PNG or JPEG"};
}

std::string fault_of_picture(std::string_view contents) {
  constexpr std::size_t large = std::size_t{4} << 20;
  if (contents.size() > large && looks_whole(contents)) return "";
  if (picture_kind_of(contents) == PictureKind::jpeg) {
    const auto decoded = decode_jpeg(contents);
    if (!decoded) return decoded.error().message;
    return decoded->is_whole ? "" : "is a damaged JPEG picture; what can be read of it is shown";
  }
  const auto image = decode_picture(contents);
  return image ? "" : image.error().message;
}

std::shared_ptr<const std::string>
as_png_or_jpeg(const std::shared_ptr<const std::string>& contents) {
  if (!contents) return nullptr;
  const PictureKind kind = picture_kind_of(*contents);
  if (kind == PictureKind::none) return nullptr;
  if (kind == PictureKind::png || kind == PictureKind::jpeg) return contents;
  const auto image = decode_picture(*contents);
  if (!image) return nullptr;
  auto png = png_of(*image);
  return png ? std::make_shared<const std::string>(*std::move(png)) : nullptr;
}

TextureImage::TextureImage(Image image) {
  levels_.push_back(std::move(image));
  while (levels_.back().size().width > 1 || levels_.back().size().height > 1)
    levels_.push_back(halved(levels_.back()));
}

Vector3f TextureImage::colour_at(const Eigen::Vector2f& uv, float span_pixels) const noexcept {
  std::size_t level = 0;
  for (float span = span_pixels; span > 1.5F && level + 1 < levels_.size(); span /= 2.0F)
    ++level;
  const Image& image = levels_[level];
  const Between x = between(uv.x(), image.size().width);
  const Between y = between(1.0F - uv.y(), image.size().height);
  const auto& linear = linear_bytes();
  Vector3f colour;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const auto of = [&](int column, int row) { return linear[image.at(column, row)[channel]]; };
    const float upper =
        of(x.first, y.first) + x.share * (of(x.second, y.first) - of(x.first, y.first));
    const float lower =
        of(x.first, y.second) + x.share * (of(x.second, y.second) - of(x.first, y.second));
    colour[static_cast<Eigen::Index>(channel)] = upper + y.share * (lower - upper);
  }
  return colour;
}

} // namespace nendo::render
