#pragma once
// The view in a window.

#include <cstdint>
#include <memory>
#include <string>

#include "session/observer.hpp"

namespace nendo::session {

struct ViewOptions {
  bool window = false;
  std::string screenshot;   ///< where the last picture goes, .png; empty: nowhere
  std::uint32_t frames = 0; ///< pictures after which the run ends; 0: as the person likes
};

/// Opens the window, on the main thread, where all of its calls belong. Errors: failed
/// (no screen, no OpenGL, or built without), with what to do without it.
Result<std::unique_ptr<Observer>> open_live_view(const ViewOptions& options, const RunOptions& run);

} // namespace nendo::session
