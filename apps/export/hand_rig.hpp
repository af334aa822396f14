#pragma once
// Puts a hand into a glTF document: a tree of 26 nodes, one for each joint of OpenXR, that turn
// over time, under a node of the hand's own ("left hand"), and a skin that follows them ("left hand
// skin").

#include <array>
#include <vector>

#include <nendo/hand/skeleton.hpp>

#include "export/glb_file.hpp"

namespace nendo::exporting {

/// The poses of a hand, kept as the position and rotation of each joint in the frame of its parent.
class HandTrack {
public:
  explicit HandTrack(Side side) : side_(side) {}

  /// Adds the pose of the next moment, in metres. Returns false, and adds nothing, if it is not
  /// finite.
  bool add(const hand::HandPose& pose);

  Side side() const noexcept { return side_; }
  struct JointTrack {
    std::vector<float> places;    ///< x y z for each moment, metres
    std::vector<float> rotations; ///< quaternions x y z w for each moment, each with the sign
                                  ///< nearest to the previous one
  };
  const JointTrack& operator[](hand::Joint joint) const noexcept {
    return joints_[hand::index_of(joint)];
  }
  /// Returns a pose in the wrist's frame, with the rotations of `turns` and with the bone lengths
  /// of the first pose.
  hand::HandPose first_as(const hand::HandPose& turns) const;

private:
  Side side_;
  std::array<JointTrack, hand::joint_count> joints_;
};

/// Adds nodes, skin and mesh to the document, the root nodes to `roots`, and the motion to the
/// animation's samplers and channels. `times` is the accessor of the track's moments, of which
/// there must be at least one.
void add_hand(const HandTrack& track, GlbFile::Index times, GlbFile& file, GlbFile::Json& animation,
              GlbFile::Json& roots);

} // namespace nendo::exporting
