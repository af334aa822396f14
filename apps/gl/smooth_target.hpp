#pragma once
// A framebuffer for the scene. All calls: the thread with the OpenGL context.

#include "render/image.hpp"

namespace nendo::gl {

/// A framebuffer with optional multisampling, for smooth edges if the window's own buffer has one
/// sample per pixel.
class SmoothTarget {
public:
  SmoothTarget() = default;
  ~SmoothTarget();
  SmoothTarget(const SmoothTarget&) = delete;
  SmoothTarget& operator=(const SmoothTarget&) = delete;

  /// Binds this framebuffer, of that size and, with `smooth`, multisampled as far as this OpenGL
  /// supports it. Without such a buffer, the window's own stays bound.
  void begin(render::Size size, bool smooth);
  /// Binds the window's buffer, and copies the picture into it, in that size, `below` pixels above
  /// the bottom.
  void end(render::Size shown, int below) const;
  /// Returns whether the picture still exists, so that end() may be called again.
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

} // namespace nendo::gl
