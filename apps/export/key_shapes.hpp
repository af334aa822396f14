#pragma once
// A motion of many vertices as a few shapes, between which each vertex goes straight: a shape is
// kept when going straight on past it would leave some frame in between farther off than the
// tolerance.

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace nendo::exporting {

class KeyShapes {
public:
  using Shape = Eigen::Matrix3Xf; ///< 3 by #vertices; any place or displacement
  /// Takes a key, in the order of time.
  using Keep = std::function<void(float time_s, const Shape& shape)>;

  /// tolerance: the farthest that a vertex may be off. Frames between two keys are kept in memory,
  /// at most most_bytes of them and most_between.
  KeyShapes(double tolerance, Keep keep, std::size_t most_bytes = std::size_t{256} << 20);
  static constexpr std::size_t most_between = 62;

  /// The next frame; its time is greater than that of the one before.
  void add(float time_s, Shape shape);
  /// The last frame becomes a key; the last call.
  void finish();

  /// The farthest that a vertex of any frame is off, between the keys; exactly measured.
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
  std::size_t most_bytes_;
  std::vector<Moment> window_;  ///< the latest key and all frames since
  double straight_error_ = 0.0; ///< from the key to the last but one, or to the last
  double greatest_error_ = 0.0;
};

} // namespace nendo::exporting
