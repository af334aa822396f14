#pragma once
// Control vectors from a file, for deforming without gloves or clock.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/supports.hpp>

namespace nendo::deform {

struct ControlVectors {
  Points starts;                ///< 3 by #rows, the start points c_i
  Points displacements;         ///< 3 by #rows, the displacements g_i
  std::vector<OwnSupport> own;  ///< one or more per row, or empty if the file has no radius column
  std::string columns_not_read; ///< other columns, such as "note, weight"; empty: there are none
};

/// Parses a table (nendo/base/table.hpp) with the columns x, y, z, dx, dy, dz and, if wanted,
/// radius, in any order, and at most a million rows. A cell of the radius column is what
/// parse_supports() takes. `name` is what error messages call the text. Error: bad_input, with the
/// line and the column.
NENDO_API Result<ControlVectors> parse_control_vectors(std::string_view text,
                                                       std::string_view name);
/// Reads such a file. Blocks for as long as the disk does. Error: bad_input, also for a file that
/// cannot be read.
NENDO_API Result<ControlVectors> read_control_vectors(const std::filesystem::path& path);

} // namespace nendo::deform
