#pragma once
// A mesh file a frame, numbered from 1.

#include <string>

#include <nendo/deform/mesh.hpp>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// A file name with one place for a number, as printf has it: %d, or %04d with leading zeros up to
/// four digits (1 to 9); %% is a percent sign.
class NumberedName {
public:
  /// Error: usage, of --out (it has no such place, or more than one, or something else after a
  /// percent sign).
  static Result<NumberedName> parse(const std::string& pattern);
  std::string of(std::uint64_t number) const;

private:
  std::string before_, after_;
  std::size_t digits_ = 1;
};

/// `pattern` ends in .obj or .ply. Each file is written as deform::write_mesh() does, whole or not
/// at all. Blocks. Errors: usage (no place for a number), failed (cannot be written; how many
/// frames there are is told), as ChosenFrames::next().
Result<Exported> export_mesh_sequence(ChosenFrames& frames, const std::string& pattern);

} // namespace nendo::exporting
