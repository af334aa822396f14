#include "render/lettering.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <nendo/base/text.hpp>

namespace nendo::render {

namespace {

// Strokes with a space between. A point is a digit, x, and a letter, y: c the baseline, g the
// height of small letters, i that of capitals, a below. "~" begins a curve that ends where its
// points do and is drawn by the others, "@" a closed one; all others are straight.
// Each letter follows a line feed, and its strokes follow the letter.
constexpr std::string_view glyphs =
    "\nA0c2i4c 1e3e\nB0c0i ~0i3i3f0f ~0f4f4c0c\nC~4h3i1i0h0d1c3c4d\nD0c0i ~0i4i4c0c"
    "\nE4i0i0c4c 0f3f\nF4i0i0c 0f3f\nG~4h3i1i0h0d1c3c4d 4d4f2f\nH0c0i 4c4i 0f4f\nI0c0i"
    "\nJ~3i3d2c1c0d\nK0c0i 4i0e 1f4c\nL0i0c4c\nM0c0i2e4i4c\nN0c0i4c4i\nO@1i0h0d1c3c4d4h3i"
    "\nP0c0i ~0i4i4f0f\nQ@1i0h0d1c3c4d4h3i 2e4c\nR0c0i ~0i4i4f0f 2f4c\nS~4h3i1i0h1f3f4d3c1c0d"
    "\nT0i4i 2i2c\nU~0i0d1c3c4d4i\nV0i2c4i\nW0i1c3i5c6i\nX0i4c 0c4i\nY0i2f4i 2f2c\nZ0i4i0c4c"
    "\na@0d0f1g2g3f3d2c1c 3g3c\nb0i0c @0d0f1g2g3f3d2c1c\nc~3f2g1g0f0d1c2c3d"
    "\nd3i3c @0d0f1g2g3f3d2c1c\ne0e3e ~3e3f2g1g0f0d1c2c3d\nf~2i1i1g 1g1c 0g2g"
    "\ng@0d0f1g2g3f3d2c1c ~3g3b2a1a0b\nh0i0c ~0e0f1g2g3f3d 3e3c\ni0c0g 0i0i\nj~1g1b0a 1i1i"
    "\nk0i0c 3g0e 1e3c\nl0i0c\nm0g0c ~0e0f1g2g2e 2f2c ~2e2f3g4g4e 4f4c\nn0g0c ~0e0f1g2g3f3d 3e3c"
    "\no@0d0f1g2g3f3d2c1c\np0g0a @0d0f1g2g3f3d2c1c\nq3g3a @0d0f1g2g3f3d2c1c\nr0g0c ~0e0f1g2g"
    "\ns~3f2g1g0f1e2e3d2c1c0d\nt1i1d ~1e1c2c 0g2g\nu~0g0d1c2c3d3e 3g3c\nv0g2c4g\nw0g1c2f3c4g"
    "\nx0g3c 0c3g\ny0g2c 4g1a\nz0g3g0c3c\n0@1i0h0d1c2c3d3h2i\n10h2i2c\n2~0h1i2i3h3g2f0c 0c3c"
    "\n3~0h1i2i3h3g1f ~1f3f3d2c1c0d\n42c2i0e3e\n53i0i0f ~0f1g2g3f3d2c1c0d"
    "\n6~3h2i1i0h0d1c2c3d3e2f1f0e\n70i3i1c\n8@1f0g0h1i2i3h3g2f @1f0e0d1c2c3d3e2f"
    "\n9~0d1c2c3d3h2i1i0h0g1f2f3g\n \n.0c0c\n,1c0b\n:0c0c 0f0f\n-0e2e\n+0e2e 1f1d\n=0d3d 0f3f"
    "\n/0c3i\n|0b0i\n_0c4c\n(~1i0h0d1c\n)~0i1h1d0c\n%0c4i 0i0i 4c4c\n'0i0h\n!0i0e 0c0c"
    "\n?~0h1i2i3h3g1f1e 1c1c";

std::string_view strokes_of(char letter) noexcept {
  const std::array begin{'\n', letter};
  const auto at = glyphs.find(std::string_view(begin.data(), begin.size()));
  if (letter == '\n' || at == std::string_view::npos) return "0c0i3i3c0c"; // a box
  const auto strokes = glyphs.substr(at + begin.size());
  return strokes.substr(0, strokes.find('\n'));
}

struct Point {
  double x = 0.0, y = 0.0;
};

// What a stroke's text says, as straight pieces.
std::vector<Point> line_of(std::string_view stroke) {
  const bool closed = stroke.front() == '@';
  const bool curved = closed || stroke.front() == '~';
  if (curved) stroke.remove_prefix(1);
  std::vector<Point> points;
  for (std::size_t at = 0; at + 1 < stroke.size(); at += 2)
    points.push_back(
        {static_cast<double>(stroke[at] - '0'), static_cast<double>(stroke[at + 1] - 'c')});
  if (!curved) return points;
  // A quadratic B-spline: parabolas between the middles of the polygon's sides.
  const std::size_t count = points.size();
  const auto middle = [](Point a, Point b) { return Point{(a.x + b.x) / 2, (a.y + b.y) / 2}; };
  std::vector<Point> line;
  const auto parabola = [&](Point a, Point b, Point c) {
    for (int step = 0; step <= 6; ++step) {
      const double t = step / 6.0;
      const double u = 1.0 - t;
      line.push_back({u * u * a.x + 2 * u * t * b.x + t * t * c.x,
                      u * u * a.y + 2 * u * t * b.y + t * t * c.y});
    }
  };
  if (closed) {
    for (std::size_t at = 0; at < count; ++at) {
      const Point here = points[(at + 1) % count];
      parabola(middle(points[at], here), here, middle(here, points[(at + 2) % count]));
    }
    return line;
  }
  for (std::size_t at = 1; at + 1 < count; ++at) {
    parabola(at == 1 ? points[0] : middle(points[at - 1], points[at]), points[at],
             at + 2 == count ? points[count - 1] : middle(points[at], points[at + 1]));
  }
  return line;
}

double width_of(char letter) noexcept {
  if (letter == ' ') return 1.4;
  char widest = '0';
  const auto strokes = strokes_of(letter);
  for (const char mark : strokes)
    if (mark >= '0' && mark <= '9') widest = std::max(widest, mark);
  return static_cast<double>(widest - '0');
}

constexpr double units_per_height = 6.0;
constexpr double space_units = 1.7;      // between letters
constexpr double stroke_fraction = 0.12; // of the height

double distance(Point p, Point a, Point b) noexcept {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length = dx * dx + dy * dy;
  const double t =
      length > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length, 0.0, 1.0) : 0.0;
  const double x = p.x - a.x - t * dx;
  const double y = p.y - a.y - t * dy;
  return std::sqrt(x * x + y * y);
}

// How much ink lies on each pixel of a box; the most of any stroke counts, so that none is twice as
// black where two cross.
struct Ink {
  int left, top, width, height;
  std::vector<double> amount;

