#pragma once
// Control vectors from a file, for deforming without gloves or clock.

#include <filesystem>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct ControlVectors {
  Points starts;         ///< c_i
  Points displacements;  ///< g_i
  Eigen::VectorXd radii; ///< one a row, or empty if the file has no such column
};

/// CSV with the header `x,y,z,dx,dy,dz` and optionally `,radius`. Blank lines and lines that start
/// with # are skipped. Error: bad_input, naming line and column. `name` is what error messages call
/// it.
Result<ControlVectors> parse_control_vectors(std::string_view text, std::string_view name);
Result<ControlVectors> read_control_vectors(const std::filesystem::path& path);

} // namespace nendo::deform
