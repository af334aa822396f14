#include "bench/stranger_floor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include <nendo/base/units.hpp>
#include <nendo/hand/calibration_poses.hpp>

#include "bench/stranger_kind.hpp"

namespace nendo::bench {
namespace {

using Eigen::Index;
using hand::SensorAngles;

// The unknowns, each 0 at its mean and in its standard deviations: seven of each slot, then a part
// of each that is read, then last joints without a sensor, then the hand if it is unknown.
enum class FloorTerm : Index { log_gain, offset, bow, lag, habit, low, high, count };

constexpr Index floor_terms = static_cast<Index>(FloorTerm::count);

Index floor_unknown(std::size_t slot, FloorTerm term) {
  return static_cast<Index>(slot) * floor_terms + static_cast<Index>(term);
}
constexpr Index first_floor_read = static_cast<Index>(sensor_slots) * floor_terms;
Index first_floor_hidden() {
  return first_floor_read + static_cast<Index>(stranger_reads().size());
}

// What takes and ends have beyond the modelled: noise, creep, rounding.
constexpr double unmodelled_rad = from_degrees(0.5);
constexpr double unmodelled_m = 0.0003;
constexpr double beyond_end_rad = 0.03; ///< to which a stranger's poses may overstep a range
constexpr double hidden_deviation_deg = 12.0;
// How far short of an end a free motion stops: the mean and the deviation of a normal variable's
// size.
const double short_mean_rad =
    from_degrees(StrangerSpread::short_deg) * std::sqrt(2.0 / std::numbers::pi);
const double short_deviation_rad =
    from_degrees(StrangerSpread::short_deg) * std::sqrt(1.0 - 2.0 / std::numbers::pi);

bool has_joint(std::size_t slot, SensorMask sensors) {
  return stranger_joints[slot].gain != 0.0 && sensors.has(static_cast<Sensor>(slot));
}

double floor_range_rad(std::size_t slot) {
  return from_degrees(stranger_joints[slot].high - stranger_joints[slot].low);
}
double floor_gain_rad(const Eigen::VectorXd& at, std::size_t slot) {
  return 1e-3 * stranger_joints[slot].gain *
         std::exp(StrangerSpread::log_gain * at[floor_unknown(slot, FloorTerm::log_gain)]);
}
double floor_low_rad(const Eigen::VectorXd& at, std::size_t slot) {
  return from_degrees(stranger_joints[slot].low) +
         StrangerSpread::low * floor_range_rad(slot) * at[floor_unknown(slot, FloorTerm::low)];
}
double floor_high_rad(const Eigen::VectorXd& at, std::size_t slot) {
  return from_degrees(stranger_joints[slot].high) +
         StrangerSpread::high * floor_range_rad(slot) * at[floor_unknown(slot, FloorTerm::high)];
}
double floor_lag_rad(const Eigen::VectorXd& at, std::size_t slot) {
  constexpr double mean = 0.5 * (StrangerSpread::min_lag_deg + StrangerSpread::max_lag_deg);
  constexpr double width = StrangerSpread::max_lag_deg - StrangerSpread::min_lag_deg;
  return from_degrees(mean + width / std::sqrt(12.0) * at[floor_unknown(slot, FloorTerm::lag)]);
}
/// The line of a sensor that is not bent, at counts to which it rose (1), fell (-1) or neither (0).
double floor_line_rad(const Eigen::VectorXd& at, std::size_t slot, double counts, double came) {
  const double offset_counts =
      stranger_joints[slot].offset +
      StrangerSpread::offset_counts * at[floor_unknown(slot, FloorTerm::offset)];
  return floor_gain_rad(at, slot) * (counts - offset_counts) + came * floor_lag_rad(at, slot);
}
double floor_bow_rad(const Eigen::VectorXd& at, std::size_t slot) {
  return StrangerSpread::bow / std::sqrt(3.0) * floor_range_rad(slot) *
         at[floor_unknown(slot, FloorTerm::bow)];
}

/// The mean and the deviation of a normal variable that is clamped.
struct ClampedMoments {
  double mean, deviation;
};
ClampedMoments clamped_normal(double mean, double deviation, double least, double most) {
  const double a = (least - mean) / deviation, b = (most - mean) / deviation;
  const auto density = [](double x) {
    return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
  };
  const auto below = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  const double under = below(a), over = 1.0 - below(b), within = 1.0 - under - over;
  const double first = density(a) - density(b);
  const double m = under * a + over * b + first;
  const double square = under * a * a + over * b * b + within + a * density(a) - b * density(b);
  return {mean + deviation * m, deviation * std::sqrt(std::max(square - m * m, 0.0))};
}

} // namespace

StrangerFloor::StrangerFloor(const JudgedWearer& wearer, const StrangerHand* hand)
    : hand_is_known_(hand != nullptr), hand_(hand != nullptr ? *hand : StrangerHand::usual()),
      sensors_(wearer.sensors) {
  SensorAngles before{};
  for (std::size_t slot = 0; slot < sensor_slots && !wearer.fresh.free_motion.empty(); ++slot)
    before[slot] = wearer.fresh.free_motion.back()[slot];
  for (const hand::PoseReading& reading : wearer.fresh.takes) {
    add_take(reading, before);
    before = reading.held.mean_counts;
  }
  add_ends(wearer);
  at_ = Eigen::VectorXd::Zero(first_floor_hidden() + hidden_count_ +
                              (hand_is_known_ ? 0 : static_cast<Index>(StrangerHand::parts)));
  solve();
  hand_ = hand_at(at_);
}

void StrangerFloor::add_take(const hand::PoseReading& reading, const SensorAngles& before) {
  const hand::CalibrationPose& pose = hand::pose_of(reading.pose);
  Take& take = takes_.emplace_back();
  take.counts = reading.held.mean_counts;
  std::vector<std::size_t> touching;
  if (pose.touch) {
    take.touches = static_cast<int>(touching_digit(pose.touch->with));
    take.touch_deviation_m =
        std::hypot(pose.touch->deviation_m > 0.003 ? 0.003 : 0.001, unmodelled_m);
    touching = touching_slots(static_cast<std::size_t>(take.touches));
    if (take.touches > 0 && !has_joint(touching.back(), sensors_)) take.hidden = hidden_count_++;
  }
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!has_joint(slot, sensors_)) continue;
    constexpr double min_change_counts = 3.0; // a trembling hand comes from nowhere
    const double change = take.counts[slot] - before[slot];
    take.came[slot] = std::abs(change) < min_change_counts ? 0.0 : std::copysign(1.0, change);
    take.expected.push_back(expected_of(reading.pose, slot, touching));
  }
}

