#include "files/polypaint.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

#include <nendo/base/text.hpp>

#include "files/srgb.hpp"

namespace nendo::deform {

void read_polypaint(std::string_view comment, std::vector<std::uint32_t>& colours) {
  constexpr std::string_view mark = "#MRGB";
  constexpr std::size_t digits = 8;
  if (!comment.starts_with(mark)) return;
  const std::string_view numbers = trimmed(comment.substr(mark.size()));
  for (std::size_t at = 0; at + digits <= numbers.size(); at += digits) {
    const char* const begin = numbers.data() + at;
    std::uint32_t number = 0;
    const auto read = std::from_chars(begin, begin + digits, number, 16);
    if (read.ec != std::errc() || read.ptr != begin + digits) return;
    colours.push_back(number & 0xFFFFFFU);
  }
}

Eigen::Matrix4Xf colours_of_polypaint(const std::vector<std::uint32_t>& colours,
                                      Eigen::Index vertices) {
  Eigen::Matrix4Xf linear = Eigen::Matrix4Xf::Ones(4, vertices);
  const Eigen::Index painted = std::min(vertices, static_cast<Eigen::Index>(colours.size()));
  for (Eigen::Index vertex = 0; vertex < painted; ++vertex)
    for (Eigen::Index channel = 0; channel < 3; ++channel) {
      const std::uint32_t byte =
          colours[static_cast<std::size_t>(vertex)] >> (16 - 8 * channel) & 0xFFU;
      linear(channel, vertex) = linear_of(static_cast<float>(byte) / 255.0F);
    }
  return linear;
}

} // namespace nendo::deform
