#pragma once
// What a picture shows at one moment. It is made from a mesh, from a frame of the running loop, or
// from a recording. The renderers need not know from which.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/flow/frame.hpp>

namespace nendo::render {

using TipPlaces = Eigen::Matrix<double, 3, 5>; ///< thumb to little finger

struct SceneHand {
  hand::HandPose pose; ///< on the stage, metres
  /// Where the control vectors begin, on the stage, metres; no vectors if equal to the tips.
  TipPlaces starts;
  bool silent = false; ///< its glove has stopped sending
};

/// A place at which a hand touches clay.
struct SceneContact {
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero(); ///< on the stage
  float strength = 0.0F;                             ///< 0 to 1: how hard
};

struct SceneFrame {
  double time_s = 0.0;
  deform::Points vertices;                       ///< 3 by #vertices, model units
  std::shared_ptr<const deform::Mesh> mesh;      ///< whose faces it has; null: the model's at first
  std::array<std::optional<SceneHand>, 2> hands; ///< index: flow::Placement::index_of(side)
  bool held = false;        ///< fingertips hold the model; otherwise there are no control vectors
  bool accumulates = false; ///< type 2: held, they reach from where they are, not from the starts
  /// The radius of each fingertip's support, on the stage; 0 means not shown.
  std::array<double, 5> radius_m{};
  std::vector<SceneContact> contacts{};
  std::vector<deform::WirePlace> wire{}; ///< that hands draw now; on the stage, metres
};

/// Remembers where the fingertips grabbed. The places are exact if the tracker sees every frame.
/// Otherwise they are off by the distance that the fingers moved between two frames that it saw.
class HoldTracker {
public:
  void follow(const flow::Frame& frame) noexcept;
  /// Returns the places on the stage in metres. slot: flow::Placement::index_of(side).
  const TipPlaces& starts(std::size_t slot) const noexcept { return starts_[slot]; }

private:
  std::array<TipPlaces, 2> starts_{TipPlaces::Zero(), TipPlaces::Zero()};
  flow::HoldWatch watch_;
};

/// Sets everything of `scene_frame` from a frame except its vertices and its time.
void set_hands(const flow::Frame& frame, const HoldTracker& holds, SceneFrame& scene_frame);

} // namespace nendo::render