StrangerFloor::Expected StrangerFloor::expected_of(hand::PoseId id, std::size_t slot,
                                                   const std::vector<std::size_t>& touching) {
  const hand::CalibrationPose& pose = hand::pose_of(id);
  // A calibration does not know the angles that a pose leaves open.
  double asked_deg = 0.5 * (stranger_joints[slot].low + stranger_joints[slot].high);
  double scatter_deg = 0.3 * to_degrees(floor_range_rad(slot));
  bool has_habit = false;
  const auto mover = std::find(touching.begin(), touching.end(), slot);
  if (mover == touching.end() && pose.assumed[slot].known()) {
    asked_deg = to_degrees(pose.assumed[slot].angle_rad);
    has_habit = std::abs(asked_deg) > 8.0;
    const bool side_by_side = is_gap(static_cast<Sensor>(slot)) && asked_deg < 5.0;
    scatter_deg = side_by_side ? StrangerSpread::side_by_side_deg : StrangerSpread::scatter_deg;
  }
  const bool flat_pads = id == hand::PoseId::pinch_index_flat;
  if (flat_pads && (slot == 5 || slot == 6)) { // which the touch then bends somewhat
    asked_deg = slot == 5 ? 18.0 : 5.0;
    scatter_deg = 1.5 * StrangerSpread::scatter_deg;
  }
  const double asked_rad = from_degrees(asked_deg), scatter_rad = from_degrees(scatter_deg);
  const Eigen::VectorXd usual = Eigen::VectorXd::Zero(first_floor_read);
  const double comes_out =
      clamped_normal(asked_rad, scatter_rad, floor_low_rad(usual, slot) - beyond_end_rad,
                     floor_high_rad(usual, slot) + beyond_end_rad)
          .deviation;
  return {slot, asked_rad, scatter_rad, has_habit, std::hypot(comes_out, unmodelled_rad)};
}

