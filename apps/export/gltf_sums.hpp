#pragma once
// Takes whose shapes are weighted sums of morph targets, exactly: of the functions of puppets, or
// of control vectors.

#include <memory>
#include <vector>

#include "export/chosen_frames.hpp"
#include "export/gltf_keys.hpp"
#include "export/gltf_take.hpp"

namespace nendo::exporting {

class ExactMorphs {
public:
  virtual ~ExactMorphs() = default;
  virtual MorphBasis basis() const noexcept = 0;
  /// Adds the next frame, its time since the first, and its vertices in the mesh's order. Returns
  /// false if its shape is no such sum. The frames before remain, and no other may be added then.
  virtual bool add(const flow::Frame& frame, float time_s, const deform::Points& vertices) = 0;
  /// Returns the greatest error of a vertex over the frames, in model units.
  virtual double greatest_error() const noexcept = 0;
  /// Adds the frames to `keys`, each as the sum that it is. Errors: those of KeyShapeModels::add().
  virtual Result<void> give_frames(KeyShapeModels& keys) const = 0;
  /// Puts the models with their targets into `file`, and returns them in the order of time. Nothing
  /// else may be called afterwards.
  virtual std::vector<MovingModel> make_models(GlbFile& file) = 0;
};

/// By the functions of puppets. A puppet that was edited on the way is another one from there on:
/// each version of it, and of the model, is a mesh of its own, over what the puppets before left in
/// the shape. `frames` must outlive it.
std::unique_ptr<ExactMorphs> morphs_by_functions(const ChosenFrames& frames);
/// By the control vectors of a take whose model stays one. `source` must be at the first frame and
/// outlive it.
std::unique_ptr<ExactMorphs> morphs_by_control_vectors(const takes::FrameSource& source);

} // namespace nendo::exporting