  void stroke(Point a, Point b, double radius) {
    const int x0 = std::max(left, static_cast<int>(std::floor(std::min(a.x, b.x) - radius - 1)));
    const int x1 =
        std::min(left + width - 1, static_cast<int>(std::ceil(std::max(a.x, b.x) + radius + 1)));
    const int y0 = std::max(top, static_cast<int>(std::floor(std::min(a.y, b.y) - radius - 1)));
    const int y1 =
        std::min(top + height - 1, static_cast<int>(std::ceil(std::max(a.y, b.y) + radius + 1)));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        double& ink = amount[index_in_grid(x - left, y - top, width)];
        const double away = distance({x + 0.5, y + 0.5}, a, b);
        ink = std::max(ink, std::clamp(radius + 0.5 - away, 0.0, 1.0));
      }
  }
};

} // namespace

double width_of_words(std::string_view words, double height) noexcept {
  double units = 0.0;
  for (const char letter : words)
    units += width_of(letter) + space_units;
  return words.empty() ? 0.0 : (units - space_units) * height / units_per_height;
}

void write_words(Image& image, double x, double y, double height, std::string_view words,
                 Pixel colour) {
  const double unit = height / units_per_height;
  const int left = std::max(0, static_cast<int>(x) - 2);
  const int top = std::max(0, static_cast<int>(y - height) - 2);
  const int right =
      std::min(image.size().width, static_cast<int>(x + width_of_words(words, height)) + 4);
  const int bottom = std::min(image.size().height, static_cast<int>(y + height / 2) + 3);
  if (!(right > left && bottom > top)) return;
  Ink ink{left, top, right - left, bottom - top, {}};
  ink.amount.resize(static_cast<std::size_t>(ink.width) * static_cast<std::size_t>(ink.height));
  for (const char letter : words) {
    std::string_view strokes = strokes_of(letter);
    while (!strokes.empty()) {
      const auto line = line_of(cut(strokes, ' '));
      for (std::size_t at = 0; at < line.size(); ++at) {
        const Point a = line[at];
        const Point b = line[std::min(at + 1, line.size() - 1)];
        ink.stroke({x + a.x * unit, y - a.y * unit}, {x + b.x * unit, y - b.y * unit},
                   std::max(0.55, stroke_fraction / 2 * height));
      }
    }
    x += (width_of(letter) + space_units) * unit;
  }
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column) {
      const double there = ink.amount[index_in_grid(column - left, row - top, ink.width)];
      Pixel& pixel = image.at(column, row);
      for (std::size_t channel = 0; channel < 3; ++channel)
        pixel[channel] = static_cast<std::uint8_t>(
            std::lround(pixel[channel] + there * (colour[channel] - pixel[channel])));
    }
}

} // namespace nendo::render
