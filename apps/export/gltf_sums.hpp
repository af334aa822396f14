#pragma once
// Exports takes whose shapes are weighted sums of morph targets, exactly: of the functions of
// puppets, or of control vectors.

#include <filesystem>
#include <optional>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"
#include "export/gltf_export.hpp"

namespace nendo::exporting {

/// What an exact export needs to know of its frames.
struct SumTake {
  takes::FrameSource& source;
  ChosenFrames& frames;
  const Choice& choice;
  const GltfOptions& options;
  const std::filesystem::path& path;
};

/// A puppet that was edited on the way is another one from there on: each version of it, and of the
/// model, is a mesh of its own, over what the puppets before left in the shape. Returns nothing if
/// a shape is no sum of the functions, or if the fingertips touch the model. Errors: as
/// export_gltf().
Result<std::optional<Exported>> by_functions(const SumTake& take);
/// The same by the control vectors of a take whose model stays one.
Result<std::optional<Exported>> by_control_vectors(const SumTake& take);

} // namespace nendo::exporting
