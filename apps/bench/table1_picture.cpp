#include "bench/table1_picture.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "bench/table1.hpp"
#include "bench/table1_paper.hpp"

namespace nendo::app {
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

double y_of(double frames_per_second, double top) {
  const double share =
      (std::log10(frames_per_second) - lowest_power) / (highest_power - lowest_power);
  return top + panel_height * (1.0 - std::clamp(share, 0.0, 1.0));
}

/// A mesh's five radii stand together.
double x_of(const Table1Entry& entry) {
  const double group = panel_width / static_cast<double>(table1_planes.size());
  const double step = group / (static_cast<double>(table1_radii.size()) + 1.0);
  return panel_left + group * static_cast<double>(entry.plane) +
         step * (static_cast<double>(entry.radius) + 1.0);
}

std::string dot(double x, double y, double size, const char* fill, const char* edge) {
  return fmt::format(
      R"(<circle cx="{:.1f}" cy="{:.1f}" r="{}" fill="{}" stroke="{}" stroke-width="1.5"/>)"
      "\n",
      x, y, size, fill, edge);
}

std::string text(double x, double y, const char* kind, std::string_view words) {
  return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" class="{}">{}</text>)"
                     "\n",
                     x, y, kind, words);
}

std::string rule(double top, double frames_per_second, const char* colour, const char* dashes) {
  const double y = y_of(frames_per_second, top);
  return fmt::format(R"(<path d="M{} {:.1f}H{}" stroke="{}" stroke-dasharray="{}"/>)"
                     "\n",
                     panel_left, y, panel_left + panel_width, colour, dashes);
}

std::string scale(double top) {
  std::string lines;
  for (const auto& [value, label] : {std::pair{1e1, "10"},
                                     {1e2, "100"},
                                     {1e3, "1000"},
                                     {1e4, "10 000"},
                                     {1e5, "100 000"},
                                     {1e6, "1 000 000"}}) {
    lines += rule(top, value, "#e2e2e2", "none");
    lines += text(panel_left - 6.0, y_of(value, top) + 4.0, "s e", label);
  }
  // The rate of the loop, below which a hand sees single frames.
  lines += rule(top, 90.0, "#c9a227", "5 4");
  lines += text(panel_left + panel_width, y_of(90.0, top) - 4.0, "s e", "90 a second");
  return lines;
}

std::string column(const Table1Entry& entry, std::size_t type, double paper, double top) {
  const Table1Cell& cell = entry.cell;
  const double x = x_of(entry);
  const double ours = y_of(cell.one_thread[type], top);
  const double best = std::min(ours, y_of(cell.two_threads[type], top));
  std::string marks =
      fmt::format(R"(<path d="M{:.1f} {:.1f}V{:.1f}" stroke="#c8d3da" stroke-width="3"/>)"
                  "\n",
                  x, y_of(paper, top), best);
  marks += dot(x, y_of(paper, top), 4.0, paper_colour, paper_colour);
  if (cell.plain_loop[type] > 0.0)
    marks += dot(x, y_of(cell.plain_loop[type], top), 4.0, "white", plain_colour);
  marks += dot(x, y_of(cell.two_threads[type], top), 5.5, "white", two_colour);
  marks += dot(x, ours, 3.0, one_colour, one_colour);
  marks += text(x, best - 9.0, "f m", fmt::format("{:.0f} x", cell.one_thread[type] / paper));
  marks += text(x, top + panel_height + 14.0, "s m",
                fmt::format("{:.0f}", table1_radii.at(entry.radius)));
  return marks;
}

std::string panel(const std::vector<Table1Entry>& entries, std::size_t type, double top) {
  const auto& paper = type == 0 ? paper_type1 : paper_type2;
  std::string marks = scale(top);
  marks += text(panel_left, top - 10.0, "h",
                type == 0 ? "Type-1: the fingertips stay frozen to the model"
                          : "Type-2: solved anew in every frame");
  for (const Table1Entry& entry : entries)
    marks += column(entry, type, paper.at(entry.plane).at(entry.radius), top);
  for (std::size_t plane = 0; plane < table1_planes.size(); ++plane) {
    const double group = panel_width / static_cast<double>(table1_planes.size());
    const double middle = panel_left + group * (static_cast<double>(plane) + 0.5);
    marks += text(middle, top + panel_height + 30.0, "s m",
                  fmt::format("radius; {} triangles", table1_triangles.at(plane)));
  }
  return marks;
}

std::string legend(double y) {
  struct Item {
    double size;
    const char *fill, *edge, *words;
  };
  std::string marks;
  double x = panel_left + 4.0;
  for (const Item& item :
       {Item{4.0, paper_colour, paper_colour, "the paper, 2004, drawing included"},
        Item{4.0, "white", plain_colour, "a plain loop, here"},
        Item{3.0, one_colour, one_colour, "Nendo, one thread (and times the paper's)"},
        Item{5.5, "white", two_colour, "two threads"}}) {
    marks += dot(x, y - 4.0, item.size, item.fill, item.edge);
    marks += text(x + 10.0, y, "l", item.words);
    x += 6.6 * static_cast<double>(std::string_view(item.words).size()) + 26.0;
  }
  return marks;
}

} // namespace

std::string table1_picture(const std::vector<Table1Entry>& entries, const std::string& layout) {
  const double second_panel_top = first_panel_top + panel_height + panel_gap;
  return fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="sans-serif" font-size="12">
<style>.t{{font-size:18px}}.h{{font-size:14px}}.s{{font-size:10px;fill:#444444}}.f{{font-size:9px;fill:#444444}}.m{{text-anchor:middle}}.e{{text-anchor:end}}</style>
<rect width="100%" height="100%" fill="white"/>
<text x="{2}" y="30" class="t">The paper's Table 1 in frames a second: ten fingertips on a plane (layout {3})</text>
{4}{5}{6}</svg>
)",
      width, height, panel_left, layout, legend(56.0), panel(entries, 0, first_panel_top),
      panel(entries, 1, second_panel_top));
}

} // namespace nendo::app
