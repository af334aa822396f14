#include "render/texture_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/jpeg.hpp"

namespace nendo::render {

using Eigen::Vector3f;

namespace {

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

} // namespace

std::optional<Image> decode_picture(const std::string& contents) {
  if (contents.starts_with("\xFF\xD8")) return decode_jpeg(contents);
  auto image = decode_png(contents, "texture");
  if (!image) return std::nullopt;
  return *std::move(image);
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
