#pragma once
// The view in a window.

#include <cstdint>
#include <memory>
#include <string>

#include "session/observer.hpp"

namespace nendo::session {

struct ViewOptions {
  bool window = false;
  bool contact = false;     ///< shows at first where hands touch clay
  std::string screenshot;   ///< where the last picture goes, .png; empty: nowhere
  std::uint32_t frames = 0; ///< pictures after which the run ends; 0: as the person likes
};

/// Opens the window. This and all calls of the window belong to the main thread. Errors: failed (no
/// screen, no OpenGL, or built without the view); the message says what to do instead.
Result<std::unique_ptr<Observer>> open_live_view(const ViewOptions& options, const RunOptions& run);

} // namespace nendo::session
