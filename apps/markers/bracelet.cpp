#include "markers/bracelet.hpp"

#include <cmath>
#include <cstddef>

#include <nendo/base/units.hpp>

namespace nendo::markers {
namespace {

/// From the forearm's axis to a plate, whose edges touch those of its neighbours.
const double apothem_m = plate_side_m / 2 / std::tan(from_degrees(plate_angle_deg / 2));

} // namespace

int marker_number(const MarkerPlace& place) noexcept {
  const int first = place.side == Side::left ? 0 : markers_per_bracelet;
  return first + place.plate * markers_per_plate + place.marker;
}

std::optional<MarkerPlace> find_marker(int number) noexcept {
  if (number < 0 || number >= 2 * markers_per_bracelet) return std::nullopt;
  const int on_bracelet = number % markers_per_bracelet;
  return MarkerPlace{number < markers_per_bracelet ? Side::left : Side::right,
                     on_bracelet / markers_per_plate, on_bracelet % markers_per_plate};
}

std::array<Point2, 4> corners_on_plate(int marker) noexcept {
  const double pitch_m = marker_side_m + margin_m;
  const double x = (marker % 2 - 0.5) * pitch_m;
  const double y = (0.5 - marker / 2) * pitch_m; // NOLINT(bugprone-integer-division): the row
  const double half = marker_side_m / 2;
  return {Point2{x - half, y + half}, Point2{x + half, y + half}, Point2{x + half, y - half},
          Point2{x - half, y - half}};
}

PlateFrame plate_frame(int plate) noexcept {
  const double angle = from_degrees(plate_angle_deg) * (plate - 1);
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  return {{apothem_m * s, 0, apothem_m * c}, {c, 0, -s}, {0, 1, 0}, {s, 0, c}};
}

std::array<Point3, 4> corners_on_bracelet(const MarkerPlace& place) noexcept {
  const PlateFrame frame = plate_frame(place.plate);
  const auto flat = corners_on_plate(place.marker);
  std::array<Point3, 4> corners{};
  for (std::size_t corner = 0; corner < 4; ++corner)
    for (std::size_t axis = 0; axis < 3; ++axis)
      corners[corner][axis] = frame.centre_m[axis] + flat[corner][0] * frame.x_axis[axis] +
                              flat[corner][1] * frame.y_axis[axis];
  return corners;
}

Point2 strip_on_sheet_m(Side side) noexcept {
  return {0.006, side == Side::left ? 0.045 : 0.130};
}

std::array<Point2, 4> corners_on_sheet(const MarkerPlace& place) noexcept {
  const auto [left, top] = strip_on_sheet_m(place.side);
  auto corners = corners_on_plate(place.marker);
  for (auto& [x, y] : corners) {
    x = left + plate_side_m * (place.plate + 0.5) + x;
    y = top + plate_side_m / 2 - y;
  }
  return corners;
}

} // namespace nendo::markers
