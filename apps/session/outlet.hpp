#pragma once
// Where the frames of a run go while it runs: to other programs, other machines.

#include <optional>
#include <vector>

#include <nendo/flow/frame_sink.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/wrist_move.hpp>

#include "session/follower.hpp"
#include "session/place_loop.hpp"

namespace nendo::session {

/// Is shown every frame, in the tick.
class Outlet : public flow::FrameSink, public Follower {
public:
  /// Before each loop's first tick, while no loop runs: what it is made of, and the model as it
  /// begins. All live until the loop has ended.
  virtual Result<void> begin(const PlacedLoop& placed, const deform::Mesh& model,
                             const std::vector<gloves::OpenHand>& hands) = 0;
  /// What it asks of the loop next, if anything. This and what follows as Follower's.
  virtual std::optional<flow::Request> next_request() { return std::nullopt; }
  /// Where it moves a hand next, if it does.
  virtual std::optional<flow::WristMove> next_wrist() { return std::nullopt; }
};

} // namespace nendo::session
