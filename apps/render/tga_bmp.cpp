// stb_image trusts some numbers of a header, and reads memory that it has not filled where a file
// is cut off or a palette is short. So headers are checked here, and palettes are made whole.

#include "render/image.hpp"

#include <cstdlib>
#include <cstring>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_NO_SIMD
#define STBI_NO_FAILURE_STRINGS
#define STBI_NO_THREAD_LOCALS
#define STBI_MAX_DIMENSIONS 8192
#include <stb/stb_image.h>

namespace nendo::render {
namespace {

static_assert(Size::most == STBI_MAX_DIMENSIONS);

Error not_shown(const std::string& why) {
  return {Errc::bad_input, why};
}

Error cut_off() {
  return not_shown("is cut off; export it once more");
}

/// Bytes beyond the end are 0.
std::uint32_t number_at(std::string_view bytes, std::size_t at, std::size_t width) noexcept {
  std::uint32_t number = 0;
  for (std::size_t k = 0; k < width && at + k < bytes.size(); ++k)
    number |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return number;
}

Result<Image> decode_by_stb(std::string_view contents) {
  Size size;
  int channels = 0;
  constexpr int wanted = 3;
  const std::unique_ptr<stbi_uc, void (*)(void*)> decoded(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(contents.data()),
                            static_cast<int>(contents.size()), &size.width, &size.height, &channels,
                            wanted),
      &std::free);
  if (!decoded) return not_shown("is damaged or of a rare kind; save it as PNG");
  std::vector<Pixel> pixels(static_cast<std::size_t>(size.width) *
                            static_cast<std::size_t>(size.height));
  std::memcpy(pixels.data(), decoded.get(), pixels.size() * sizeof(Pixel));
  return Image(size, std::move(pixels));
}

constexpr std::size_t max_bytes = std::size_t{1} << 30; // stb counts in int
constexpr std::size_t bmp_file_header = 14;
constexpr std::size_t tga_header = 18;

struct BmpHeader {
  std::size_t offset = 0; ///< position of the pixels
  std::size_t size = 0;   ///< bytes of the second header
  std::int64_t width = 0, height = 0;
  std::size_t bits = 0; ///< per pixel
  std::uint32_t compression = 0;

  /// Returns the bytes per entry of the palette.
  std::size_t entry_bytes() const noexcept { return size == 12 ? 3 : 4; }
};

BmpHeader bmp_header_of(std::string_view contents) noexcept {
  BmpHeader header;
  header.offset = number_at(contents, 10, 4);
  header.size = number_at(contents, 14, 4);
  if (header.size == 12) {
    header.width = number_at(contents, 18, 2);
    header.height = number_at(contents, 20, 2);
    header.bits = number_at(contents, 24, 2);
  } else {
    header.width = static_cast<std::int32_t>(number_at(contents, 18, 4));
    header.height = static_cast<std::int32_t>(number_at(contents, 22, 4));
    header.bits = number_at(contents, 28, 2);
    header.compression = number_at(contents, 30, 4);
  }
  if (header.height < 0) header.height = -header.height; // from the top
  return header;
}

/// The file with a palette of as many colours as its pixels can name, directly before the pixels.
std::string with_whole_palette(std::string_view contents, const BmpHeader& header) {
  const std::size_t headers = bmp_file_header + header.size;
  const std::size_t whole = (std::size_t{1} << header.bits) * header.entry_bytes();
  std::string palette(contents.substr(headers, header.offset - headers));
  palette.resize(whole, '\0');
  std::string file(contents.substr(0, headers));
  const std::size_t offset = headers + whole;
  for (std::size_t k = 0; k < 4; ++k)
    file[10 + k] = static_cast<char>(offset >> (8 * k) & 0xFF);
  return file + palette + std::string(contents.substr(header.offset));
}

/// How many bytes the pixels of a TGA have at least.
std::size_t min_tga_bytes(std::string_view contents) noexcept {
  const std::size_t pixels =
      std::size_t{number_at(contents, 12, 2)} * std::size_t{number_at(contents, 14, 2)};
  const std::size_t pixel_bytes = (number_at(contents, 16, 1) + 7) / 8;
  const bool is_run_length = number_at(contents, 2, 1) >= 9;
  if (!is_run_length) return pixels * pixel_bytes;
  constexpr std::size_t max_run = 128;
  return (pixels + max_run - 1) / max_run * (1 + pixel_bytes);
}

void mirror(Image& image) {
  for (int y = 0; y < image.size().height; ++y)
    for (int x = 0; x < image.size().width / 2; ++x)
      std::swap(image.at(x, y), image.at(image.size().width - 1 - x, y));
}

} // namespace

bool is_bmp(std::string_view contents) noexcept {
  if (!contents.starts_with("BM") || contents.size() < 30) return false;
  const std::uint32_t size = number_at(contents, 14, 4);
  return size >= 12 && size <= 124;
}

bool is_tga(std::string_view contents) noexcept {
  if (contents.size() < tga_header) return false;
  const std::uint32_t has_palette = number_at(contents, 1, 1);
  const std::uint32_t type = number_at(contents, 2, 1);
  const std::uint32_t palette_bits = number_at(contents, 7, 1);
  const std::uint32_t bits = number_at(contents, 16, 1);
  const auto is_depth = [](std::uint32_t of) {
    return of == 15 || of == 16 || of == 24 || of == 32;
  };
  if (number_at(contents, 12, 2) == 0 || number_at(contents, 14, 2) == 0) return false;
  if (type == 1 || type == 9)
    return has_palette == 1 && is_depth(palette_bits) && (bits == 8 || bits == 16);
  if (type == 2 || type == 10) return has_palette <= 1 && is_depth(bits);
  return (type == 3 || type == 11) && has_palette <= 1 && (bits == 8 || bits == 16);
}

Result<Image> decode_bmp(std::string_view contents) {
  const BmpHeader header = bmp_header_of(contents);
  if (header.compression == 1 || header.compression == 2)
    return not_shown("is a BMP with run lengths, which is not read; save it as PNG");
  if (header.width < 1 || header.height < 1) return not_shown("is damaged; export it once more");
  if (header.width > Size::most || header.height > Size::most) return too_many_pixels();
  if (header.offset > contents.size() || contents.size() > max_bytes ||
      header.offset < bmp_file_header + header.size)
    return cut_off();
  const auto row_bits = static_cast<std::size_t>(header.width) * header.bits;
  const std::size_t row_bytes = (row_bits + 31) / 32 * 4;
  if (row_bytes * static_cast<std::size_t>(header.height) > contents.size() - header.offset)
    return cut_off();
  if (header.bits == 1 || header.bits == 4 || header.bits == 8)
    return decode_by_stb(with_whole_palette(contents, header));
  return decode_by_stb(contents);
}

Result<Image> decode_tga(std::string_view contents) {
  if (number_at(contents, 12, 2) > Size::most || number_at(contents, 14, 2) > Size::most)
    return too_many_pixels();
  const std::size_t palette_bytes =
      number_at(contents, 1, 1) == 0
          ? 0
          : std::size_t{number_at(contents, 5, 2)} * ((number_at(contents, 7, 1) + 7) / 8);
  const std::size_t before = tga_header + number_at(contents, 0, 1) + palette_bytes;
  if (contents.size() > max_bytes || before > contents.size() ||
      min_tga_bytes(contents) > contents.size() - before)
    return cut_off();
  auto image = decode_by_stb(contents);
  constexpr std::uint32_t from_the_right = 0x10;
  if (image && (number_at(contents, 17, 1) & from_the_right) != 0) mirror(*image);
  return image;
}

} // namespace nendo::render
