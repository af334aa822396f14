#include "cli/svg_drawing.hpp"

#include <utility>

#include <spdlog/fmt/fmt.h>

namespace nendo::cli {
namespace {

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      safe += c;
  }
  return safe;
}

} // namespace

SvgDrawing::SvgDrawing(double width, double height)
    : text_(fmt::format(
          R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:g} {1:g}" width="{0:g}" height="{1:g}" font-family="DejaVu Sans, Helvetica, Arial, sans-serif">
<rect width="100%" height="100%" fill="#ffffff"/>
)",
          width, height)) {}

void SvgDrawing::text(double x, double y, const std::string& text, const SvgText& style) {
  text_ += fmt::format(
      R"(<text x="{:.2f}" y="{:.2f}" font-size="{:g}" fill="{}" text-anchor="{}"{}>{}</text>)"
      "\n",
      x, y, style.size, style.colour, style.anchor, style.bold ? R"( font-weight="bold")" : "",
      escaped(text));
}

void SvgDrawing::line(double x0, double y0, double x1, double y1, const char* colour, double width,
                      const char* dashes) {
  text_ += fmt::format(
      R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" stroke="{}" stroke-width="{:g}" stroke-dasharray="{}"/>)"
      "\n",
      x0, y0, x1, y1, colour, width, dashes);
}

void SvgDrawing::box(double x, double y, double width, double height, const char* colour,
                     double opacity) {
  text_ += fmt::format(
      R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" fill="{}" fill-opacity="{:g}"/>)"
      "\n",
      x, y, width, height, colour, opacity);
}

void SvgDrawing::dot(double x, double y, double radius, const char* fill, const char* edge) {
  text_ += fmt::format(
      R"(<circle cx="{:.2f}" cy="{:.2f}" r="{:g}" fill="{}" stroke="{}" stroke-width="1.5"/>)"
      "\n",
      x, y, radius, fill, edge);
}

void SvgDrawing::path(const std::string& points, const char* colour, double width) {
  if (points.empty()) return;
  text_ += fmt::format(
      R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="{:g}" stroke-linejoin="round"/>)"
      "\n",
      points, colour, width);
}

std::string SvgDrawing::finished() && {
  return std::move(text_) + "</svg>\n";
}

std::string svg_point(double x, double y) {
  return fmt::format("{:.2f},{:.2f} ", x, y);
}

} // namespace nendo::cli
