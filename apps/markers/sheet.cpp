#include "markers/sheet.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include "cli/svg_drawing.hpp"
#include "markers/bracelet.hpp"
#include "markers/marker_detector.hpp"

namespace nendo::markers {
namespace {

constexpr double px_per_m = 96.0 / 0.0254; // as SVG defines its pixels
constexpr double page_width_m = 0.210;
constexpr double page_height_m = 0.297;
constexpr double thin_px = 0.5;

class Sheet {
public:
  Sheet() : drawing_(page_width_m * px_per_m, page_height_m * px_per_m) {}

  void box(const Point2& corner_m, double width_m, double height_m, const char* colour) {
    drawing_.box(corner_m[0] * px_per_m, corner_m[1] * px_per_m, width_m * px_per_m,
                 height_m * px_per_m, colour, 1.0);
  }
  void line(const Point2& from_m, const Point2& to_m, const char* dashes = "none") {
    drawing_.line(from_m[0] * px_per_m, from_m[1] * px_per_m, to_m[0] * px_per_m,
                  to_m[1] * px_per_m, "#808080", thin_px, dashes);
  }
  void text(const Point2& at_m, const std::string& text, const char* anchor = "start") {
    cli::SvgText style;
    style.anchor = anchor;
    drawing_.text(at_m[0] * px_per_m, at_m[1] * px_per_m, text, style);
  }
  std::string finished() && { return std::move(drawing_).finished(); }

private:
  cli::SvgDrawing drawing_;
};

/// A black square with the white cells in it. White cells of a row are one box.
void draw_marker(Sheet& sheet, const MarkerPlace& place) {
  const Point2 corner = corners_on_sheet(place)[0];
  const double cell_m = marker_side_m / (cells + 2);
  sheet.box(corner, marker_side_m, marker_side_m, "#000000");
  const auto white = marker_cells(marker_number(place));
  for (std::size_t row = 0; row < cells; ++row) {
    for (std::size_t first = 0; first < cells;) {
      std::size_t end = first;
      while (end < cells && white[row][end])
        ++end;
      if (end > first)
        sheet.box({corner[0] + static_cast<double>(first + 1) * cell_m,
                   corner[1] + static_cast<double>(row + 1) * cell_m},
                  static_cast<double>(end - first) * cell_m, cell_m, "#ffffff");
      first = end + 1;
    }
  }
}

void draw_bracelet(Sheet& sheet, Side side) {
  const auto [left, top] = strip_on_sheet_m(side);
  const double right = left + plates * plate_side_m;
  const double bottom = top + plate_side_m;
  sheet.line({left, top}, {right, top});
  sheet.line({left, bottom}, {right, bottom});
  sheet.line({left, top}, {left, bottom});
  sheet.line({right, top}, {right, bottom});
  for (int plate = 0; plate < plates; ++plate) {
    const double edge = left + plate * plate_side_m;
    if (plate > 0) sheet.line({edge, top}, {edge, bottom}, "4 4");
    for (int marker = 0; marker < markers_per_plate; ++marker)
      draw_marker(sheet, {side, plate, marker});
  }
  sheet.text({left, top - 0.003},
             std::string(name_of(side)) + " wrist; this edge is towards the hand");
}

void draw_ruler(Sheet& sheet, const Point2& left_m) {
  const auto [left, y] = left_m;
  constexpr double length_m = 0.100;
  sheet.line(left_m, {left + length_m, y});
  for (int mark = 0; mark <= 10; ++mark) {
    const double x = left + mark * length_m / 10;
    sheet.line({x, y - (mark % 5 == 0 ? 0.004 : 0.002)}, {x, y});
  }
  sheet.text({left + length_m + 0.003, y}, "100 mm, if the page is printed at its own size");
}

} // namespace

std::string draw_sheet() {
  Sheet sheet;
  sheet.text({0.006, 0.015}, "Nendo: markers for both wrists. Print at 100 %, not fitted to the "
                             "page, on matt paper.");
  sheet.text({0.006, 0.022}, "1. Measure the ruler. 2. Fix the sheet on something flat, and run: "
                             "nendo-markers calibrate");
  sheet.text({0.006, 0.029},
             "3. Glue it on card, cut along the lines, fold back by 60 degrees along "
             "the dashes.");
  for (const Side side : {Side::left, Side::right})
    draw_bracelet(sheet, side);
  draw_ruler(sheet, {0.006, 0.220});
  return std::move(sheet).finished();
}

} // namespace nendo::markers
