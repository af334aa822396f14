#pragma once
// Exports each frame as a mesh file. The files are numbered from 1.

#include <string>

#include <nendo/deform/mesh.hpp>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// A file name with one placeholder for a number, as in printf: %d, or %04d for four digits with
/// leading zeros (1 to 9 digits). %% is a percent sign.
class NumberedName {
public:
  /// Error: usage, naming --out, if there is not exactly one placeholder or a percent sign is
  /// followed by something else.
  static Result<NumberedName> parse(const std::string& pattern);
  std::string of(std::uint64_t number) const;

private:
  std::string before_, after_;
  std::size_t digits_ = 1;
};

/// Writes the frames to files that are named by `pattern`, which ends in .obj or .ply. Each file is
/// written atomically, as by deform::write_mesh(). Blocks. Errors: those of ChosenFrames::next();
/// usage (no placeholder), failed (a file cannot be written; the message gives the number of
/// finished frames).
Result<Exported> export_mesh_sequence(ChosenFrames& frames, const std::string& pattern);

} // namespace nendo::exporting