void StrangerFloor::add_ends(const JudgedWearer& wearer) {
  if (wearer.fresh.free_motion.empty()) return;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!has_joint(slot, sensors_)) continue;
    double pulled_rad = 0.0; // by joints that go their own ways meanwhile
    for (const StrangerRead& read : stranger_reads())
      if (static_cast<std::size_t>(read.of) == slot)
        pulled_rad += 0.35 * floor_range_rad(static_cast<std::size_t>(read.by)) *
                      std::hypot(read.mean, read.spread);
    double least = wearer.fresh.free_motion.front()[slot], most = least;
    for (const CountRow& row : wearer.fresh.free_motion) {
      least = std::min<double>(least, row[slot]);
      most = std::max<double>(most, row[slot]);
    }
    const double deviation_rad = std::hypot(pulled_rad, unmodelled_rad, short_deviation_rad);
    ends_.push_back({slot, false, least, deviation_rad});
    ends_.push_back({slot, true, most, deviation_rad});
  }
}

double StrangerFloor::expected_rad(const Eigen::VectorXd& at, const Expected& expected) const {
  const std::size_t slot = expected.slot;
  const double habit_rad = expected.has_habit ? from_degrees(StrangerSpread::habit_deg) *
                                                    at[floor_unknown(slot, FloorTerm::habit)]
                                              : 0.0;
  return clamped_normal(expected.asked_rad + habit_rad, expected.scatter_rad,
                        floor_low_rad(at, slot) - beyond_end_rad,
                        floor_high_rad(at, slot) + beyond_end_rad)
      .mean;
}

SensorAngles StrangerFloor::angles_of(const Eigen::VectorXd& at, const SensorAngles& counts,
                                      const SensorAngles& came) const {
  static const std::vector<StrangerRead> reads = stranger_reads();
  SensorAngles bent{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (has_joint(slot, sensors_)) bent[slot] = floor_line_rad(at, slot, counts[slot], came[slot]);
  SensorAngles angles = bent;
  constexpr int turns = 8; // each halves what is left, at least
  for (int turn = 0; turn < turns; ++turn) {
    SensorAngles next = bent;
    for (std::size_t k = 0; k < reads.size(); ++k) {
      const StrangerRead& read = reads[k];
      const double part = read.mean + read.spread * at[first_floor_read + static_cast<Index>(k)];
      next[static_cast<std::size_t>(read.of)] -= part * angles[static_cast<std::size_t>(read.by)];
    }
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      if (!has_joint(slot, sensors_)) continue;
      const double start = floor_low_rad(at, slot),
                   part = (angles[slot] - start) / (floor_high_rad(at, slot) - start);
      next[slot] -= floor_bow_rad(at, slot) * 4.0 * part * (1.0 - part);
    }
    angles = next;
  }
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (!has_joint(slot, sensors_)) angles[slot] = 0.0;
  return angles;
}

StrangerHand StrangerFloor::hand_at(const Eigen::VectorXd& at) const {
  if (hand_is_known_) return hand_;
  const double* const first = at.data() + first_floor_hidden() + hidden_count_;
  return StrangerHand(std::span<const double, StrangerHand::parts>(first, StrangerHand::parts));
}

