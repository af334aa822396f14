#pragma once
// A take as one binary glTF 2.0 file that animates by itself: the model with morph targets, and the
// hands as skinned skeletons. In metres, y up, as the stage is; a node scales the model to it.
//
// - Vertices are the mesh's, in its order; faces of more than three corners are fans of triangles.
// - A take of Type-1 is exact: targets along each axis, and against it, for each control vector
//   (control_morphs.hpp).
// - Any other (commits, ways in several links, Type-2) has key shapes (key_shapes.hpp), a target
//   each, of which at any time two are mixed.
// - Normals are the rest shape's alone; Blender makes its own of the faces.
// - Time 0 is the first frame's; weights and joints are interpolated linearly, as players do.

#include <cstdint>
#include <filesystem>
#include <string>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

struct GltfOptions {
  double tolerance = 1e-4; ///< of key shapes, as a fraction of the model's diagonal
  bool hands = true;
  std::string generator = "Nendo";
  /// Limits the weights of key shapes. Each key has one weight for each target, and a reader of the
  /// file needs 4 bytes for each.
  std::uint64_t most_weights = std::uint64_t{1} << 28;
};

/// Exports the frames to `path`. It reads them once, or twice if they turn out not to be linear in
/// control vectors. The file is kept in memory until it is written. Blocks. Errors: those of
/// `open`, ChosenFrames::make(), ChosenFrames::next() and GlbFile::write(); bad_input (numbers that
/// 32-bit floats cannot hold), failed (too many weights).
Result<Exported> export_gltf(const OpenFrames& open, const Choice& choice,
                             const GltfOptions& options, const std::filesystem::path& path);

} // namespace nendo::exporting
