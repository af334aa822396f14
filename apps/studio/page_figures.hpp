#pragma once
// Hands and marks that a page draws without a run, as a message (apps/web/PROTOCOL.md, message 13).

#include <string>
#include <string_view>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <nendo/base/side.hpp>
#include <nendo/hand/skeleton.hpp>

#include "render/camera.hpp"
#include "render/scene_frame.hpp"
#include "studio/calibration_scene.hpp"

namespace nendo::studio {

class PageFigures {
public:
  using Look = ShownHand::Look;

  void add(Side side, const hand::HandPose& pose, Look look);
  void add(const render::SceneFrame& frame);
  /// A capsule between two places, metres; the colour is linear.
  void add_mark(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius_m,
                const Eigen::Vector3f& colour);
  /// Sets the page's camera, which shows a box of this width and height about that height.
  void look_by(const render::View& view, double width_m, double height_m, double middle_m);
  std::string message() const { return whole_.dump(); }

private:
  nlohmann::ordered_json whole_{{"hands", nlohmann::ordered_json::array()},
                                {"marks", nlohmann::ordered_json::array()}};
};

} // namespace nendo::studio
