#pragma once
// A hand's motion as text in the Biovision hierarchy format (BVH), which animation programs read.
// Pure text; BvhFile (bvh_file.hpp) puts it on a disk.
//
// - Lengths are centimetres, as most readers take them, angles degrees; axes are OpenXR's.
// - The ROOT is the wrist, every other joint but the tips a JOINT, in OpenXR's order; tips are End
//   Sites. The palm is left out: it is fixed to the wrist and no joint of a BVH's kind.
// - Names are OpenXR's with the hand behind them, as its specification advises: wrist_R,
//   index_proximal_L.
// - Zero rotations are the flat hand of JointAngles{}, and OFFSETs are its bones, so that the rest
//   shape stands in the hierarchy. A joint's OpenXR orientation is therefore its BVH orientation
//   times its orientation in the flat hand.
// - Channels are "Yrotation Zrotation Xrotation", R = Ry Rz Rx. A finger spreads about Y and bends
//   about X, so its channels are its joint's angles, and the order's singular place, Z at 90
//   degrees, is one to which no finger can turn. With X in the middle it would be a right-angled
//   bend.

#include <array>
#include <cstdint>
#include <string>

#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

class BvhFormat {
public:
  static constexpr double units_per_metre = 100.0;
  /// Digits of a frame count, which is padded behind, so that it can be written over.
  static constexpr std::size_t count_width = 12;

  explicit BvhFormat(const HandSkeleton& skeleton);

  /// From HIERARCHY to the line before MOTION.
  std::string hierarchy() const;
  /// MOTION, Frames and Frame Time. `rate_hz` > 0.
  static std::string motion_head(std::uint64_t frames, double rate_hz);
  /// Where the frame count begins in what motion_head() gives.
  static constexpr std::size_t count_place = sizeof "MOTION\nFrames: " - 1;
  /// The frame count in its whole width.
  static std::string count_text(std::uint64_t frames);

  /// Appends a line: where the wrist is and how all joints are turned, to six decimals. The pose is
  /// one of the skeleton's. False, and nothing is appended, if any number of it would not be
  /// finite.
  [[nodiscard]] bool append_frame(const HandPose& pose, std::string& text) const;

private:
  void append_joint(Joint joint, int depth, std::string& text) const;

  Side side_;
  HandPose rest_; ///< flat, at the origin
};

} // namespace nendo::hand
