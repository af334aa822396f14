#include "forms/drawing.hpp"

#include <algorithm>
#include <utility>

namespace nendo::forms {
namespace {

Eigen::Vector2f point(double x, double y) {
  return {static_cast<float>(x), static_cast<float>(y)};
}

} // namespace

void Drawing::rectangle(double x0, double y0, double x1, double y1, Colour colour) {
  area({point(x0, y0), point(x1, y0), point(x1, y1), point(x0, y1)}, colour);
}

void Drawing::area(std::vector<Eigen::Vector2f> corners, Colour colour) {
  shapes.push_back({Kind::area, colour, std::move(corners)});
}

void Drawing::line(std::vector<Eigen::Vector2f> points, Colour colour) {
  shapes.push_back({Kind::line, colour, std::move(points)});
}

void Drawing::diamond(double x, double y, Colour colour, Colour rim) {
  shapes.push_back({Kind::diamond, colour, {point(x, y)}, rim});
}

void Drawing::text(double x, double middle, Colour colour, std::string words) {
  shapes.push_back({Kind::words, colour, {point(x, middle)}, Colour::control, std::move(words)});
}

double Drawing::width_of(const std::string& words) noexcept {
  constexpr double character = 8.0; // of the fonts that windows and pages use
  const auto begins_character = [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  };
  return character * static_cast<double>(std::ranges::count_if(words, begins_character));
}

} // namespace nendo::forms
