#include "timeline/reduce.hpp"

#include <algorithm>
#include <cmath>

#include "timeline/hand_curve.hpp"

namespace nendo::timeline {
namespace {

using Tips = Eigen::Matrix<double, 3, 6>;

// The wrist is the sixth: what carries the fingers counts as they do.
Tips tips_of(const hand::HandPose& pose, const Key& key) {
  Tips tips;
  tips.leftCols<5>() = pose.fingertip_positions();
  tips.col(5) = key.wrist_m;
  return tips;
}

double angle_between(const Key& one, const Key& other) {
  double most = one.wrist_turn.angularDistance(other.wrist_turn);
  if (one.wrist_turn.coeffs() == other.wrist_turn.coeffs()) most = 0.0; // but for its rounding
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    most =
        std::max(most, std::abs(one.angles[hand::angle_at(at)] - other.angles[hand::angle_at(at)]));
  return most;
}

// Which frames are keys, and how far the others are from the curve through those.
class Reducer {
public:
  Reducer(const hand::HandSkeleton& skeleton, std::span<const Key> frames,
          const Tolerance& tolerance, const PointSway* sway)
      : skeleton_(skeleton), frames_(frames), tolerance_(tolerance), sway_(sway),
        must_stay_(frames.size(), false) {
    for (const Key& frame : frames)
      seen_.push_back(see(frame));
    must_stay_.front() = must_stay_.back() = true;
    if (sway != nullptr) keep_holds(sway->held_at_s());
    is_key_ = must_stay_;
  }

  // Until nothing is too far off.
  void add_keys() {
    for (bool added = true; added;) {
      added = false;
      const HandCurve curve(keys());
      std::size_t begin = 0;
      for (std::size_t end = 1; end < frames_.size(); ++end) {
        if (!is_key_[end]) continue;
        if (const std::size_t worst = worst_between(curve, begin, end); worst != begin)
          added = is_key_[worst] = true;
        begin = end;
      }
    }
  }

