#include "python/hands.hpp"

#include <utility>

#include <nendo/hand/joint_limits.hpp>

namespace nendo::python {
namespace {

constexpr py::ssize_t angles_per_hand = hand::angle_count;
constexpr double min_length_m = 0.05, max_length_m = 0.5; // of any hand, and its breadth

Skeleton skeleton_of(const std::string& side, double length_m, double breadth_m) {
  hand::HandSize size;
  size.length_m = number_in(length_m, "length_m", min_length_m, max_length_m);
  size.breadth_m = number_in(breadth_m, "breadth_m", min_length_m / 2.0, max_length_m);
  return {size, hand::HandSkeleton(*side_of(side), size)};
}

hand::JointAngles angles_at(const double* numbers) {
  hand::JointAngles angles;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    angles[hand::angle_at(at)] = numbers[at];
  return angles;
}

py::array pose(const Skeleton& skeleton, const py::object& angles, const py::object& wrist) {
  const bool is_one = py::isinstance<py::array>(angles) && angles.attr("ndim").cast<int>() == 1;
  const auto view = is_one ? view_of(angles, "angles", {angles_per_hand})
                           : view_of(angles, "angles", {any, angles_per_hand});
  const py::ssize_t count = is_one ? 1 : view.shape[0];
  Eigen::Isometry3d forearm = Eigen::Isometry3d::Identity();
  if (!wrist.is_none()) forearm = motion_of(view_of(wrist, "wrist", {4, 4}).data, "wrist");
  py::array_t<double> poses(is_one ? Shape{hand::joint_count, 4, 4}
                                   : Shape{count, hand::joint_count, 4, 4});
  double* out = poses.mutable_data();
  const double* from = view.data;
  for (py::ssize_t at = 0; at < count; ++at) {
    write_joints(skeleton.bones.pose(angles_at(from), forearm), out);
    from += angles_per_hand;
    out += 16 * hand::joint_count;
  }
  return poses;
}

template <class Name>
py::tuple names(std::size_t count, Name name) {
  py::tuple all(count);
  for (std::size_t at = 0; at < count; ++at)
    all[at] = to_str(name(at));
  return all;
}

} // namespace

void add_hands(py::module_& module) {
  const auto joint = [](std::size_t at) { return static_cast<hand::Joint>(at); };
  module.attr("JOINT_NAMES") =
      names(hand::joint_count, [joint](std::size_t at) { return name_of(joint(at)); });
  module.attr("ANGLE_NAMES") =
      names(hand::angle_count, [](std::size_t at) { return hand::angle_names[at]; });
  py::tuple parents(hand::joint_count);
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const auto parent = hand::parent_of(joint(at));
    parents[at] = parent ? static_cast<int>(hand::index_of(*parent)) : -1;
  }
  module.attr("JOINT_PARENTS") = parents;
  py::array_t<double> limits({hand::angle_count, std::size_t{2}});
  for (std::size_t at = 0; at < hand::angle_count; ++at) {
    limits.mutable_data()[2 * at] = hand::joint_limits[at].min_rad;
    limits.mutable_data()[2 * at + 1] = hand::joint_limits[at].max_rad;
  }
  limits.attr("flags").attr("writeable") = false;
  module.attr("ANGLE_LIMITS_RAD") = limits;

  py::class_<Skeleton>(
      module, "HandSkeleton",
      "The bones of a hand, scaled from its length (wrist crease to the tip of the "
      "middle finger) and breadth (across the knuckles), in metres. Immutable; "
      "any thread may use it.")
      .def(py::init(&skeleton_of), py::arg("side"), py::arg("length_m") = hand::HandSize{}.length_m,
           py::arg("breadth_m") = hand::HandSize{}.breadth_m)
      .def_property_readonly(
          "side", [](const Skeleton& own) { return name_of(own.bones.side()); },
          "\"left\" or \"right\".")
      .def_property_readonly(
          "length_m", [](const Skeleton& own) { return own.size.length_m; },
          "Its length in metres.")
      .def_property_readonly(
          "breadth_m", [](const Skeleton& own) { return own.size.breadth_m; },
          "Its breadth in metres.")
      .def("pose", &pose, py::arg("angles"), py::arg("wrist") = py::none(),
           "Returns the pose of each joint, as homogeneous matrices in metres: angles (23,) in the "
           "order of ANGLE_NAMES, in radians, give (26, 4, 4), in the order of JOINT_NAMES; angles "
           "(n, 23) give (n, 26, 4, 4). `wrist` (4, 4) is the pose of the forearm's end; without "
           "it, the identity. At zero angles, -z points to the fingertips, y out of the back of "
           "the hand, and x to the right.");
}

} // namespace nendo::python
