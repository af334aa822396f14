#pragma once
// What one client is to be sent: which steps it still needs, and when only the whole shape helps.
// Pure.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/web/frame_stream.hpp>

namespace nendo::web {

/// What the server adds to a frame.
struct FeedCounters {
  std::uint64_t lost = 0; ///< frames that found no room in the ring
  std::array<std::uint32_t, 2> bad_records{};
};

class Feed {
public:
  /// Whether a shape is to be sent: at first, when steps were missed, when too many were added up.
  bool wants_shape() const noexcept { return lacks_shape_ || wear_ >= 1.0; }
  /// It has been sent the shape after that frame.
  void got_shape(std::uint64_t number) noexcept;

  /// An update message of the records since the last call; nothing if there are none. Without the
  /// shape that they go on from it has no steps.
  std::optional<std::vector<std::byte>> update(std::span<const Record> records,
                                               const FeedCounters& counters);
  /// The same records, where there is no room to send anything.
  void skip(std::span<const Record> records) noexcept;

private:
  std::span<const Record> unseen(std::span<const Record> records) noexcept;
  bool can_follow(std::span<const Record> records) const noexcept;

  bool lacks_shape_ = true;
  std::uint64_t base_ = 0;  ///< the frame whose shape is the base, or that has been followed
  std::uint64_t shape_ = 0; ///< the frame whose shape was sent last
  double wear_ = 0.0;
  std::uint64_t skipped_ = 0;
};

} // namespace nendo::web