  // A key's going changes the slopes at its neighbours, and with them the pieces beyond these.
  void drop_keys() {
    std::vector<std::size_t> keys;
    for (std::size_t at = 0; at < frames_.size(); ++at)
      if (is_key_[at]) keys.push_back(at);
    for (std::size_t at = 1; at + 1 < keys.size();) {
      if (must_stay_[keys[at]] || !can_drop(keys, at)) {
        ++at;
        continue;
      }
      is_key_[keys[at]] = false;
      keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }

  Reduction result() const {
    Reduction reduction{keys(), frames_.size(), {}};
    const HandCurve curve(reduction.keys);
    for (std::size_t at = 0; at < frames_.size(); ++at) {
      const Deviation off = deviation(curve, at);
      reduction.worst.angle_rad = std::max(reduction.worst.angle_rad, off.angle_rad);
      reduction.worst.tip_m = std::max(reduction.worst.tip_m, off.tip_m);
      reduction.worst.point_m = std::max(reduction.worst.point_m, off.point_m);
    }
    return reduction;
  }

private:
  // What counts of a pose, besides its angles.
  struct Seen {
    Tips tips;
    Eigen::VectorXd signals; ///< to a puppet
  };

  Seen see(const Key& key) const {
    const Eigen::Isometry3d T_stage_wrist = key.wrist_pose();
    const hand::HandPose pose = skeleton_.pose(key.angles, T_stage_wrist);
    Seen seen{tips_of(pose, key), {}};
    if (sway_ != nullptr) seen.signals = sway_->signals({key.angles, pose, T_stage_wrist});
    return seen;
  }

  // The last frame that is not later than each of these times, the one before it, and the one
  // behind it.
  void keep_holds(const std::vector<double>& times_s) {
    for (const double time_s : times_s) {
      const auto after = std::ranges::upper_bound(frames_, time_s, {}, &Key::time_s);
      const auto behind = static_cast<std::size_t>(after - frames_.begin());
      const std::size_t first = behind - std::min<std::size_t>(behind, 2);
      for (std::size_t at = first; at <= std::min(behind, frames_.size() - 1); ++at)
        must_stay_[at] = true;
    }
  }

  static constexpr std::size_t reach = 3; // keys on either side that a slope's change can be felt

  std::vector<Key> keys() const {
    std::vector<Key> keys;
    for (std::size_t at = 0; at < frames_.size(); ++at)
      if (is_key_[at]) keys.push_back(frames_[at]);
    return keys;
  }

  Deviation deviation(const HandCurve& curve, std::size_t frame) const {
    if (is_key_[frame]) return {};
    const Key made = curve.at(frames_[frame].time_s);
    const Seen seen = see(made);
    const Seen& wanted = seen_[frame];
    return {angle_between(made, frames_[frame]),
            (seen.tips - wanted.tips).colwise().norm().maxCoeff(),
            sway_ == nullptr ? 0.0 : sway_->off_m(seen.signals, wanted.signals)};
  }

  bool is_fine(const Deviation& off) const {
    return off.angle_rad <= tolerance_.angle_rad && off.tip_m <= tolerance_.tip_m &&
           off.point_m <= tolerance_.point_m;
  }

  // `begin`, if none is too far off.
  std::size_t worst_between(const HandCurve& curve, std::size_t begin, std::size_t end) const {
    constexpr double least = 1e-300; // a tolerance of 0 is none to divide by
    std::size_t worst = begin;
    double most = 0.0;
    for (std::size_t at = begin + 1; at < end; ++at) {
      const Deviation off = deviation(curve, at);
      const double badness = std::max({off.angle_rad / std::max(tolerance_.angle_rad, least),
                                       off.tip_m / std::max(tolerance_.tip_m, least),
                                       off.point_m / std::max(tolerance_.point_m, least)});
      if (is_fine(off) || (worst != begin && !(badness > most))) continue;
      worst = at;
      most = badness;
    }
    return worst;
  }

  bool can_drop(const std::vector<std::size_t>& keys, std::size_t at) {
    const std::size_t first = at - std::min(at, reach);
    const std::size_t last = std::min(at + reach, keys.size() - 1);
    std::vector<Key> others;
    for (std::size_t key = first; key <= last; ++key)
      if (key != at) others.push_back(frames_[keys[key]]);
    const HandCurve curve(std::move(others));
    // Beyond, slopes at this curve's ends are not those of the whole.
    const std::size_t from = first == 0 ? 0 : keys[first + 1];
    const std::size_t to = last + 1 == keys.size() ? keys[last] : keys[last - 1];
    is_key_[keys[at]] = false;
    bool fine = true;
    for (std::size_t frame = from; frame <= to && fine; ++frame)
      fine = is_fine(deviation(curve, frame));
    is_key_[keys[at]] = true;
    return fine;
  }

  const hand::HandSkeleton& skeleton_;
  std::span<const Key> frames_;
  Tolerance tolerance_;
  const PointSway* sway_;
  std::vector<bool> must_stay_; ///< as a key
  std::vector<bool> is_key_;
  std::vector<Seen> seen_; ///< one per frame
};

} // namespace

Reduction reduce_keys(const hand::HandSkeleton& skeleton, std::span<const Key> frames,
                      const Tolerance& tolerance, const PointSway* sway) {
  if (frames.empty()) return {};
  Reducer reducer(skeleton, frames, tolerance, sway);
  reducer.add_keys();
  reducer.drop_keys();
  return reducer.result();
}

PointSway::PointSway(const Timeline& timeline, Side side) {
  if (!timeline.rig) return;
  bool is_symmetric = timeline.rig_state.symmetric;
  for (const Event& event : timeline.events) {
    const auto* symmetry = std::get_if<flow::SetSymmetry>(&event.command);
    is_symmetric = is_symmetric || (symmetry != nullptr && symmetry->on);
    if (!std::holds_alternative<flow::Mark>(event.command)) held_at_s_.push_back(event.time_s);
  }
  reach_m_.resize(timeline.point_count(), 0);
  const auto& functions = timeline.rig_state.functions;
  for (std::size_t at = 0; at < functions.size(); ++at)
    if (functions[at].input.side() == side) add(timeline, at, functions[at].input, is_symmetric);
  for (const Event& event : timeline.events)
    if (const auto* role = std::get_if<flow::SetRole>(&event.command);
        role != nullptr && role->input.side() == side)
      add(timeline, role->function, role->input, is_symmetric);
}

void PointSway::add(const Timeline& timeline, std::size_t function, const puppet::HandSignal& input,
                    bool moves_twin) {
  const puppet::Puppet& puppet = timeline.rig->puppet();
  Eigen::VectorXd reach = timeline.rig->vectors_of(function).colwise().norm();
  const auto twin = puppet.function_named(puppet::twin_of(puppet.functions[function].name));
  if (moves_twin && twin && *twin != function)
    reach += timeline.rig->vectors_of(*twin).colwise().norm().transpose();
  reach /= std::abs(puppet.functions[function].travel) * timeline.units_per_metre;
  inputs_.push_back(input);
  reach_m_.conservativeResize(Eigen::NoChange, reach_m_.cols() + 1);
  reach_m_.rightCols<1>() = reach;
}

Eigen::VectorXd PointSway::signals(const puppet::HandState& hand) const {
  Eigen::VectorXd signals(static_cast<Eigen::Index>(inputs_.size()));
  for (std::size_t at = 0; at < inputs_.size(); ++at)
    signals[static_cast<Eigen::Index>(at)] = inputs_[at].of(hand);
  return signals;
}

double PointSway::off_m(const Eigen::VectorXd& one, const Eigen::VectorXd& other) const {
  if (inputs_.empty()) return 0.0;
  return (reach_m_ * (one - other).cwiseAbs()).maxCoeff();
}

} // namespace nendo::timeline
