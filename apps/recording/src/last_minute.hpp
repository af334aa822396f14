#pragma once
// The last minute of a recording, or whatever span was asked for, in memory that is allocated
// beforehand. It is a ring of chunks of an input log, in which new ones replace the oldest.
// It can be written to a file at any time, also by a signal handler in a process that is about to
// die.

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/recording/chunk_file.hpp>

namespace nendo::recording {

class LastMinute {
public:
  /// `setup` is the beginning of a recording, as setup_bytes() makes it, and `setup_chunks` is its
  /// number of chunks. The ring keeps what is younger than `span`, as far as `bytes` of memory hold
  /// it.
  LastMinute(std::vector<std::byte> setup, std::uint32_t setup_chunks, HostClock::duration span,
             std::size_t bytes);
  ~LastMinute();
  LastMinute(const LastMinute&) = delete;
  LastMinute& operator=(const LastMinute&) = delete;

  /// Adds a chunk after the setup, which stays whatever is dropped. To be called by the thread
  /// that pushes. Allocates.
  void add_chunk(ChunkType type, std::span<const std::byte> payload);

  /// Adds the payload of an input log chunk with `entries` entries, which ended at `time`. A
  /// payload larger than an eighth of the memory is dropped. Only one thread may call this.
  void push(std::span<const std::byte> payload, std::uint64_t entries, HostTime time) noexcept;

  /// Writes a whole recording. A gap at its beginning stands for what was dropped. Returns false,
  /// with errno, if the system refuses. To be called by the thread that pushes, or after freeze().
  /// It allocates nothing and uses only calls that are safe in a signal handler.
  bool write(int fd) const noexcept;
  /// Stops all later pushes, and waits for a push that has begun, but for at most 0.1 s, because
  /// its thread may be the one that died. May be called by any thread or signal handler.
  void freeze() noexcept;

private:
  struct Slot {
    std::size_t offset = 0;
    std::size_t bytes = 0;
    std::uint32_t crc = 0;
    std::uint64_t entries = 0;
    HostTime time{};
  };
  /// A whole chunk, in a list that a signal handler may go through while it grows.
  struct Lasting {
    std::vector<std::byte> bytes;
    std::atomic<Lasting*> next{nullptr};
  };
  const Slot& slot(std::uint64_t number) const noexcept { return slots_[number % slots_.size()]; }
  std::size_t place_for(std::size_t bytes) noexcept;
  void drop_oldest() noexcept;

  std::vector<std::byte> setup_;
  std::uint32_t setup_chunks_;
  std::atomic<Lasting*> lasting_{nullptr};
  std::uint32_t lasting_count_ = 0;
  HostClock::duration span_;
  std::vector<std::byte> memory_;
  std::vector<Slot> slots_;
  std::size_t next_offset_ = 0;
  std::atomic<std::uint64_t> oldest_{0}; ///< oldest_ and end_ count slots
  std::atomic<std::uint64_t> end_{0};
  std::atomic<std::uint64_t> dropped_{0}; ///< entries
  std::atomic<bool> pushing_{false};
  std::atomic<bool> frozen_{false};
};

/// While this object exists, SIGSEGV, SIGBUS, SIGILL, SIGFPE and SIGABRT write `ring` to `path`,
/// unless that file exists already, and then take their default action. Other threads that crash
/// meanwhile wait for at most 30 s. Nothing is written if a stack has overflowed, because the
/// handler has no other stack. The destructor restores the previous handlers. Only one object at a
/// time is active; a second one does nothing.
class CrashHandler {
public:
  CrashHandler(LastMinute& ring, const std::filesystem::path& path);
  ~CrashHandler();
  CrashHandler(const CrashHandler&) = delete;
  CrashHandler& operator=(const CrashHandler&) = delete;

private:
  bool armed_ = false;
};

} // namespace nendo::recording
