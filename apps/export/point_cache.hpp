#pragma once
// Exports point caches. A point cache has every vertex of every frame as 32-bit floats, in the
// mesh's order and units. A modifier in a 3D program plays it over the recorded model.
//
// PC2 (3ds Max, Blender) is little-endian: "POINTCACHE2" and a zero byte, int32 version 1, int32
// number of points, float first frame, float frames per sample, int32 number of samples; then x y z
// of every point, sample by sample. MDD (LightWave, Blender) is big-endian: int32 number of frames,
// int32 number of points, a float time in seconds for each frame; then x y z of every point, frame
// by frame.

#include <filesystem>
#include <functional>
#include <memory>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

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
