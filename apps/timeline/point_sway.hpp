#pragma once
// How far the points of a puppet are off where the hand that plays it is off.

#include <vector>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

class PointSway {
public:
  /// Of the functions that listen to that hand at any time. Without a puppet there are none.
  PointSway(const Timeline& timeline, Side side);

  /// Returns the numbers of that hand to which functions listen.
  Eigen::VectorXd signals(const puppet::HandState& hand) const;
  /// Returns how far any point is off where the signals are `one` in place of `other`, in metres on
  /// the stage. It is a bound: limits of functions, and ways that cancel each other, make it less.
  double off_m(const Eigen::VectorXd& one, const Eigen::VectorXd& other) const;
  /// Returns the times at which functions may grab the hands. If hands are off there, so
  /// are the values from then on.
  const std::vector<double>& held_at_s() const noexcept { return held_at_s_; }

private:
  void add(const Timeline& timeline, std::size_t function, const puppet::HandSignal& input,
           bool moves_twin);

  std::vector<puppet::HandSignal> inputs_;
  Eigen::MatrixXd reach_m_; ///< of each point, for a unit of each input; #points by #inputs
  std::vector<double> held_at_s_;
};

} // namespace nendo::timeline
