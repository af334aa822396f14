#pragma once
// A picture in memory, and as a PNG file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::viewer {

using Pixel = std::array<std::uint8_t, 3>; ///< red, green, blue, encoded as sRGB is

struct Size {
  int width = 0;  ///< pixels
  int height = 0; ///< pixels
  friend bool operator==(Size, Size) = default;

  static constexpr int most = 8192; ///< of either
};

/// "WxH" in pixels, 16 to Size::most each; nullopt if it is not that.
std::optional<Size> size_named(std::string_view text) noexcept;

class Image {
public:
  explicit Image(Size size, Pixel colour = {255, 255, 255});

  Size size() const noexcept { return size_; }
  Pixel& at(int x, int y) noexcept { return pixels_[index(x, y)]; }
  const Pixel& at(int x, int y) const noexcept { return pixels_[index(x, y)]; }
  /// Row by row from the top.
  const std::vector<Pixel>& pixels() const noexcept { return pixels_; }
  /// What of `other` has a place here when its corner is at (x, y).
  void paste(const Image& other, int x, int y) noexcept;

  friend bool operator==(const Image&, const Image&) = default;

private:
  std::size_t index(int x, int y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
           static_cast<std::size_t>(x);
  }
  Size size_;
  std::vector<Pixel> pixels_;
};

/// Replaces the file as a whole. Blocks. Errors: failed.
Result<void> write_png(const std::filesystem::path& path, const Image& image);
/// Blocks. Errors: bad_input (no PNG, too large).
Result<Image> read_png(const std::filesystem::path& path);

/// Words in a plain upright hand of strokes, `height` pixels from baseline to the top of capitals;
/// (x, y) is where the baseline begins. What has no letter here is a box.
void write_words(Image& image, double x, double y, double height, std::string_view words,
                 Pixel colour);
/// How wide they become, in pixels.
double width_of_words(std::string_view words, double height) noexcept;

} // namespace nendo::viewer
