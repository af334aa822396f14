#pragma once
// A sink takes every frame of a run, for other programs, other machines or a browser.

#include <nendo/flow/frame.hpp>

#include "session/place_loop.hpp"

namespace nendo::session {

/// Its show() is called in the tick, on the loop's thread.
class Sink : public flow::FrameSink {
public:
  /// Called before the first tick. Returns an error if it cannot take the loop's frames.
  virtual Result<void> begin(const LoopStart& start) = 0;
  /// Called on the main thread while the loop runs, before the loop continues with another version
  /// of the model (flow::Frame::model): one that is new, or that was there before. Returns an error
  /// if the sink cannot take it; the model then stays as it is. It may be called for another
  /// version, or again, before a frame of that one has come.
  virtual Result<void> prepare(const flow::ModelVersion& version) = 0;
  /// Called on the main thread when the first frame of that version has come. Returns an error to
  /// be told to people.
  virtual Result<void> settle() { return {}; }
};

} // namespace nendo::session
