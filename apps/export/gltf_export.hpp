#pragma once
// Exports a take as one binary glTF 2.0 file that plays without Nendo. It has the model with morph
// targets, and the hands as skinned skeletons. Units are metres and y points up, as on the stage. A
// node scales the model to the stage.
//
// - Each material has a primitive, with its base colour and its texture, and with vertices of its
//   own (gltf_model.hpp): those of the mesh, in its order, and after them copies of those that
//   have several texture coordinates. They keep their colours. Faces become triangles as deform's
//   triangles.hpp says.
// - A take of a puppet of Type-1 is exact. Each function is a target that has its name, and a
//   frame's weights are the values of the functions, from 0 to 1 (FunctionMorphs).
// - Any other take of Type-1 is exact. For each control vector it has targets along each axis and
//   against it (ControlMorphs).
// - All other takes (with commits, motion in several links, or Type-2) have key shapes
//   (morphs.hpp). Each key shape is a target, and at any time two of them are mixed. As long
//   as such a take is a sum of functions or of control vectors, its frames are that sum, which is
//   off by ControlMorphs::max_error at most and mostly by 1e-7 of the diagonal. The tolerance and
//   the report include that.
// - Where the model becomes another one, as when it is subdivided, or its puppet is edited, each
//   part of the take has a mesh of its own. Its node is shown in its time by an animation of its
//   scale, which is 0 otherwise.
// - Targets also move the normals, as far as sums of targets can (MorphNormals). Blender
//   computes its own from the faces.
// - A take of gloves alone has no model, and the file then has the hands alone.
// - Time 0 is that of the first frame. Weights and joints are interpolated linearly, as players do.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "export/chosen_frames.hpp"

namespace nendo::exporting {

struct GltfOptions {
  double tolerance = 0.01; ///< error limit of key shapes, as a fraction of the model's diagonal
  std::optional<double> tolerance_m{}; ///< in place of it, as a length on the stage
  bool hands = true;
  std::string generator = "Nendo";
  /// Limits the weights of key shapes. Each key has one weight for each target, and a reader of the
  /// file needs 4 bytes for each.
  std::uint64_t max_weights = std::uint64_t{1} << 28;
};

/// Exports the frames of `source` to `path`. The source must be new, without a call of next(), and
/// is played once. The targets and the file are kept in memory until it is written. Blocks. Errors:
/// those of ChosenFrames::make(), ChosenFrames::next() and GlbFile::write(); bad_input (numbers
/// that 32-bit floats cannot hold, or there is neither a model nor a hand), failed (too many
/// weights).
Result<Exported> export_gltf(takes::FrameSource& source, const Choice& choice,
                             const GltfOptions& options, const std::filesystem::path& path);

} // namespace nendo::exporting
