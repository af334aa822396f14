#pragma once
// How long a window's pictures take.

#include <nendo/flow/histogram.hpp>

namespace nendo::viewer {

/// Of pictures with a new frame of the loop.
struct PictureTimes {
  flow::Histogram whole; ///< from reading the input until the picture is on the screen
  /// Of that, until OpenGL has all that it draws: input, hands, normals, uploads and widgets.
  flow::Histogram preparing;
};

} // namespace nendo::viewer
