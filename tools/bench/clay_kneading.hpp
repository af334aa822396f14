#pragma once
// Scripted hands that make shapes of a ball of clay: a flat cake, a bowl, a nose and a sausage.

#include <cstddef>
#include <span>
#include <vector>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/contact_part.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/hand/hand_body.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::bench {

enum class KneadedShape { cake, bowl, nose, sausage };

/// Lengths are in millimetres, and the ball is about the origin.
class ClayKneading {
public:
  static constexpr double rate_hz = 90.0;
  static constexpr std::size_t bodies = 2;

  explicit ClayKneading(KneadedShape shape);

  double ball_radius_mm() const noexcept;
  /// How soft the clay is: ClayOptions::radius_mm.
  double softness_mm() const noexcept;
  int ticks() const noexcept;
  /// Otherwise the hands carry and turn it.
  bool lies_on_table() const noexcept { return shape_ != KneadedShape::sausage; }
  /// Returns where the vertices of the clay are, 3 x n. The hands that roll it stay about its
  /// middle, and across its long axis.
  void see(const Eigen::Matrix3Xd& vertices);
  /// Returns the parts of both bodies in that tick: of two hands, or of a hand and a table.
  std::span<const deform::ContactPart> at(int tick);

private:
  void place_hand(std::size_t body, const hand::JointAngles& angles,
                  const Eigen::Isometry3d& wrist_mm);
  void place_table(double top_mm);
  void put_away(std::size_t body);
  void pose_cake(double time_s);
  void pose_bowl(double time_s);
  void pose_nose(double time_s);
  void pose_sausage(double time_s);

  KneadedShape shape_;
  hand::HandSkeleton skeleton_;
  hand::HandBody body_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero(); ///< that the hands stay about
  double turn_rad_ = 0.0;                            ///< about Z, of the hands that roll
  hand::JointAngles pinch_;                          ///< the last one, with which the next begins
  std::vector<deform::ContactPart> parts_;
};

struct KneadedClay {
  deform::Mesh shape;
  double worst_volume = 0.0; ///< relative
  double last_volume = 0.0;
  double penetration_p99_mm = 0.0;
  double mean_us = 0.0, p99_us = 0.0;
  std::size_t max_held = 0;
  double turned_rad = 0.0; ///< as a whole, there and back
};

/// Lengths along the principal axes, the longest first.
Eigen::Vector3d extents_mm(const Eigen::Matrix3Xd& vertices);

struct KneadingOptions {
  int level = 6;        ///< level of the ball (reference/icosphere.hpp)
  double scale = 1.0;   ///< scale of the ball
  bool refines = false; ///< ten times a second (deform::Refiner)
};

/// Makes a shape of a ball.
KneadedClay knead(KneadedShape shape, const KneadingOptions& options);

} // namespace nendo::bench
