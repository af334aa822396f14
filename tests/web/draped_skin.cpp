// Prints the skin of hands as the window draws it, for tools/check-browser. A line of its input is
// a hand: left or right, and x, y, z of each joint with its rotation as a quaternion x, y, z, w.

#include <iostream>
#include <string>

#include "render/hand_skin.hpp"

int main() {
  using namespace nendo;
  const render::HandSkin left(Side::left), right(Side::right);
  for (std::string side; std::cin >> side;) {
    hand::HandPose pose;
    for (Eigen::Isometry3d& joint : pose.joints) {
      Eigen::Vector3d place;
      Eigen::Quaterniond turn;
      for (double& number : place)
        std::cin >> number;
      for (double& number : turn.coeffs())
        std::cin >> number;
      joint = Eigen::Translation3d(place) * turn.normalized();
    }
    render::Surface surface;
    (side == "left" ? left : right).drape(pose, Eigen::Vector3d::Zero(), surface);
    for (const Eigen::Vector3f& place : surface.places)
      std::cout << place.transpose() << ' ';
    std::cout << '\n';
  }
}
