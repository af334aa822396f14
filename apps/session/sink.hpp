#pragma once
// A sink takes every frame of a run, for other programs, other machines or a browser.

#include <nendo/flow/frame_sink.hpp>

#include "session/place_loop.hpp"

namespace nendo::session {

/// Its show() is called in the tick, on the loop's thread.
class Sink : public flow::FrameSink {
public:
  /// Called before the first tick. Returns an error if it cannot take the loop's frames.
  virtual Result<void> begin(const LoopStart& start) = 0;
};

} // namespace nendo::session
