#pragma once
// Draws the picture of a run: the model in the hands as they grabbed it, and as they left it.

#include <filesystem>

#include <nendo/flow/deform_loop.hpp>

#include "render/scene_frame.hpp"

namespace nendo::session {

class RunPicture {
public:
  /// Does nothing, and writes nothing, if `path` is empty.
  RunPicture(std::filesystem::path path, const deform::Mesh& model);

  /// Takes a frame. Call it for each frame that the main thread sees, from the beginning on.
  /// Allocates.
  void add(const flow::Frame& frame);
  /// Says where the vertices of the last frame's model rest, which decides about the triangles of
  /// the final shape (triangles.hpp).
  void set_rest(const deform::Points& rest) {
    if (!path_.empty()) last_rest_ = rest;
  }
  /// Draws and writes the picture. Call it after the last frame, with the final shape. Blocks for
  /// some seconds. Error: failed.
  Result<void> write(const deform::Mesh& final_shape);

private:
  std::filesystem::path path_;
  deform::Mesh before_;
  deform::Points last_rest_;
  render::HoldTracker holds_;
  render::SceneFrame first_, last_;
  double units_per_metre_ = 0.0; ///< 0: no frame was added
};

} // namespace nendo::session
