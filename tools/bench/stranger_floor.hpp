#pragma once
// The floor of a calibration: the accuracy, on the same captures, of an estimator that has the
// wearer's true hand, the true form of the sensors' errors, and the true spreads of all unknowns.
// An estimator with less cannot be better. A second floor has in place of the hand only the spreads
// of such hands, which are unknown for people.

#include <vector>

#include <Eigen/Core>

#include <nendo/hand/calibration.hpp>

#include "bench/judged_wearer.hpp"
#include "bench/stranger_hand.hpp"

namespace nendo::bench {

/// Finds the likeliest values of gains, offsets, curvatures, lags, cross-talk, habits and ends of
/// ranges of one stranger, and of the hand where it is unknown, from the fresh takes and the ends
/// of the free motion. Creep and slips are not modelled.
class StrangerFloor {
public:
  /// `hand` is the true one; without it, the likeliest is found.
  StrangerFloor(const JudgedWearer& wearer, const StrangerHand* hand);

  /// Takes the next moment of a motion, and returns the joints' angles by slot, in radians. The
  /// previous moments determine the state of hysteresis. Angles of absent sensors are 0.
  hand::SensorAngles angles_rad(const CountRow& counts);
  /// Returns how far the hand's pads of thumb and finger (1 to 4) are apart at these angles.
  double pads_apart_m(const hand::SensorAngles& angles_rad, int finger) const;

private:
  /// An unknown joint's angle in a take: what is expected of it, before counts are seen.
  struct Expected {
    std::size_t slot;
    double asked_rad, scatter_rad;
    bool has_habit;
    double deviation_rad; ///< that of the resulting angle, clamped to the joint's range
  };
  struct Take {
    hand::SensorAngles counts{};
    hand::SensorAngles came{}; ///< 1: the counts rose to it, -1: they fell, 0: neither
    std::vector<Expected> expected;
    int touches = -1; ///< a finger, 0: the palm, -1: nothing
    double touch_deviation_m = 0.0;
    Eigen::Index hidden = -1; ///< the unknown of a last joint that has no sensor
  };
  struct End {
    std::size_t slot;
    bool high;
    double counts, deviation_rad;
  };

  static Expected expected_of(hand::PoseId id, std::size_t slot,
                              const std::vector<std::size_t>& touching);
  void add_take(const hand::PoseReading& reading, const hand::SensorAngles& before);
  void add_ends(const JudgedWearer& wearer);
  Eigen::VectorXd residuals(const Eigen::VectorXd& at) const;
  void solve();
  hand::SensorAngles angles_of(const Eigen::VectorXd& at, const hand::SensorAngles& counts,
                               const hand::SensorAngles& came) const;
  double expected_rad(const Eigen::VectorXd& at, const Expected& expected) const;
  StrangerHand hand_at(const Eigen::VectorXd& at) const;

  bool hand_is_known_;
  StrangerHand hand_;
  SensorMask sensors_;
  std::vector<Take> takes_;
  std::vector<End> ends_;
  Eigen::Index hidden_count_ = 0;
  Eigen::VectorXd at_; ///< the last are the parts of the hand, if it is unknown
  /// Of the motion: the count from which a sensor last turned back, and which way it went.
  hand::SensorAngles turned_{}, came_{};
  bool begun_ = false;
};

} // namespace nendo::bench
