#pragma once
// A take that can be drawn at any time, read from a mesh, a recording or a timeline. A mesh is a
// take of one moment.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "render/scene_frame.hpp"
#include "takes/frame_source.hpp"

namespace nendo::takes {

struct Take {
  deform::Mesh rest;            ///< the model at rest: it defines faces, scale and place
  double units_per_metre = 0.0; ///< model to stage; 0 means as the loop would place it
  double duration_s = 0.0;      ///< 0 if nothing moves
  double first_sample_s = 0.0;  ///< the mean time of the gloves' first samples in a recording
  /// Makes the scene at a time from 0 to duration_s, in any order. May block. Errors: those of
  /// read_take().
  std::function<Result<render::SceneFrame>(double time_s)> frame_at;
  /// Opens its frames from the beginning; null for a mesh. May block. Errors: those of read_take().
  std::function<Result<std::unique_ptr<FrameSource>>()> open{};
};

/// Reads a take from a file. A timeline is known by its name, a mesh or a recording by its content.
/// `reading` is of a mesh alone, and `model` names the model of a recording or timeline that is no
/// longer where it was. The loop of a recording runs again without a clock. Errors: usage (a
/// `model` of a mesh); bad_input, as from deform::read_mesh(), TakeReader::open(), recorded_model()
/// and TimelineFrames::open().
Result<Take> read_take(const std::filesystem::path& path, const deform::ReadOptions& reading = {},
                       const std::string& model = {});

/// Returns the times of the first frame, and of those that differ the most from all that were
/// chosen before, and that the hands hold for 0.2 s, if there are such: in the values of a puppet's
/// functions, or else in the hands' joint angles (farthest-point sampling, Gonzalez 1985). At most
/// `count` times, in their order; fewer if no other frame differs. Reads `frames` to the end.
/// Blocks and allocates.
std::vector<double> key_poses(FrameSource& frames, std::size_t count);

} // namespace nendo::takes
