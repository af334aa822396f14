#include "python/frames.hpp"

namespace nendo::python {

FrameCopy copy_of(const flow::Frame& frame) {
  FrameCopy copy;
  copy.number = frame.tick;
  copy.time_s = seconds_of(frame.woke);
  copy.held = frame.held;
  copy.units_per_metre = frame.units_per_metre;
  for (std::size_t side = 0; side < frame.hands.size(); ++side) {
    const flow::HandFrame& hand = frame.hands[side];
    copy.present[side] = hand.present;
    copy.silent[side] = hand.silent;
    if (!hand.present) continue;
    double* out = copy.hands.data() + side * numbers_per_hand;
    for (const Eigen::Isometry3d& joint : hand.pose.joints) {
      Eigen::Map<Eigen::Vector3d>(out, 3) = joint.translation();
      Eigen::Map<Eigen::Vector4d>(out + 3, 4) = Eigen::Quaterniond(joint.linear()).coeffs();
      out += numbers_per_joint;
    }
    write_angles(hand.angles, copy.angles.data() + side * hand::angle_count);
  }
  return copy;
}

void add_frames(py::module_& module) {
  using Frame = FrameCopy;
  const auto pair = [](const std::array<bool, 2>& both) { return array_of(both.data(), {2}); };
  py::class_<Frame>(module, "Frame",
                    "A frame of a loop: of a Session, a Replay or a Segment. Index 0 is the left "
                    "hand. Arrays are copies.")
      .def_readonly("number", &Frame::number,
                    "The number of the tick on the loop's grid; of a segment, the record's number.")
      .def_readonly("time_s", &Frame::time_s, "When the tick began, by time.monotonic().")
      .def_readonly("held", &Frame::held, "Whether the hands hold the model.")
      .def_readonly("units_per_metre", &Frame::units_per_metre,
                    "Model units per metre of the stage, on which the hands are.")
      .def_property_readonly(
          "present", [pair](const Frame& own) { return pair(own.present); },
          "(2,) bool: whether a glove drives the hand.")
      .def_property_readonly(
          "silent", [pair](const Frame& own) { return pair(own.silent); },
          "(2,) bool: whether the glove sends nothing, and the pose is frozen.")
      .def_property_readonly(
          "hands", [](const Frame& own) { return array_of(own.hands.data(), hands_shape); },
          "(2, 26, 7): of each joint in the order of JOINT_NAMES, the position in metres on the "
          "stage, and the orientation as a quaternion x, y, z, w. NaN without the hand.")
      .def_property_readonly(
          "angles", [](const Frame& own) { return array_of(own.angles.data(), angles_shape); },
          "(2, 23) in radians, in the order of ANGLE_NAMES. NaN without the hand.");
}

} // namespace nendo::python
