#pragma once
// The bracelet: three plates with four markers each, which are folded by 60 degrees around the
// forearm. A camera anywhere on their side sees at least one plate well, and mostly two, which
// removes the two-fold ambiguity of a single flat marker.

#include <array>
#include <optional>

#include <nendo/base/side.hpp>

namespace nendo::markers {

inline constexpr int plates = 3;
inline constexpr int markers_per_plate = 4; ///< two rows of two
inline constexpr int markers_per_bracelet = plates * markers_per_plate;
inline constexpr double marker_side_m = 0.024;
/// The white around each marker. Below a quarter of the marker, half of the detections are lost.
inline constexpr double margin_m = marker_side_m / 4;
inline constexpr double plate_side_m = 2 * marker_side_m + 3 * margin_m;
inline constexpr double plate_angle_deg = 60.0;

using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;

/// The place of a marker: which hand's bracelet, plate (0 to 2), and marker on the plate (0 to 3,
/// row by row).
struct MarkerPlace {
  Side side = Side::left;
  int plate = 0;
  int marker = 0;
};

/// Returns the number of a marker in the dictionary of marker_detector.hpp, and the other way.
int marker_number(const MarkerPlace& place) noexcept;
std::optional<MarkerPlace> find_marker(int number) noexcept;

/// Returns the corners of a marker on its plate, in metres from the plate's centre: x to the right,
/// y up, clockwise from the upper left, as the detector returns them.
std::array<Point2, 4> corners_on_plate(int marker) noexcept;

/// The frame of a plate in the frame of the bracelet: x and y as on the plate, z out of it.
struct PlateFrame {
  Point3 centre_m{};
  Point3 x_axis{};
  Point3 y_axis{};
  Point3 z_axis{};
};

/// The frame of the bracelet has its origin on the axis of the forearm, y along it to the hand,
/// and z out of the middle plate.
PlateFrame plate_frame(int plate) noexcept;

/// Returns the corners of a marker in the frame of the bracelet, in metres.
std::array<Point3, 4> corners_on_bracelet(const MarkerPlace& place) noexcept;

/// Returns the corners of a marker on the printed sheet before it is cut, in metres from the
/// sheet's upper left corner: x to the right, y down.
std::array<Point2, 4> corners_on_sheet(const MarkerPlace& place) noexcept;

/// The upper left corner of a bracelet on the sheet, which is of size A4.
Point2 strip_on_sheet_m(Side side) noexcept;

} // namespace nendo::markers
