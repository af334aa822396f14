#include "bench/table1_picture.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "bench/table1_paper.hpp"
#include "cli/svg_drawing.hpp"
#include "reference/table1.hpp"

namespace nendo::bench {
namespace {

// In pixels.
constexpr double width = 960.0;
constexpr double panel_height = 330.0;
constexpr double panel_left = 70.0;
constexpr double panel_width = 860.0;
constexpr double first_panel_top = 96.0;
constexpr double panel_gap = 84.0;
constexpr double height = first_panel_top + 2.0 * panel_height + panel_gap + 60.0;

// Powers of ten at the panels' lower and upper ends.
constexpr double lowest_power = 0.8;
constexpr double highest_power = 6.4;

constexpr auto paper_colour = "#b5462f";
constexpr auto plain_colour = "#9a9a9a";
constexpr auto one_colour = "#2a6f97";
constexpr auto two_colour = "#0b3954";
constexpr auto whole_colour = "#5b9e48";

double y_of(double frames_per_second, double top) {
  const double share =
      (std::log10(frames_per_second) - lowest_power) / (highest_power - lowest_power);
  return top + panel_height * (1.0 - std::clamp(share, 0.0, 1.0));
}

/// The five radii of a mesh are one group.
double x_of(const Table1Entry& entry) {
  const double group = panel_width / static_cast<double>(reference::table1_planes.size());
  const double step = group / (static_cast<double>(reference::table1_radii.size()) + 1.0);
  return panel_left + group * static_cast<double>(entry.plane) +
         step * (static_cast<double>(entry.radius) + 1.0);
}

constexpr cli::SvgText title_text{14};
constexpr cli::SvgText small_at_end{10, "#444444", "end"};
constexpr cli::SvgText small_in_middle{10, "#444444", "middle"};
constexpr cli::SvgText finest{9, "#2f6b1f"};

void rule(cli::SvgDrawing& drawing, double top, double frames_per_second, const char* colour,
          const char* dashes) {
  const double y = y_of(frames_per_second, top);
  drawing.line(panel_left, y, panel_left + panel_width, y, colour, 1.0, dashes);
}

void draw_scale(cli::SvgDrawing& drawing, double top) {
  for (const auto& [value, label] : {std::pair{1e1, "10"},
                                     {1e2, "100"},
                                     {1e3, "1000"},
                                     {1e4, "10 000"},
                                     {1e5, "100 000"},
                                     {1e6, "1 000 000"}}) {
    rule(drawing, top, value, "#e2e2e2", "none");
    drawing.text(panel_left - 6.0, y_of(value, top) + 4.0, label, small_at_end);
  }
  // The rate of the loop, below which a hand sees single frames.
  rule(drawing, top, 90.0, "#c9a227", "5 4");
  drawing.text(panel_left + panel_width, y_of(90.0, top) - 4.0, "90 per second", small_at_end);
}

void draw_column(cli::SvgDrawing& drawing, const Table1Entry& entry, std::size_t type, double paper,
                 double top) {
  const Table1Cell& cell = entry.cell;
  const double x = x_of(entry);
  const double ours = y_of(cell.one_thread[type], top);
  const double best = std::min(ours, y_of(cell.two_threads[type], top));
  drawing.line(x, y_of(paper, top), x, best, "#c8d3da", 3.0);
  drawing.dot(x, y_of(paper, top), 4.0, paper_colour, paper_colour);
  if (cell.plain_loop[type] > 0.0)
    drawing.dot(x, y_of(cell.plain_loop[type], top), 4.0, "white", plain_colour);
  drawing.dot(x, y_of(cell.whole_frame[type], top), 4.0, whole_colour, whole_colour);
  drawing.dot(x, y_of(cell.two_threads[type], top), 5.5, "white", two_colour);
  drawing.dot(x, ours, 3.0, one_colour, one_colour);
  // Like for like: only whole frames are compared.
  const double times = cell.whole_frame[type] / paper;
  drawing.text(x + 6.0, y_of(cell.whole_frame[type], top) - 5.0,
               times < 9.95 ? fmt::format("{:.1f} x", times) : fmt::format("{:.0f} x", times),
               finest);
  drawing.text(x, top + panel_height + 14.0,
               fmt::format("{:.0f}", reference::table1_radii.at(entry.radius)), small_in_middle);
}

void draw_panel(cli::SvgDrawing& drawing, const std::vector<Table1Entry>& entries, std::size_t type,
                double top) {
  const auto& paper = type == 0 ? paper_type1 : paper_type2;
  draw_scale(drawing, top);
  drawing.text(panel_left, top - 10.0,
               type == 0 ? "Type-1: the fingertips stay frozen to the model"
                         : "Type-2: solved again in each frame",
               title_text);
  for (const Table1Entry& entry : entries)
    draw_column(drawing, entry, type, paper.at(entry.plane).at(entry.radius), top);
  for (std::size_t plane = 0; plane < reference::table1_planes.size(); ++plane) {
    const double group = panel_width / static_cast<double>(reference::table1_planes.size());
    const double middle = panel_left + group * (static_cast<double>(plane) + 0.5);
    drawing.text(middle, top + panel_height + 30.0,
                 fmt::format("radius; {} triangles", table1_triangles.at(plane)), small_in_middle);
  }
}

void draw_legend(cli::SvgDrawing& drawing, double y) {
  struct Item {
    double size;
    const char *fill, *edge, *words;
  };
  double x = panel_left + 4.0;
  for (const Item& item :
       {Item{4.0, paper_colour, paper_colour, "the paper, 2004: p(x), normals, drawing"},
        Item{4.0, whole_colour, whole_colour, "Nendo, the same (times the paper's)"},
        Item{4.0, "white", plain_colour, "without these: a plain loop"},
        Item{3.0, one_colour, one_colour, "Nendo"},
        Item{5.5, "white", two_colour, "two threads"}}) {
    drawing.dot(x, y - 4.0, item.size, item.fill, item.edge);
    drawing.text(x + 10.0, y, item.words, {12});
    x += 6.3 * static_cast<double>(std::string_view(item.words).size()) + 30.0;
  }
}

} // namespace

std::string table1_picture(const std::vector<Table1Entry>& entries, const std::string& layout) {
  cli::SvgDrawing drawing(width, height);
  drawing.text(panel_left, 30.0,
               fmt::format("The paper's Table 1 in frames per second: ten fingertips on a plane "
                           "(layout {})",
                           layout),
               {18});
  draw_legend(drawing, 56.0);
  draw_panel(drawing, entries, 0, first_panel_top);
  draw_panel(drawing, entries, 1, first_panel_top + panel_height + panel_gap);
  return std::move(drawing).finished();
}

} // namespace nendo::bench
