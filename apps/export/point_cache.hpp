#pragma once
// Point caches: every vertex of every frame as 32-bit floats, in the mesh's order and units, for a
// modifier over the model that was recorded.
//
// PC2 (3ds Max, Blender), little-endian: "POINTCACHE2" and a zero byte, int32 version 1, int32
// points, float first frame, float frames a sample, int32 samples; then x y z of every point,
// sample by sample. MDD (LightWave, Blender), big-endian: int32 frames, int32 points, a float time
// in seconds a frame; then x y z likewise.

#include <filesystem>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

enum class PointCache { pc2, mdd };

/// `frames` must be at an even rate. Blocks. Errors: those of ChosenFrames::next(); failed (cannot
/// be written), bad_input (a vertex that 32-bit floats cannot hold).
Result<Exported> export_point_cache(ChosenFrames& frames, PointCache format,
                                    const std::filesystem::path& path);

} // namespace nendo::exporting