/// The unknowns themselves, the takes' angles and touches, and the ends of ranges.
Eigen::VectorXd StrangerFloor::residuals(const Eigen::VectorXd& at) const {
  std::vector<double> rows(at.data(), at.data() + at.size());
  const StrangerHand hand = hand_at(at);
  for (const Take& take : takes_) {
    SensorAngles angles = angles_of(at, take.counts, take.came);
    for (const Expected& expected : take.expected)
      rows.push_back((angles[expected.slot] - expected_rad(at, expected)) / expected.deviation_rad);
    if (take.touches < 0) continue;
    const auto digit = static_cast<std::size_t>(take.touches);
    if (take.hidden >= 0)
      angles[4 * digit + 2] =
          from_degrees(stranger_touch_deg[digit][6] +
                       hidden_deviation_deg * at[first_floor_hidden() + take.hidden]);
    const Eigen::Vector3d other =
        digit == 0 ? hand.palm_at_little_finger(angles) : hand.pad(digit, angles);
    const Eigen::Vector3d off = (hand.pad(0, angles) - other) / take.touch_deviation_m;
    rows.insert(rows.end(), {off.x(), off.y(), off.z()});
  }
  for (const End& end : ends_) {
    const double reached = floor_line_rad(at, end.slot, end.counts, end.high ? 1.0 : -1.0);
    const double there = end.high ? floor_high_rad(at, end.slot) - short_mean_rad
                                  : floor_low_rad(at, end.slot) + short_mean_rad;
    rows.push_back((reached - there) / end.deviation_rad);
  }
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), static_cast<Index>(rows.size()));
}

/// The method of Levenberg and Marquardt. Counts are what is seen, and angles what is spread: the
/// density of counts has a factor of the gain for each take, so that scatter does not flatten
/// lines.
void StrangerFloor::solve() {
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(at_.size());
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (has_joint(slot, sensors_))
      pull[floor_unknown(slot, FloorTerm::log_gain)] =
          StrangerSpread::log_gain * static_cast<double>(takes_.size());
  const auto cost_of = [&](const Eigen::VectorXd& rows, const Eigen::VectorXd& at) {
    return 0.5 * rows.squaredNorm() - pull.dot(at);
  };
  constexpr int max_turns = 30;
  double damping = 1e-2;
  for (int turn = 0; turn < max_turns; ++turn) {
    const Eigen::VectorXd rows = residuals(at_);
    Eigen::MatrixXd slopes(rows.size(), at_.size());
    for (Index k = 0; k < at_.size(); ++k) {
      constexpr double step = 1e-5;
      Eigen::VectorXd moved = at_;
      moved[k] += step;
      slopes.col(k) = (residuals(moved) - rows) / step;
    }
    const Eigen::MatrixXd information = slopes.transpose() * slopes;
    const Eigen::VectorXd downhill = pull - slopes.transpose() * rows;
    const double cost = cost_of(rows, at_);
    double gained = 0.0;
    for (; gained <= 0.0 && damping < 1e8; damping *= 10.0) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd next = at_ + damped.llt().solve(downhill);
      gained = cost - cost_of(residuals(next), next);
      if (gained <= 0.0) continue;
      at_ = next;
      damping *= 0.01;
    }
    if (gained < 1e-3) return;
  }
}

SensorAngles StrangerFloor::angles_rad(const CountRow& row) {
  SensorAngles counts{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    counts[slot] = row[slot];
    constexpr double min_turn_counts = 2.0; // beyond what noise does
    if (!begun_) turned_[slot] = counts[slot];
    const double change = counts[slot] - turned_[slot];
    if (std::abs(change) > min_turn_counts) came_[slot] = std::copysign(1.0, change);
    if (change * came_[slot] > 0.0 || std::abs(change) > min_turn_counts)
      turned_[slot] = counts[slot];
  }
  begun_ = true;
  return angles_of(at_, counts, came_);
}

double StrangerFloor::pads_apart_m(const SensorAngles& angles_rad, int finger) const {
  return (hand_.pad(0, angles_rad) - hand_.pad(static_cast<std::size_t>(finger), angles_rad))
      .norm();
}

} // namespace nendo::bench
