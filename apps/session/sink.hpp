#pragma once
// A sink receives every frame of a run, for other programs, other machines or a browser.

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include <nendo/flow/frame.hpp>

#include "session/place_loop.hpp"

namespace nendo::session {

/// show() is called in the tick, on the loop's thread.
class Sink : public flow::FrameSink {
public:
  /// Called before the first tick. Returns an error if it cannot take the loop's frames.
  virtual Result<void> begin(const LoopStart& start) = 0;
  /// Called on the main thread while the loop runs, before the loop continues with another version
  /// of the model (flow::Frame::model), new or earlier. After an error, the model does not change.
  /// May be called again, also for another version, before a frame of this version.
  virtual Result<void> prepare(const flow::ModelVersion& version) = 0;
  /// Called on the main thread after the first frame of a prepared version. The error is reported.
  virtual Result<void> settle() { return {}; }
};

/// The target of a sink. Each version of the model has its own; the tick switches at the first
/// frame of the next version.
template <class Target>
class VersionTarget {
public:
  /// Sets the target of the first version, before the loop runs.
  void begin(std::shared_ptr<Target> first) noexcept {
    now_ = std::move(first);
    in_tick_ = now_.get();
  }
  /// Returns the target of the frame's version. Loop's thread; wait-free.
  Target& of(const flow::Frame& frame) noexcept {
    if (frame.model != model_) {
      model_ = frame.model;
      in_tick_ = next_in_tick_.load(std::memory_order_acquire);
    }
    return *in_tick_;
  }

  // Main thread:

  /// Sets the next version's target, before the loop has that version.
  void prepare(std::shared_ptr<Target> next) noexcept {
    next_ = std::move(next);
    next_in_tick_.store(next_.get(), std::memory_order_release);
  }
  /// Makes the next target the current one, after a frame of its version. Returns the previous one,
  /// which the tick no longer uses; null if there is no next target.
  std::shared_ptr<Target> settle() noexcept {
    if (!next_) return nullptr;
    return std::exchange(now_, std::exchange(next_, nullptr));
  }
  const std::shared_ptr<Target>& now() const noexcept { return now_; }

private:
  std::shared_ptr<Target> now_;
  std::shared_ptr<Target> next_;
  std::atomic<Target*> next_in_tick_{nullptr};
  Target* in_tick_ = nullptr;
  std::uint32_t model_ = 0;
};

} // namespace nendo::session
