#include "openxr/segment_view.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::openxr {
namespace {

constexpr std::int64_t patience_ns = 500'000'000;
constexpr double between_poses_s = 0.02; ///< long enough that noise does not look like motion
constexpr double max_pause_s = 0.25;     ///< over a longer one, no velocity is computed
constexpr double max_distance_m = 1000.0;
constexpr float max_radius_m = 0.2F;
constexpr float usual_radius_m = 0.01F; ///< writers before 1.2 publish no radii

/// Converts joints. Returns false if a number is not finite, or an orientation is no unit
/// quaternion, or a position is more than a kilometre away.
bool convert(const nendo_publish_hand& hand, HandPose& pose) noexcept {
  for (std::size_t k = 0; k < joint_count; ++k) {
    const float* const p = hand.joints[k].position;
    const float* const q = hand.joints[k].orientation;
    pose[k].position = Eigen::Vector3f(p).cast<double>();
    pose[k].orientation = Eigen::Quaternionf(q[3], q[0], q[1], q[2]).cast<double>();
    const double norm = pose[k].orientation.norm(); // written so that a NaN is refused
    if (!(norm > 0.99 && norm < 1.01)) return false;
    if (!(pose[k].position.cwiseAbs().maxCoeff() < max_distance_m)) return false;
    if (!pose[k].position.allFinite()) return false;
    pose[k].orientation.normalize();
  }
  return true;
}

} // namespace

bool SegmentView::is_live() const noexcept {
  return is_usable() && segment_.state() == NENDO_PUBLISH_LIVE;
}

bool SegmentView::copy_hand(std::uint64_t number, std::size_t side, Copied& copied) const noexcept {
  const std::uint64_t at = segment_.record_at(number);
  constexpr std::size_t hands = offsetof(nendo_publish_record, hands);
  return segment_.copy(at, number, at, &copied.head, hands) &&
         segment_.copy(at, number, at + hands + side * sizeof copied.hand, &copied.hand,
                       sizeof copied.hand) &&
         (copied.hand.flags & NENDO_PUBLISH_PRESENT) != 0;
}

bool SegmentView::copy_radii(std::uint64_t generation, std::size_t side, PublishedHand& hand,
                             double& rate_hz) const noexcept {
  nendo_publish_setup setup;
  if (!segment_.copy(segment_.header().setup_offset, generation, setup)) return false;
  hand.radii_m.fill(0.0F);
  constexpr std::uint64_t bytes = sizeof hand.radii_m;
  if (setup.radii_offset != 0 &&
      nendo_publish_fits(segment_.bytes(), setup.radii_offset, 1, 2 * bytes) &&
      !segment_.copy_of_setup(generation, setup.radii_offset + side * bytes, hand.radii_m.data(),
                              bytes))
    return false;
  for (float& radius_m : hand.radii_m)
    if (!(radius_m > 0.0F && radius_m < max_radius_m)) radius_m = usual_radius_m;
  rate_hz = setup.rate_hz >= 0.1 && setup.rate_hz <= 1e5 ? setup.rate_hz : 90.0;
  return true;
}

bool SegmentView::is_tracker_lost(std::uint64_t number, std::size_t side) const noexcept {
  nendo_publish_states states;
  return segment_.has_states() && segment_.copy(segment_.states_at(number), number, states) &&
         (states.hands[side].flags & NENDO_PUBLISH_LOST) != 0;
}

void SegmentView::read_earlier(const Copied& newest, std::size_t side, double rate_hz,
                               PublishedHand& hand) const noexcept {
  hand.has_earlier = false;
  // The oldest slot may be overwritten meanwhile.
  const double slots = std::max(1.0, static_cast<double>(segment_.header().record_slots) - 2.0);
  const auto back = static_cast<std::uint64_t>(std::clamp(rate_hz * between_poses_s, 1.0, slots));
  Copied earlier;
  if (newest.head.number <= back || !copy_hand(newest.head.number - back, side, earlier)) return;
  const double pause_s =
      (static_cast<double>(newest.head.woke_ns) - static_cast<double>(earlier.head.woke_ns)) / 1e9;
  hand.has_earlier = earlier.head.generation == newest.head.generation && pause_s > 0.0 &&
                     pause_s < max_pause_s && convert(earlier.hand, hand.earlier);
  hand.earlier_ns = earlier.head.woke_ns;
}

bool SegmentView::read(std::size_t side, std::int64_t now_ns, PublishedHand& hand) const noexcept {
  if (!is_live()) return false;
  Copied newest;
  std::uint64_t number = 0;
  bool is_there = false;
  for (int attempt = 0; attempt < 3 && !is_there; ++attempt) { // the writer may have overtaken it
    number = segment_.newest();
    is_there = copy_hand(number, side, newest);
  }
  double rate_hz = 0.0;
  if (!is_there || newest.head.number != number || !convert(newest.hand, hand.newest) ||
      !copy_radii(newest.head.generation, side, hand, rate_hz))
    return false;
  const double age_s =
      (static_cast<double>(now_ns) - static_cast<double>(newest.head.woke_ns)) / 1e9;
  if (!(std::abs(age_s) < static_cast<double>(patience_ns) / 1e9 + 3.0 / rate_hz)) return false;
  hand.newest_ns = newest.head.woke_ns;
  hand.is_silent = (newest.hand.flags & NENDO_PUBLISH_SILENT) != 0 || is_tracker_lost(number, side);
  read_earlier(newest, side, rate_hz, hand);
  return true;
}

} // namespace nendo::openxr
