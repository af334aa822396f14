#include "viewer/setting_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <nendo/deform/type2.hpp>
#include <nendo/deform/wendland.hpp>

#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

using deform::Brush;
using Eigen::Vector3d;

// The grid of the small surface, and which of its lines are drawn.
constexpr int columns = 49, rows = 25;
constexpr double spacing = 0.0625; // of a radius
constexpr int column_step = 6, row_step = 6;
constexpr std::size_t drawn_rows = 1 + (rows - 1) / row_step;

/// Smooth and flatten get waves to work on: short ones are rough, and longer ones are kept.
double height_before(Brush brush, double x) {
  constexpr double turn = 2.0 * 3.14159265358979;
  if (brush == Brush::smooth) return 0.12 * std::cos(turn * x / (3.0 * spacing));
  if (brush == Brush::flatten) return 0.2 * std::cos(turn * x / (16.0 * spacing));
  return 0.0;
}

deform::Mesh surface_for(Brush brush) {
  deform::Mesh mesh;
  mesh.vertices.resize(3, Eigen::Index{columns} * rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double x = spacing * (column - columns / 2), y = spacing * (row - rows / 2);
      mesh.vertices.col(row * columns + column) = Vector3d(x, y, height_before(brush, x));
    }
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column + 1 < columns; ++column) {
      const auto at = static_cast<std::uint32_t>(row * columns + column);
      for (const std::uint32_t corner : {at, at + 1, at + columns + 1, at + columns})
        mesh.face_corners.push_back(corner);
      mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
    }
  return mesh;
}

/// Pull goes outwards; the others stay about the middle, and go some radii in all.
void stroke(Brush brush, deform::Type2Deformer& deformer) {
  deform::Points tip = deform::Points::Zero(3, 1);
  deformer.begin(tip);
  const int moves = brush == Brush::smooth || brush == Brush::flatten ? 64 : 16;
  for (int move = 1; move <= moves; ++move) {
    if (brush == Brush::pull)
      tip.col(0).z() = 0.6 * move / moves;
    else
      tip.col(0).x() = move % 2 == 0 ? 0.0 : 0.1;
    deformer.end_at(tip);
  }
}

SurfaceLines shaped_by(Brush brush) {
  const deform::Mesh mesh = surface_for(brush);
  deform::DeformerOptions options;
  options.brushes.of_points = {brush};
  options.brushes.strength = brush == Brush::push || brush == Brush::inflate ? 0.4 : 0.9;
  options.brushes.rings =
      std::make_shared<const deform::VertexRings>(mesh, deform::BlockLayout(mesh.vertices));
  deform::Type2Deformer deformer(mesh.vertices, 1, 0.05, options);
  stroke(brush, deformer);
  deform::Points shape;
  deformer.layout().unpack(deformer.shape(), shape);
  SurfaceLines lines;
  for (int row = 0; row < rows; row += row_step)
    for (lines.emplace_back(); lines.back().size() < columns;)
      lines.back().emplace_back(shape.col(row * columns + static_cast<int>(lines.back().size())));
  for (int column = 0; column < columns; column += column_step)
    for (lines.emplace_back(); lines.back().size() < rows;)
      lines.back().emplace_back(
          shape.col(static_cast<int>(lines.back().size()) * columns + column));
  return lines;
}

ImVec2 at(ImVec2 low, ImVec2 high, double x, double y) { // each from 0 to 1
  return {low.x + static_cast<float>(x) * (high.x - low.x),
          high.y - static_cast<float>(y) * (high.y - low.y)};
}

} // namespace

const SurfaceLines& lines_of(Brush brush) {
  static std::array<SurfaceLines, deform::brush_count> all;
  SurfaceLines& lines = all[static_cast<std::size_t>(brush)];
  if (lines.empty()) lines = shaped_by(brush);
  return lines;
}

/// Those that move the surface in its plane are seen from above, the others rather from the front.
void draw_brush(ImDrawList& list, ImVec2 low, ImVec2 high, std::size_t brush, ImU32 colour) {
  const auto is_any_of = [&](auto... one) { return ((one == static_cast<Brush>(brush)) || ...); };
  const bool from_above = is_any_of(Brush::twist, Brush::scale, Brush::pinch);
  constexpr double half_width = 1.2, half_height = 0.8;
  const double depth = from_above ? 1.0 : 0.5;
  const SurfaceLines& lines = lines_of(static_cast<Brush>(brush));
  for (std::size_t number = 0; number < (from_above ? lines.size() : drawn_rows); ++number) {
    ImVec2 before;
    bool is_first = true;
    for (const Vector3d& place : lines[number]) {
      if (std::abs(place.x()) > half_width) continue;
      const ImVec2 to = at(low, high, 0.5 + place.x() / (2.0 * half_width),
                           0.5 + (place.z() + depth * place.y()) / (2.0 * half_height));
      if (!std::exchange(is_first, false)) list.AddLine(before, to, colour, scale());
      before = to;
    }
  }
}

void draw_kernel(ImDrawList& list, ImVec2 low, ImVec2 high, std::size_t kernel, ImU32 colour) {
  std::array<ImVec2, 41> points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(points.size() - 1);
    points[k] = at(low, high, x,
                   deform::wendland(static_cast<deform::Wendland>(kernel), std::abs(2.0 * x - 1)));
  }
  list.AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, 1.5F * scale());
}

} // namespace nendo::viewer
