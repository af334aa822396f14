#pragma once
// How sharp a scene that moves is drawn where there is no graphics card: as sharp as pictures of
// `max_ms` allow. Not thread-safe.

#include <array>
#include <cstddef>

namespace nendo::viewer {

class MotionSharpness {
public:
  /// Parts of the window's width and height in pixels, the sharpest first.
  static constexpr std::array parts{1.0, 0.85, 0.7, 0.6, 0.5};
  static constexpr double max_ms = 45.0; ///< a whole picture, 20 per second with a margin

  double part() const noexcept { return parts[step_]; }
  /// Notes how long a picture of that part took.
  void took(double ms) noexcept;

private:
  std::size_t step_ = 0;
  double mean_ms_ = 0.0; ///< the mean of the latest pictures of this part
  int pictures_ = 0;     ///< the number of pictures of this part
};

} // namespace nendo::viewer
