#include "forms/setting_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include <nendo/deform/type2.hpp>
#include <nendo/deform/wendland.hpp>
#include <nendo/flow/command.hpp>

namespace nendo::forms {
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

/// Those that move the surface in its plane are seen from above, the others rather from the front.
LinePicture picture_of(Brush brush) {
  const auto is_any_of = [&](auto... one) { return ((one == brush) || ...); };
  const bool from_above = is_any_of(Brush::twist, Brush::scale, Brush::pinch);
  constexpr double half_width = 1.2, half_height = 0.8;
  const double depth = from_above ? 1.0 : 0.5;
  const SurfaceLines& lines = lines_of(brush);
  LinePicture picture;
  for (std::size_t number = 0; number < (from_above ? lines.size() : drawn_rows); ++number) {
    picture.emplace_back();
    for (const Vector3d& place : lines[number])
      if (std::abs(place.x()) <= half_width)
        picture.back().emplace_back(0.5 + place.x() / (2.0 * half_width),
                                    0.5 + (place.z() + depth * place.y()) / (2.0 * half_height));
    if (picture.back().empty()) picture.pop_back();
  }
  return picture;
}

LinePicture picture_of(deform::Wendland kernel) {
  constexpr int points = 41;
  LinePicture picture(1);
  for (int k = 0; k < points; ++k) {
    const double x = static_cast<double>(k) / (points - 1);
    picture[0].emplace_back(x, deform::wendland(kernel, std::abs(2.0 * x - 1.0)));
  }
  return picture;
}

using Pictures = std::vector<std::pair<std::string_view, LinePicture>>;

const Pictures& all_pictures() {
  static const Pictures all = [] {
    Pictures made;
    for (std::size_t at = 0; at < deform::brush_count; ++at)
      made.emplace_back(name_of(static_cast<Brush>(at)), picture_of(static_cast<Brush>(at)));
    for (const deform::Wendland kernel : flow::PendingSettings::kernels)
      made.emplace_back(name_of(kernel), picture_of(kernel));
    return made;
  }();
  return all;
}

std::string svg_point(const Eigen::Vector2d& place) {
  char text[32]; // a tenth of a hundredth is less than a pixel
  std::snprintf(text, sizeof text, "%.4g %.4g", 100.0 * place.x(), 100.0 - 100.0 * place.y());
  return text;
}

} // namespace

const SurfaceLines& lines_of(Brush brush) {
  static const auto all = [] {
    std::array<SurfaceLines, deform::brush_count> made;
    for (std::size_t at = 0; at < made.size(); ++at)
      made[at] = shaped_by(static_cast<Brush>(at));
    return made;
  }();
  return all[static_cast<std::size_t>(brush)];
}

const LinePicture* line_picture(std::string_view name) {
  const auto found = std::ranges::find(all_pictures(), name, &Pictures::value_type::first);
  return found == all_pictures().end() ? nullptr : &found->second;
}

std::string line_pictures_js() {
  std::string text = "{";
  for (const auto& [name, picture] : all_pictures()) {
    text += "\n  \"" + std::string(name) + "\": \"";
    for (const auto& line : picture)
      for (std::size_t at = 0; at < line.size(); ++at)
        text += (at == 0 ? "M" : " ") + svg_point(line[at]);
    text += "\",";
  }
  return text + "\n}";
}

} // namespace nendo::forms
