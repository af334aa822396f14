#include "bench/figure4_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "bench/table1_paper.hpp"
#include "bench/whole_frame.hpp"
#include "cli/svg_drawing.hpp"

namespace nendo::bench {
namespace {

// In pixels.
constexpr double figure_width = 960.0;
constexpr double figure_height = 680.0;
constexpr double plot_left = 84.0;
constexpr double plot_top = 132.0;
constexpr double plot_width = 850.0;
constexpr double plot_height = 470.0;

// Powers of ten at the ends of the axes.
constexpr double min_evaluations = 2.3;
constexpr double max_evaluations = 5.7;
constexpr double min_ms = -3.5;
constexpr double max_ms = 2.2;

/// The time of a frame of that type, in ms, and its evaluations. 0 if not measured.
struct Timing {
  double evaluations = 0.0;
  double ms = 0.0;
};

struct Series {
  const char* colour;
  const char* words;
  std::function<Timing(const Table1Entry&, std::size_t type)> timing;
};

Timing timed(std::size_t evaluations, double frames_per_second) {
  return {static_cast<double>(evaluations),
          frames_per_second > 0.0 ? 1e3 / frames_per_second : 0.0};
}

std::array<Series, 3> all_series() {
  return {
      {{"#b5462f", "the paper, 2004: p(x), normals, drawing",
        [](const Table1Entry& entry, std::size_t type) {
          const auto& paper = type == 0 ? paper_type1 : paper_type2;
          return timed(paper_evaluations.at(entry.plane).at(entry.radius),
                       paper.at(entry.plane).at(entry.radius));
        }},
       {"#2a6f97", "Nendo: p(x), normals, drawing",
        [](const Table1Entry& entry, std::size_t type) {
          return timed(entry.cell.evaluations, entry.cell.whole_frame[type]);
        }},
       {"#8a8a8a", "Nendo: the deformation alone", [](const Table1Entry& entry, std::size_t type) {
          return timed(entry.cell.evaluations, entry.cell.one_thread[type]);
        }}}};
}

double share_of(double value, double min_power, double max_power) {
  return std::clamp((std::log10(value) - min_power) / (max_power - min_power), 0.0, 1.0);
}

double evaluations_x(double evaluations) {
  return plot_left + plot_width * share_of(evaluations, min_evaluations, max_evaluations);
}

double ms_y(double ms) {
  return plot_top + plot_height * (1.0 - share_of(ms, min_ms, max_ms));
}

constexpr cli::SvgText tick_at_end{12, "#444444", "end"};
constexpr cli::SvgText tick_in_middle{12, "#444444", "middle"};
constexpr cli::SvgText axis_title{13, "#000000", "middle"};

void draw_axes(cli::SvgDrawing& drawing) {
  constexpr auto grid = "#e2e2e2";
  for (const auto& [value, label] : {std::pair{1e3, "1000"}, {1e4, "10 000"}, {1e5, "100 000"}}) {
    const double x = evaluations_x(value);
    drawing.line(x, plot_top, x, plot_top + plot_height, grid);
    drawing.text(x, plot_top + plot_height + 18.0, label, tick_in_middle);
  }
  for (const auto& [value, label] : {std::pair{1e-3, "0.001"},
                                     {1e-2, "0.01"},
                                     {1e-1, "0.1"},
                                     {1e0, "1"},
                                     {1e1, "10"},
                                     {1e2, "100"}}) {
    const double y = ms_y(value);
    drawing.line(plot_left, y, plot_left + plot_width, y, grid);
    drawing.text(plot_left - 8.0, y + 4.0, label, tick_at_end);
  }
  const double bottom = plot_top + plot_height;
  drawing.line(plot_left, plot_top, plot_left, bottom, "#444444");
  drawing.line(plot_left, bottom, plot_left + plot_width, bottom, "#444444");
  drawing.text(
      plot_left + plot_width / 2.0, bottom + 42.0,
      "evaluations per frame: pairs of a vertex and a control point nearer than the radius",
      axis_title);
  drawing.text(plot_left - 8.0, plot_top - 12.0, "ms per frame", {13, "#000000", "middle"});
  // The loop's time for a tick.
  const double y = ms_y(1e3 / 90.0);
  drawing.line(plot_left, y, plot_left + plot_width, y, "#c9a227", 1.0, "5 4");
  drawing.text(plot_left + 6.0, y - 5.0, "11 ms: 90 frames per second", {11, "#8a6d10"});
}

void draw_series(cli::SvgDrawing& drawing, const Series& series, std::size_t type,
                 const std::vector<Table1Entry>& entries) {
  const Table1Entry* before = nullptr;
  Timing last;
  for (const Table1Entry& entry : entries) {
    const Timing timing = series.timing(entry, type);
    if (!(timing.ms > 0.0)) continue;
    if (before != nullptr && before->plane == entry.plane)
      drawing.line(evaluations_x(last.evaluations), ms_y(last.ms),
                   evaluations_x(timing.evaluations), ms_y(timing.ms), series.colour, 1.5,
                   type == 0 ? "none" : "4 3");
    before = &entry;
    last = timing;
  }
  for (const Table1Entry& entry : entries) { // over the lines
    const Timing timing = series.timing(entry, type);
    if (timing.ms > 0.0)
      drawing.dot(evaluations_x(timing.evaluations), ms_y(timing.ms), 4.0,
                  type == 0 ? series.colour : "white", series.colour);
  }
}

/// To the left of the paper's lines, between them.
void name_meshes(cli::SvgDrawing& drawing, const std::vector<Table1Entry>& entries) {
  for (const Table1Entry& entry : entries) {
    if (entry.radius != 0) continue;
    const double ms =
        1e3 / std::sqrt(paper_type1.at(entry.plane).at(0) * paper_type2.at(entry.plane).at(0));
    drawing.text(evaluations_x(static_cast<double>(paper_evaluations.at(entry.plane).at(0))) - 10.0,
                 ms_y(ms) + 4.0, fmt::format("{} triangles", table1_triangles.at(entry.plane)),
                 {12, "#7a2f1f", "end"});
  }
}

void draw_key(cli::SvgDrawing& drawing, const std::array<Series, 3>& series) {
  double x = plot_left;
  for (const Series& one : series) {
    drawing.dot(x + 4.0, 70.0, 4.0, one.colour, one.colour);
    drawing.text(x + 16.0, 74.0, one.words, {13});
    x += 6.9 * static_cast<double>(std::string_view(one.words).size()) + 40.0;
  }
  x = plot_left;
  for (std::size_t type = 0; type < 2; ++type) {
    drawing.line(x, 92.0, x + 28.0, 92.0, "#444444", 1.5, type == 0 ? "none" : "4 3");
    drawing.dot(x + 14.0, 92.0, 4.0, type == 0 ? "#444444" : "white", "#444444");
    drawing.text(x + 36.0, 96.0,
                 type == 0 ? "Type-1: start points frozen" : "Type-2: solved again in each frame",
                 {13});
    x += 250.0;
  }
  drawing.text(plot_left + plot_width, 96.0,
               "left to right on each line: radius 10, 20, 40, 60, 80", {12, "#444444", "end"});
}

} // namespace

std::string figure4_picture(const std::vector<Table1Entry>& entries, const std::string& layout) {
  cli::SvgDrawing drawing(figure_width, figure_height);
  drawing.text(plot_left, 30.0,
               "Time per frame over its evaluations: ten fingertips deform a plane", {18});
  drawing.text(plot_left, 49.0,
               fmt::format("The paper: Athlon 64 3400+. Nendo: one thread, layout {}, {}.", layout,
                           whole_frame_drawing),
               {12, "#444444"});
  draw_axes(drawing);
  const std::array<Series, 3> series = all_series();
  for (const Series& one : series)
    for (std::size_t type = 0; type < 2; ++type)
      draw_series(drawing, one, type, entries);
  name_meshes(drawing, entries);
  draw_key(drawing, series);
  return std::move(drawing).finished();
}

} // namespace nendo::bench
