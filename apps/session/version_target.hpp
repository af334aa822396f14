#pragma once
// What a sink writes to, of which each version of the model needs its own. The tick goes over to
// the next one with the first frame of that version.

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include <nendo/flow/frame.hpp>

namespace nendo::session {

template <class Target>
class VersionTarget {
public:
  /// For the first version, before the loop runs.
  void begin(std::shared_ptr<Target> first) noexcept {
    now_ = std::move(first);
    in_tick_ = now_.get();
  }
  /// Returns the target of the frame's version. For the tick; wait-free.
  Target& of(const flow::Frame& frame) noexcept {
    if (frame.model != model_) {
      model_ = frame.model;
      in_tick_ = next_in_tick_.load(std::memory_order_acquire);
    }
    return *in_tick_;
  }

  // For the main thread:

  /// Sets the target of the version with which the loop will continue, before the loop has it.
  void prepare(std::shared_ptr<Target> next) noexcept {
    next_ = std::move(next);
    next_in_tick_.store(next_.get(), std::memory_order_release);
  }
  /// Takes the next target as the present one when a frame of its version has come. Returns the
  /// one before, which the tick no longer uses; null if there was no other.
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
