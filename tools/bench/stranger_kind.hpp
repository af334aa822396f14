#pragma once
// The means and spreads from which the joints, sensors and habits of each stranger are drawn. The
// floor of calibration has these, and no value of a single stranger.

#include <array>
#include <cstddef>
#include <vector>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/joints.hpp>

namespace nendo::bench {

/// The ends of a joint's range and a relaxed hand's angle, degrees; thousandths of a radian a count
/// and the count at 0. A gain of 0: there is no such sensor.
struct StrangerJoint {
  double low, high, relaxed, gain, offset;
};

namespace stranger_kind_parts {
inline constexpr StrangerJoint mcp{-12, 91, 28, 12.8, 70}, pip{-2, 106, 38, 13.2, 64};
inline constexpr StrangerJoint dip{-3, 74, 14, 13.0, 62}, gap{-3, 24, 6, 9.0, 110};
} // namespace stranger_kind_parts

/// By sensor slot.
inline constexpr std::array<StrangerJoint, sensor_slots> stranger_joints = [] {
  using namespace stranger_kind_parts;
  return std::array<StrangerJoint, sensor_slots>{{{-6, 84, 30, 11.5, 98},
                                                  {-8, 57, 14, 13.0, 106},
                                                  {-10, 78, 18, 13.0, 92},
                                                  {-4, 56, 22, 11.5, 108},
                                                  mcp,
                                                  pip,
                                                  dip,
                                                  {},
                                                  mcp,
                                                  pip,
                                                  dip,
                                                  gap,
                                                  mcp,
                                                  pip,
                                                  dip,
                                                  gap,
                                                  mcp,
                                                  pip,
                                                  dip,
                                                  gap,
                                                  {-2, 25, 6, 9.0, 90},
                                                  {-66, 74, 4, 13.5, 126},
                                                  {-30, 20, 0, 12.5, 124},
                                                  {}}};
}();

/// How far strangers differ: standard deviations, but `bow` and the lags, which are the ends of
/// uniform distributions.
struct StrangerSpread {
  static constexpr double low = 0.03, high = 0.06; ///< fractions of a joint's range
  /// How far short of a joint's end a free motion stops: a normal variable's size.
  static constexpr double short_deg = 2.5;
  static constexpr double habit_deg = 2.5;
  static constexpr double scatter_deg = 5.0;
  static constexpr double side_by_side_deg = 1.5;
  static constexpr double touch_deg = 9.0; ///< spread of the joints from which a touch is sought
  static constexpr double relaxed_deg = 8.0;
  static constexpr double log_gain = 0.13;
  static constexpr double offset_counts = 14.0;
  static constexpr double bow = 0.035; ///< fraction of a joint's range
  static constexpr double min_lag_deg = 0.3, max_lag_deg = 1.5;
};

/// A sensor reads a part of another joint's angle.
struct StrangerRead {
  Sensor of, by;
  double mean, spread;
  bool is_cross_talk; ///< the product's couplings do not contain it
};
std::vector<StrangerRead> stranger_reads();

/// The angles, in degrees, from which a touch with the palm (0) or a finger (1 to 4) is sought, in
/// the order of touching_slots().
inline constexpr double stranger_touch_deg[5][7] = {{62, 40, 40, 12, 0, 0, 0},
                                                    {55, 20, 20, 32, 45, 48, 22},
                                                    {62, 22, 25, 32, 48, 48, 22},
                                                    {70, 32, 25, 32, 52, 50, 22},
                                                    {74, 40, 25, 32, 55, 48, 22}};

/// The joints that bring the thumb to a finger's pad, or to the palm (digit 0), by slot.
std::vector<std::size_t> touching_slots(std::size_t digit);
/// Returns 1 to 4 for the tips of index to little finger, and 0 for the palm.
std::size_t touching_digit(hand::Joint with);

} // namespace nendo::bench
