#pragma once
// Control vectors from a file, for deforming without gloves or clock.

#include <filesystem>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/supports.hpp>

namespace nendo::deform {

struct ControlVectors {
  Points starts;               ///< c_i
  Points displacements;        ///< g_i
  std::vector<OwnSupport> own; ///< one or more a row, or empty if the file has no radius column
};

/// CSV with the header `x,y,z,dx,dy,dz` and optionally `,radius`, whose cells are what
/// parse_supports() takes; at most a million rows. Blank lines and lines that start
/// with # are skipped. Error: bad_input, naming line and column. `name` is what error messages call
/// it.
Result<ControlVectors> parse_control_vectors(std::string_view text, std::string_view name);
Result<ControlVectors> read_control_vectors(const std::filesystem::path& path);

} // namespace nendo::deform
