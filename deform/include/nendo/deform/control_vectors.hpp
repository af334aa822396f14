#pragma once
// Reads control vectors from a file, for deformation without gloves.

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
  std::string columns_not_read; ///< ignored columns, such as "note, weight"; empty: none
};

/// Parses a table (nendo/base/table.hpp) with the columns x, y, z, dx, dy, dz and optionally
/// radius, in any order, and at most a million rows. parse_supports() parses the cells of the
/// radius column. Error messages call the text `name`. Error: bad_input, with the line and the
/// column.
NENDO_API Result<ControlVectors> parse_control_vectors(std::string_view text,
                                                       std::string_view name);
/// Reads and parses a file. Blocks during disk access. Error: bad_input, also if the file cannot be
/// read.
NENDO_API Result<ControlVectors> read_control_vectors(const std::filesystem::path& path);

} // namespace nendo::deform
