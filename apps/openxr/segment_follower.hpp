#pragma once
// Maps the segment of a run by its name, and maps the next one when another run takes the name.

#include <array>
#include <cstddef>
#include <cstdint>

#include <sys/types.h>

#include <nendo/base/shared_slots.hpp>

#include "openxr/segment_view.hpp"

namespace nendo::openxr {

/// Why there are no hands, for messages.
enum class SegmentState : std::uint8_t {
  mapped,
  missing,  ///< no run publishes under the name
  refused,  ///< the system does not let this user open it; error() has the reason
  unusable, ///< not a segment, or of another version
};

class SegmentFollower {
public:
  /// Under a lock, while no thread reads. Unmaps everything. It is no destructor, so that static
  /// objects need none when the library is unloaded.
  void close() noexcept;
  /// Under a lock, once. `name` is the NAME of `nendo run --to shm:NAME`. Returns false if that is
  /// no name.
  bool set_name(const char* name) noexcept;
  const char* path() const noexcept { return path_.data(); }

  /// Under a lock. Looks whether the name belongs to another file, and maps that. Calls the system,
  /// but never waits.
  SegmentState look() noexcept;
  int error() const noexcept { return error_; }

  /// Any thread, wait-free: SegmentView::read() of the mapped segment.
  bool read(std::size_t side, std::int64_t now_ns, PublishedHand& hand) noexcept;

private:
  struct Mapping {
    SegmentView view;
    void* base = nullptr;
    std::size_t bytes = 0;
  };
  SegmentState map(std::size_t slot) noexcept;
  void unmap_unused() noexcept;

  // One for readers, one for those that have not noticed the change, and a spare one.
  static constexpr std::size_t slots = 3;

  std::array<char, 96> path_{};
  SharedSlots<Mapping, slots> mappings_;
  dev_t device_ = 0; ///< the file that was looked at
  ino_t file_ = 0;
  SegmentState state_ = SegmentState::missing;
  int error_ = 0;
};

} // namespace nendo::openxr
