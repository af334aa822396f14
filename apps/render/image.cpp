#include "render/image.hpp"

#include <algorithm>

#include <png.h>

#include <nendo/base/files.hpp>
#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

namespace nendo::render {

namespace {

constexpr std::uint64_t max_png_bytes = std::uint64_t{256} << 20;

png_image header_of(Size size) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(size.width);
  header.height = static_cast<png_uint_32>(size.height);
  header.format = PNG_FORMAT_RGB;
  return header;
}

} // namespace

std::optional<Size> size_named(std::string_view text) noexcept {
  const auto width = number_in<int>(cut(text, 'x'));
  const auto height = number_in<int>(text);
  const auto fits = [](const std::optional<int>& pixels) {
    return pixels && *pixels >= 16 && *pixels <= Size::most;
  };
  if (!fits(width) || !fits(height)) return std::nullopt;
  return Size{*width, *height};
}

Image::Image(Size size, Pixel colour)
    : size_(size),
      pixels_(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height),
              colour) {}

void Image::paste(const Image& other, int x, int y) noexcept {
  for (int row = std::max(0, -y); row < std::min(other.size_.height, size_.height - y); ++row)
    for (int column = std::max(0, -x); column < std::min(other.size_.width, size_.width - x);
         ++column)
      at(x + column, y + row) = other.at(column, row);
}

Error too_many_pixels() {
  return {Errc::bad_input,
          "has more than " + std::to_string(Size::most) + " pixels along a side; make it smaller"};
}

Result<std::string> png_of(const Image& image) {
  png_image header = header_of(image.size());
  const auto stride = static_cast<png_int_32>(3 * image.size().width);
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string contents(bytes, '\0');
  if (png_image_write_to_memory(&header, contents.data(), &bytes, 0, image.pixels().data(), stride,
                                nullptr) == 0)
    return Error{Errc::failed, std::string("no PNG can be made: ") + header.message};
  contents.resize(bytes);
  return contents;
}

Result<void> write_png(const std::filesystem::path& path, const Image& image) {
  const auto contents = png_of(image);
  if (!contents)
    return Error{contents.error().code, path.string() + ": " + contents.error().message};
  return replace_file(path, *contents);
}

Result<Image> decode_png(std::string_view contents, const std::string& name) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&header, contents.data(), contents.size()) == 0)
    return Error{Errc::bad_input, name + ": not a PNG picture: " + header.message};
  if (header.width > Size::most || header.height > Size::most) {
    png_image_free(&header);
    return Error{Errc::bad_input, name + ": more than " + std::to_string(Size::most) +
                                      " pixels wide or high; use a smaller picture"};
  }
  header.format = PNG_FORMAT_RGB;
  const Size size{static_cast<int>(header.width), static_cast<int>(header.height)};
  std::vector<Pixel> pixels(std::size_t{header.width} * header.height);
  if (png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr) == 0)
    return Error{Errc::bad_input, name + ": a damaged picture: " + header.message};
  return Image(size, std::move(pixels));
}

Result<Image> read_png(const std::filesystem::path& path) {
  const auto contents = read_file(path, max_png_bytes, "picture");
  if (!contents) return contents.error();
  return decode_png(*contents, path.string());
}

} // namespace nendo::render
