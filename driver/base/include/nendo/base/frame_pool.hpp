#pragma once
// FramePool: hands every frame from one writer thread to one reader thread without copying it, as a
// recorder needs it. The frames are made once; their indices go to the reader through one ring and
// come back through another. When all frames are under way, the writer's newest is dropped and
// counted; it never waits. Proof, bounds and figures: RINGS.md.

#include <cassert>
#include <cstdint>
#include <vector>

#include <nendo/base/spsc_ring.hpp>

namespace nendo {

template <class Frame, class Atomics = StdAtomics>
class FramePool {
  using Buffer = typename Atomics::template Plain<Frame>;
  using Index = std::uint32_t;

public:
  /// Allocates once: at least one frame, each a copy of `initial`, so that sizes are set before the
  /// first is filled.
  FramePool(std::size_t frames, const Frame& initial)
      : frames_(frames, Buffer(initial)), full_(frames), empty_(frames) {
    assert(frames > 0 && frames < none);
    for (Index frame = 0; frame < frames; ++frame)
      empty_.try_push(frame);
  }

  /// Writer only, wait-free: a frame to fill, which holds some older one; the same until publish().
  /// Null: all frames are under way, this one was dropped and counted.
  [[nodiscard]] Buffer* claim() noexcept {
    if (claimed_ == none && !empty_.try_pop(claimed_)) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return nullptr;
    }
    return &frames_[claimed_];
  }
  /// Writer only, wait-free: gives the claimed frame to the reader.
  void publish() noexcept {
    assert(claimed_ != none);
    full_.try_push(claimed_); // it has room for all frames
    claimed_ = none;
  }

  /// Reader only, wait-free: the oldest frame that it did not take yet, its own until give_back().
  /// Null: there is none. Several may be held, and given back in any order.
  [[nodiscard]] const Buffer* take() noexcept {
    Index frame = none;
    return full_.try_pop(frame) ? &frames_[frame] : nullptr;
  }
  /// Reader only, wait-free; once for each frame taken.
  void give_back(const Buffer* frame) noexcept {
    assert(frame >= frames_.data() && frame < frames_.data() + frames_.size());
    empty_.try_push(static_cast<Index>(frame - frames_.data()));
  }

  [[nodiscard]] std::size_t frames() const noexcept { return frames_.size(); }
  /// Any thread, wait-free; exact only while both sides are at rest.
  [[nodiscard]] FramePoolCounters counters() const noexcept {
    const RingCounters full = full_.counters();
    const std::uint64_t dropped = dropped_.load(std::memory_order_relaxed);
    return {full.offered + dropped, dropped, full.consumed, full.high_water};
  }

private:
  static constexpr Index none = UINT32_MAX;

  std::vector<Buffer> frames_;
  SpscRing<Index, Atomics> full_;  // the writer produces, the reader consumes
  SpscRing<Index, Atomics> empty_; // the other way round
  // Written by the writer.
  alignas(2 * cache_line_bytes) Index claimed_ = none;
  typename Atomics::template Atomic<std::uint64_t> dropped_{0};
};

} // namespace nendo
