#pragma once
// Reduces a motion of many vertices to a few key shapes, between which vertices are interpolated
// linearly. A shape becomes a key where interpolation without it would exceed the tolerance.

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace nendo::exporting {

class KeyShapes {
public:
  using Shape = Eigen::Matrix3Xf; ///< 3 by #vertices, places or displacements
  /// Receives the keys in the order of time.
  using Keep = std::function<void(float time_s, const Shape& shape)>;

  /// `tolerance` is the greatest error of a vertex. Frames between two keys are kept in memory, at
  /// most `max_bytes` and `max_between` frames.
  KeyShapes(double tolerance, Keep keep, std::size_t max_bytes = std::size_t{256} << 20);
  static constexpr std::size_t max_between = 62;

  /// Adds the next frame. Its time must be greater than the previous one.
  void add(float time_s, Shape shape);
  /// Makes the last frame a key. Nothing may be added afterwards.
  void finish();

  /// Returns the greatest measured error of a vertex over all frames between the keys.
  double greatest_error() const noexcept { return greatest_error_; }

private:
  struct Moment {
    float time_s;
    Shape shape;
  };

  double error_between() const;
  void end_at(std::size_t moment);

  double tolerance_;
  Keep keep_;
  std::size_t max_bytes_;
  std::vector<Moment> window_;  ///< the latest key and all frames since
  double straight_error_ = 0.0; ///< from the key to the last but one, or to the last
  double greatest_error_ = 0.0;
};

} // namespace nendo::exporting
