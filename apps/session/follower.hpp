#pragma once
// What every follower of a run may want of it, whether it looks on or sends the frames elsewhere.

#include <string>

#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/save_request.hpp>

namespace nendo::session {

/// Called over and over from the main thread, and never blocks.
class Follower {
public:
  virtual ~Follower() = default;
  /// What it wants that only a new loop can give, since the last call.
  virtual flow::LoopChange next_change() { return {}; }
  /// What it wants kept, since the last call.
  virtual flow::SaveRequest next_save_request() { return {}; }
  /// What became of that, for its people; whoever of them asked.
  virtual void tell(const std::string& words) { static_cast<void>(words); }
};

} // namespace nendo::session
