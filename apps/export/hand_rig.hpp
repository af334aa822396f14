#pragma once
// A hand as glTF has them: a tree of 26 nodes, OpenXR's joints, that are turned over time, and a
// skin that follows them.

#include <array>
#include <vector>

#include <nendo/hand/skeleton.hpp>

#include "export/glb_file.hpp"

namespace nendo::exporting {

/// A hand's poses, kept as each joint's place and turn in its parent's frame.
class HandTrack {
public:
  explicit HandTrack(Side side) : side_(side) {}

  /// The pose of the next moment, metres. False: it is not finite, and left out.
  bool add(const hand::HandPose& pose);

  Side side() const noexcept { return side_; }
  struct JointTrack {
    std::vector<float> places;    ///< x y z a moment, metres
    std::vector<float> rotations; ///< quaternions x y z w a moment; none turns back on its way
  };
  const JointTrack& operator[](hand::Joint joint) const noexcept {
    return joints_[hand::index_of(joint)];
  }
  /// In the wrist's frame, each joint turned as in `turns` and as far from its parent as in the
  /// first pose.
  hand::HandPose first_as(const hand::HandPose& turns) const;

private:
  Side side_;
  std::array<JointTrack, hand::joint_count> joints_;
};

/// Adds nodes, skin and mesh to the document, the roots to `roots`, and what moves to the
/// animation's samplers and channels. times: the accessor of the track's moments, at least one.
void add_hand(const HandTrack& track, GlbFile::Index times, GlbFile& file, GlbFile::Json& animation,
              GlbFile::Json& roots);

} // namespace nendo::exporting
