#pragma once
// Exports a take by key shapes, between which vertices are interpolated (key_shapes.hpp).

#include <cstdint>
#include <optional>
#include <vector>

#include "export/gltf_take.hpp"
#include "export/key_shapes.hpp"

namespace nendo::exporting {

/// The models of a take, one for each version, whose targets are key shapes.
class KeyShapeModels {
public:
  /// Puts models and targets into `file` as frames are added. `job` and `file` must outlive this.
  /// In model units, a vertex may be off by `tolerance`, of which `frame_error` is how far those of
  /// the frames are off before they are added.
  KeyShapeModels(const GltfJob& job, double tolerance, double frame_error, GlbFile& file);
  KeyShapeModels(const KeyShapeModels&) = delete; // keys_ refers to it
  KeyShapeModels& operator=(const KeyShapeModels&) = delete;

  /// Adds the next frame: the version of its model, its time since the first frame, and how far its
  /// vertices are from the model at rest (3 by #vertices, in the mesh's order). Errors: failed (the
  /// export was stopped, or there are more weights than GltfOptions::max_weights).
  Result<void> add(std::uint32_t version, float time_s, Eigen::Matrix3Xf displacement);
  /// Returns the models, of which there must be one. Nothing may be added afterwards. Errors:
  /// failed (too many weights).
  Result<std::vector<MovingModel>> finish();

private:
  void begin_model(std::uint32_t version);
  void end_model();
  Result<void> check_weights() const;

  const GltfJob& job_;
  double tolerance_;
  double frame_error_;
  GlbFile& file_;
  std::vector<MovingModel> models_;
  double rest_error_ = 0.0;       ///< max error of the last model's frames, before keys are chosen
  std::optional<KeyShapes> keys_; ///< the last model's
};

} // namespace nendo::exporting
