#pragma once
// The picture that a run leaves behind: the model in the hands as they took hold, and as they left
// it.

#include <filesystem>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/viewer/scene_frame.hpp>

namespace nendo::session {

class RunPicture {
public:
  /// Follows nothing and writes nothing if `path` is empty.
  RunPicture(std::filesystem::path path, const deform::Mesh& model, const flow::LoopOptions& loop);

  /// Each frame that the main thread sees, the first one soon. Allocates.
  void see(const flow::Frame& frame);
  /// After the last frame, with the final shape. Draws and writes; blocks for some seconds. Errors:
  /// failed.
  Result<void> write(const deform::Points& final_shape);

private:
  std::filesystem::path path_;
  deform::Mesh before_;
  deform::Supports supports_;
  viewer::HoldTracker holds_;
  viewer::SceneFrame first_, last_;
  double units_per_metre_ = 0.0; ///< 0: no frame has been seen
};

} // namespace nendo::session
