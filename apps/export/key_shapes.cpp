#include "export/key_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nendo::exporting {

KeyShapes::KeyShapes(double tolerance, Keep keep, std::size_t max_bytes)
    : tolerance_(tolerance), keep_(std::move(keep)), max_bytes_(max_bytes) {}

/// Of the window's inner frames, if its first and its last one are keys.
double KeyShapes::error_between() const {
  const Moment& from = window_.front();
  const Moment& to = window_.back();
  float worst = 0.0F;
  for (std::size_t at = 1; at + 1 < window_.size(); ++at) {
    const float share = (window_[at].time_s - from.time_s) / (to.time_s - from.time_s);
    const float squared = ((1.0F - share) * from.shape + share * to.shape - window_[at].shape)
                              .colwise()
                              .squaredNorm()
                              .maxCoeff();
    worst = std::max(worst, squared);
    if (std::sqrt(static_cast<double>(worst)) > tolerance_) break; // it will not be kept
  }
  return std::sqrt(static_cast<double>(worst));
}

void KeyShapes::add(float time_s, Shape shape) {
  const auto shape_bytes = static_cast<std::size_t>(shape.size()) * sizeof(float);
  window_.push_back({time_s, std::move(shape)});
  if (window_.size() == 1) keep_(time_s, window_.front().shape);
  if (window_.size() <= 2) return;
  const double error = error_between();
  if (!(error <= tolerance_)) {
    end_at(window_.size() - 2);
    return;
  }
  straight_error_ = error;
  if (window_.size() >= max_between + 2 || window_.size() * shape_bytes > max_bytes_)
    end_at(window_.size() - 1);
}

/// That frame becomes a key, up to which straight_error_ holds.
void KeyShapes::end_at(std::size_t moment) {
  greatest_error_ = std::max(greatest_error_, std::exchange(straight_error_, 0.0));
  keep_(window_[moment].time_s, window_[moment].shape);
  window_.erase(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(moment));
}

void KeyShapes::finish() {
  if (window_.size() > 1) end_at(window_.size() - 1);
}

} // namespace nendo::exporting
