#pragma once
// A hand's motion as text in the Biovision hierarchy format (BVH), which animation programs read.
// Only text is made here; BvhFile (bvh_file.hpp) writes it to a disk.
//
// - Lengths are in centimetres, as most readers take them, and angles in degrees. The axes are
//   OpenXR's.
// - The ROOT is the wrist. Every other joint is a JOINT, in OpenXR's order, and every tip an End
//   Site. The palm is left out, because it is fixed to the wrist and nothing turns at it.
// - Names are OpenXR's followed by the hand, as the OpenXR specification advises: wrist_R,
//   index_proximal_L.
// - With all rotations zero the hand is the flat hand of JointAngles{}, whose bones are the
//   OFFSETs: the hierarchy holds the rest shape. A joint's OpenXR orientation is therefore its BVH
//   orientation times its orientation in the flat hand.
// - Channels are "Yrotation Zrotation Xrotation", that is R = Ry Rz Rx. A finger spreads about Y
//   and bends about X, so its channels are its joint's angles. This order is singular where Z is 90
//   degrees, to which no finger can turn. With X in the middle it would be singular at a
//   right-angled bend.

#include <array>
#include <cstdint>
#include <string>

#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

class NENDO_API BvhFormat {
public:
  static constexpr double units_per_metre = 100.0;
  /// The width of a frame count. Blanks behind it fill the width, so that it can be written over.
  static constexpr std::size_t count_width = 12;

  explicit BvhFormat(const HandSkeleton& skeleton);

  /// Returns the text from HIERARCHY to the line before MOTION.
  std::string hierarchy() const;
  /// Returns the lines MOTION, Frames and Frame Time. `rate_hz` must be above 0.
  static std::string motion_head(std::uint64_t frames, double rate_hz);
  /// The position of the frame count in the text that motion_head() returns, in bytes.
  static constexpr std::size_t count_place = sizeof "MOTION\nFrames: " - 1;
  /// Returns the frame count, padded to its whole width.
  static std::string count_text(std::uint64_t frames);

  /// Appends a line to `text`: where the wrist is and how all joints are turned, to six decimals.
  /// `pose` must be one of the skeleton's. Returns false and appends nothing if any of the numbers
  /// would not be finite.
  [[nodiscard]] bool append_frame(const HandPose& pose, std::string& text) const;

private:
  void append_joint(Joint joint, int depth, std::string& text) const;

  Side side_;
  HandPose rest_; ///< flat, at the origin
};

} // namespace nendo::hand
