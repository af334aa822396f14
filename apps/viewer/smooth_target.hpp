#pragma once
// A frame buffer that may have several samples for each pixel, so that edges are smooth also where
// the window's own buffer has one sample a pixel. All calls belong to the thread that has the
// OpenGL context.

#include "render/image.hpp"

namespace nendo::viewer {

class SmoothTarget {
public:
  SmoothTarget() = default;
  ~SmoothTarget();
  SmoothTarget(const SmoothTarget&) = delete;
  SmoothTarget& operator=(const SmoothTarget&) = delete;

  /// Makes this the frame buffer, of that size; if `smooth`, with several samples for each pixel as
  /// far as this OpenGL has them. If it has no such buffer, the window's own remains the frame
  /// buffer.
  void begin(render::Size size, bool smooth);
  /// Makes the window's buffer the frame buffer again, and copies the picture into it, `below`
  /// pixels above the bottom.
  void end(int below) const;
  /// Returns whether end() may be called again: the picture is still there.
  bool keeps() const noexcept { return frame_buffer_ != 0; }

private:
  void make(render::Size size, bool smooth);
  void drop() noexcept;

  static constexpr int max_samples = 4;
  unsigned frame_buffer_ = 0;
  unsigned colours_ = 0, depths_ = 0;
  render::Size size_;
  bool smooth_ = false;
};

} // namespace nendo::viewer
