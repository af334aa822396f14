#pragma once
// The last minute, in memory that is taken beforehand: chunks of an input log, the oldest of which
// make room for new ones. It can be written at any moment, also by a signal handler in a process
// that is about to die.

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/base/units.hpp>

namespace nendo::recording {

class KeptRing {
public:
  /// `setup`: what a recording begins with, as setup_bytes() makes it, and how many chunks that
  /// are. Keeps what is younger than `span`, as far as `bytes` of memory hold it.
  KeptRing(std::vector<std::byte> setup, std::uint32_t setup_chunks, HostClock::duration span,
           std::size_t bytes);

  /// One thread: the payload of an input log chunk with so many entries, which ended at `time`.
  /// Payloads that are larger than an eighth of the memory are dropped.
  void push(std::span<const std::byte> payload, std::uint64_t entries, HostTime time) noexcept;

  /// A whole recording. What was dropped stands as a gap in front. False, with errno, if the system
  /// refuses. That of the pushing thread, or with freeze(): only calls that are safe in a signal
  /// handler, no allocation.
  bool write(int fd) const noexcept;
  /// From any thread or signal handler: nothing is pushed from now on, and this returns when the
  /// push that is under way has ended, but does not wait for longer than 0.1 s: its thread may be
  /// the one that died.
  void freeze() noexcept;

private:
  struct Slot {
    std::size_t offset = 0;
    std::size_t bytes = 0;
    std::uint32_t crc = 0;
    std::uint64_t entries = 0;
    HostTime time{};
  };
  const Slot& slot(std::uint64_t number) const noexcept { return slots_[number % slots_.size()]; }
  std::size_t place_for(std::size_t bytes) noexcept;
  void drop_oldest() noexcept;

  std::vector<std::byte> setup_;
  std::uint32_t setup_chunks_;
  HostClock::duration span_;
  std::vector<std::byte> memory_;
  std::vector<Slot> slots_;
  std::size_t next_offset_ = 0;
  std::atomic<std::uint64_t> oldest_{0}; ///< these two count slots
  std::atomic<std::uint64_t> end_{0};
  std::atomic<std::uint64_t> dropped_{0}; ///< entries
  std::atomic<bool> pushing_{false};
  std::atomic<bool> frozen_{false};
};

} // namespace nendo::recording
