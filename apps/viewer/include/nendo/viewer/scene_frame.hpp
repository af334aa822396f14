#pragma once
// What a picture shows at one moment. It can be made of a mesh alone, of a frame of the running
// loop or of a recording; the renderers need not know which.

#include <array>
#include <optional>
#include <vector>

#include <nendo/flow/hold_watch.hpp>

namespace nendo::viewer {

using TipPlaces = Eigen::Matrix<double, 3, 5>; ///< thumb to little finger

struct SeenHand {
  hand::HandPose pose; ///< on the stage, metres
  TipPlaces starts;    ///< of its control vectors, on the stage, metres; equal to the tips: none
  bool silent = false; ///< its glove has stopped sending
};

struct SceneFrame {
  double time_s = 0.0;
  deform::Points vertices;                      ///< 3 by #vertices, model units
  std::array<std::optional<SeenHand>, 2> hands; ///< by flow::Placement::index_of(side)
  bool held = false; ///< the hands hold the model; otherwise there are no control vectors
  std::array<double, 5> radius_m{}; ///< of each fingertip's support, on the stage; 0: not shown
};

/// Remembers where the fingertips took hold. It is exact if it sees every frame; otherwise it is
/// off by what the fingers moved between two frames that it saw.
class HoldTracker {
public:
  void follow(const flow::Frame& frame) noexcept;
  /// On the stage, metres. slot: flow::Placement::index_of(side).
  const TipPlaces& starts(std::size_t slot) const noexcept { return starts_[slot]; }

private:
  std::array<TipPlaces, 2> starts_{TipPlaces::Zero(), TipPlaces::Zero()};
  flow::HoldWatch watch_;
};

/// All of a frame but its vertices and its time, which are left as they are.
void see_hands(const flow::Frame& frame, const HoldTracker& holds, SceneFrame& moment);

} // namespace nendo::viewer
