#include "viewer/motion_sharpness.hpp"

namespace nendo::viewer {

// A sharper part is tried only if its pictures would be quick enough even if all the time went into
// pixels. So the same scene never makes it change to and fro.
void MotionSharpness::took(double ms) noexcept {
  constexpr int enough = 8; // pictures, of which one may have waited for another program
  mean_ms_ = pictures_ == 0 ? ms : mean_ms_ + 0.2 * (ms - mean_ms_);
  if (++pictures_ < enough) return;
  const auto sharper_ms = [&] {
    const double ratio = parts[step_ - 1] / parts[step_];
    return mean_ms_ * ratio * ratio;
  };
  if (mean_ms_ > max_ms && step_ + 1 < parts.size())
    ++step_;
  else if (step_ > 0 && sharper_ms() < 0.9 * max_ms)
    --step_;
  else
    return;
  pictures_ = 0;
}

} // namespace nendo::viewer
