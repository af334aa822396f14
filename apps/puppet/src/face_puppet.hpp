#pragma once
// A puppet's file in the making: points and functions that can still be changed.

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace nendo::puppet {

struct DraftPoint {
  std::string name;
  std::string place; ///< `at = [...]` or `vertex = ...`
  double radius = 1.0;
  bool is_pin = false;
};

struct DraftFunction {
  std::string name;
  std::string input;
  double travel_deg = 90.0;
  bool eases = true;
  /// A turn about an axis along x through (0, y, z), of each point by its part; or moves.
  double turn_deg = 0.0;
  double axis_y = 0.0, axis_z = 0.0;
  std::vector<std::pair<std::string, double>> turns{};
  std::vector<std::pair<std::string, Eigen::Vector3d>> moves{};
  double part = 1.0; ///< of what was meant, since more would fold
};

/// Returns `[x, y, z]`, rounded to a 2000th of the unit or less.
std::string vector_text(const Eigen::Vector3d& vector, double unit);

struct PuppetDraft {
  std::string model;
  std::vector<std::string> comments; ///< lines
  std::vector<DraftPoint> points;
  std::vector<DraftFunction> functions;
  std::string parts; ///< as they stand in the file
  double unit = 1.0; ///< of the face, by which numbers are rounded

  std::string text() const;
};

} // namespace nendo::puppet
