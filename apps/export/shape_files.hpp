#pragma once
// Exports the shapes of all frames: as numbered mesh files, or as point caches.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "export/chosen_frames.hpp"

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

/// Exports point caches. A point cache has every vertex of every frame as 32-bit floats, in the
/// mesh's order and units. A modifier in a 3D program plays it over the recorded model.
///
/// PC2 (3ds Max, Blender) is little-endian: "POINTCACHE2" and a zero byte, int32 version 1, int32
/// number of points, float first frame, float frames per sample, int32 number of samples; then x y
/// z of every point, sample by sample. MDD (LightWave, Blender) is big-endian: int32 number of
/// frames, int32 number of points, a float time in seconds for each frame; then x y z of every
/// point, frame by frame.
enum class PointCache { pc2, mdd };

/// Opens the same frames from the beginning, each time that it is called.
using OpenFrames = std::function<Result<std::unique_ptr<takes::FrameSource>>()>;

/// `choice` must be at an even rate. A point cache has one number of points. So where the model
/// becomes another one, as when it is subdivided, another file begins: NAME-2.pc2 and so on
/// (Exported::files, Exported::begin_s). Reads the frames once for each file, and once more if
/// there are several. Blocks. Errors: those of `open` and ChosenFrames; failed (cannot be written),
/// bad_input (a vertex that 32-bit floats cannot hold).
Result<Exported> export_point_caches(const OpenFrames& open, const Choice& choice,
                                     PointCache format, const std::filesystem::path& path);

} // namespace nendo::exporting
