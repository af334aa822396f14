#pragma once
// What there is to draw, wherever it comes from: a mesh is a take of one moment.

#include <filesystem>
#include <functional>

#include <nendo/base/result.hpp>
#include <nendo/viewer/scene_frame.hpp>

namespace nendo::takes {

struct Take {
  deform::Mesh rest;            ///< settles faces, scale and place
  double units_per_metre = 0.0; ///< from the model to the stage; 0: as the loop would put it there
  double duration_s = 0.0;      ///< 0: nothing moves
  /// The moment at a time from 0 to duration_s, in any order. May block. Errors as read_take().
  std::function<Result<viewer::SceneFrame>(double time_s)> moment_at;
};

/// Of a file, by what is in it: a mesh, a recording, whose loop runs again without a clock, or, by
/// its name, a timeline. Errors: bad_input, as deform::read_mesh(), TakeReader::open(),
/// recorded_model() and TimelineFrames::open().
Result<Take> read_take(const std::filesystem::path& path);

} // namespace nendo::takes
