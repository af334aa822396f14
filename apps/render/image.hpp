#pragma once
// A picture in memory, its PNG files, and TGA and BMP files by stb_image.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::render {

using Pixel = std::array<std::uint8_t, 3>; ///< red, green, blue in sRGB

struct Size {
  int width = 0;  ///< pixels
  int height = 0; ///< pixels
  friend bool operator==(Size, Size) = default;

  static constexpr int most = 8192; ///< the limit of width and height
};

/// Parses "WxH" in pixels, each from 16 to Size::most. Returns nullopt if the text is something
/// else.
std::optional<Size> size_named(std::string_view text) noexcept;

/// Returns the index of a place in a grid that is stored row by row.
constexpr std::size_t index_in_grid(int x, int y, int width) noexcept {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

class Image {
public:
  explicit Image(Size size, Pixel colour = {255, 255, 255});
  /// Takes the pixels row by row from the top. There must be as many as the size says.
  Image(Size size, std::vector<Pixel> pixels) : size_(size), pixels_(std::move(pixels)) {}

  Size size() const noexcept { return size_; }
  Pixel& at(int x, int y) noexcept { return pixels_[index_in_grid(x, y, size_.width)]; }
  const Pixel& at(int x, int y) const noexcept { return pixels_[index_in_grid(x, y, size_.width)]; }
  /// Returns the pixels row by row from the top.
  const std::vector<Pixel>& pixels() const noexcept { return pixels_; }
  /// Copies `other` to the place with its top left corner at (x, y). Parts outside of this image
  /// are left out.
  void paste(const Image& other, int x, int y) noexcept;

  friend bool operator==(const Image&, const Image&) = default;

private:
  Size size_;
  std::vector<Pixel> pixels_;
};

/// Returns the error of a texture of more than Size::most pixels along a side: bad_input, with the
/// end of a sentence that begins with the file's name.
Error too_many_pixels();

/// Returns the contents of a PNG file. Error: failed.
Result<std::string> png_of(const Image& image);
/// Writes the file atomically and replaces an existing one. Blocks. Error: failed.
Result<void> write_png(const std::filesystem::path& path, const Image& image);
/// Reads a PNG file. Blocks. Error: bad_input (no PNG, or too large).
Result<Image> read_png(const std::filesystem::path& path);
/// Does the same with the file's contents; `name` is what errors call it.
Result<Image> decode_png(std::string_view contents, const std::string& name);

/// Returns whether a file's header is that of a BMP, or a TGA, which has no mark but a header that
/// no text and no other picture has.
bool is_bmp(std::string_view contents) noexcept;
bool is_tga(std::string_view contents) noexcept;

/// Returns the picture of a file that is_bmp() or is_tga(), of at most Size::most pixels along each
/// side. Errors: bad_input, with the end of a sentence that begins with the file's name.
Result<Image> decode_bmp(std::string_view contents);
Result<Image> decode_tga(std::string_view contents);

} // namespace nendo::render
