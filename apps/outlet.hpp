#pragma once
// Where the frames of a run go while it runs: to other programs, other machines.

#include <optional>
#include <string>
#include <vector>

#include <nendo/flow/frame_sink.hpp>
#include <nendo/flow/keepsakes.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/wrist_move.hpp>

#include "place_loop.hpp"

namespace nendo::app {

/// Is shown every frame, in the tick.
class Outlet : public flow::FrameSink {
public:
  /// Before each loop's first tick, while no loop runs: what it is made of, and the model as it
  /// begins. All live until the loop has ended.
  virtual Result<void> begin(const PlacedLoop& placed, const deform::Mesh& model,
                             const std::vector<OpenHand>& hands) = 0;
  /// What it asks of the loop next, if anything. This and what follows is called over and over from
  /// the main thread, and never blocks.
  virtual std::optional<flow::Request> next_request() { return std::nullopt; }
  /// Where it moves a hand next, if it does.
  virtual std::optional<flow::WristMove> next_wrist() { return std::nullopt; }
  /// What it wants that only a new loop can give, since the last call.
  virtual flow::LoopChange next_change() { return {}; }
  /// What it wants kept, since the last call.
  virtual flow::Keepsakes next_keepsakes() { return {}; }
  /// What became of that, for its people; whoever of them asked.
  virtual void tell(const std::string& words) { static_cast<void>(words); }
};

} // namespace nendo::app
