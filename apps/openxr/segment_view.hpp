#pragma once
// Reads hands from the memory of a published segment, whose writer is not trusted.

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>

#include "publish/checked_segment.hpp"

namespace nendo::openxr {

inline constexpr std::size_t joint_count = NENDO_PUBLISH_JOINTS;

struct JointPose {
  Eigen::Vector3d position; ///< metres
  Eigen::Quaterniond orientation;
};
using HandPose = std::array<JointPose, joint_count>; ///< in the order of OpenXR

/// A hand on the stage, as the newest record and an earlier one have it.
struct PublishedHand {
  HandPose newest;
  std::int64_t newest_ns = 0;               ///< CLOCK_MONOTONIC
  std::array<float, joint_count> radii_m{}; ///< above 0
  bool is_silent = false;                   ///< glove or tracker is silent; the pose is frozen
  bool has_earlier = false;
  HandPose earlier;
  std::int64_t earlier_ns = 0;
};

class SegmentView {
public:
  /// A view of nothing, which has no hands.
  constexpr SegmentView() = default;
  /// The arguments are those of CheckedSegment.
  SegmentView(const void* base, std::uint64_t bytes) noexcept : segment_(base, bytes) {}

  bool is_usable() const noexcept { return segment_.is_usable(); }
  /// Returns whether the writer has not ended the segment.
  bool is_live() const noexcept;
  /// Reads a hand, 0 left or 1 right. Returns false if no glove drives it, if the writer has ended
  /// or has been late for half a second and three ticks at `now_ns` of CLOCK_MONOTONIC, if the
  /// record is of another generation than the setup, or if a number is not one of a hand.
  /// Wait-free, without allocation and system call.
  bool read(std::size_t side, std::int64_t now_ns, PublishedHand& hand) const noexcept;

private:
  struct Copied {
    nendo_publish_record head; ///< without its hands
    nendo_publish_hand hand;
  };
  bool copy_hand(std::uint64_t number, std::size_t side, Copied& copied) const noexcept;
  bool copy_radii(std::uint64_t generation, std::size_t side, PublishedHand& hand,
                  double& rate_hz) const noexcept;
  bool is_tracker_lost(std::uint64_t number, std::size_t side) const noexcept;
  void read_earlier(const Copied& newest, std::size_t side, double rate_hz,
                    PublishedHand& hand) const noexcept;

  publish::CheckedSegment segment_;
};

} // namespace nendo::openxr
