#pragma once
// A drawing as SVG, made element by element. Lengths are in pixels, y goes downwards, and colours
// have SVG's names.

#include <string>

namespace nendo::cli {

struct SvgText {
  double size = 13.0;
  const char* colour = "#000000";
  const char* anchor = "start"; ///< start, middle or end
  bool bold = false;
};

class SvgDrawing {
public:
  SvgDrawing(double width, double height);

  /// Draws a text, escaped for XML.
  void text(double x, double y, const std::string& text, const SvgText& style);
  void line(double x0, double y0, double x1, double y1, const char* colour, double width = 1.0,
            const char* dashes = "none");
  void box(double x, double y, double width, double height, const char* colour, double opacity);
  void dot(double x, double y, double radius, const char* fill, const char* edge);
  /// Draws a path. `points` are concatenated svg_point()s.
  void path(const std::string& points, const char* colour, double width);

  std::string finished() &&;

private:
  std::string text_;
};

/// Returns a point of a path, for path().
std::string svg_point(double x, double y);

} // namespace nendo::cli
