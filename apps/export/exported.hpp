#pragma once
// What every export tells of itself, and what those that go through a take more than once need.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "takes/frame_source.hpp"

namespace nendo::exporting {

/// How a model's motion became morph targets.
struct MorphReport {
  bool by_control_vectors = false; ///< otherwise by key shapes
  std::size_t targets = 0;
  std::size_t keys = 0; ///< moments between which weights are interpolated
  /// The farthest that a vertex is from nendo's own, of all exported frames; parts of the model's
  /// diagonal.
  double greatest_error = 0.0;
};

struct Exported {
  std::vector<std::string> files;
  std::uint64_t frames = 0;
  double first_s = 0.0; ///< since the take began
  double last_s = 0.0;
  std::uint64_t bytes = 0; ///< of all files
  std::optional<MorphReport> morphs{};
  bool exact = true; ///< nothing was missing in the take up to the last frame
};

/// Begins the same frames anew.
using OpenFrames = std::function<Result<std::unique_ptr<takes::FrameSource>>()>;

} // namespace nendo::exporting
