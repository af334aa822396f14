#pragma once
// Decides what one client is sent: which steps it still needs, and when it needs the whole shape.
// Nothing here knows of sockets.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/driver/record_counts.hpp>

#include "web/frame_stream.hpp"

namespace nendo::web {

/// What the page shows of a glove beside its samples.
struct GloveState {
  driver::RecordCounts counts;
  bool uncalibrated = false; ///< its angles are an average hand's
};
/// By flow::Placement::index_of(side).
using GloveStates = std::array<GloveState, 2>;

/// What the server adds to an update message.
struct FeedCounters {
  std::uint64_t lost = 0; ///< frames that came when the ring was full
  GloveStates gloves;
};

class Feed {
public:
  /// Must be called with the records before update() or skip() is.
  void look_at(std::span<const Record> records) noexcept;
  /// Returns the weights that the client must be sent first (Record::weights); 0: none.
  std::uint64_t wanted_weights() const noexcept { return needed_ == weights_ ? 0 : needed_; }
  /// Must be called when the client has been sent those weights, in place of those that it had.
  void weights_sent(std::uint64_t weights) noexcept { weights_ = weights; }
  /// Returns whether the client needs a shape: at first, when it has missed steps, and when its
  /// rounding errors may have become too large. It needs none as long as it lacks weights.
  bool wants_shape() const noexcept {
    return wanted_weights() == 0 && (lacks_shape_ || drift_ >= 1.0);
  }
  /// Must be called when the client has been sent the shape after that frame.
  void shape_sent(std::uint64_t number) noexcept;

  /// Makes an update message of the records since the last call. Returns nothing if there are none.
  /// The message has no steps while the client lacks the shape that they continue.
  std::optional<std::vector<std::byte>> update(std::span<const Record> records,
                                               const FeedCounters& counters);
  /// Must be called instead of update() when nothing can be sent to the client.
  void skip(std::span<const Record> records) noexcept;

private:
  std::span<const Record> unseen(std::span<const Record> records) noexcept;
  bool can_follow(std::span<const Record> records) const noexcept;

  bool lacks_shape_ = true;
  std::uint64_t needed_ = 0;  ///< the weights that the newest step needs
  std::uint64_t weights_ = 0; ///< that the client has
  std::uint64_t base_ = 0;    ///< the last frame that the client knows
  std::uint64_t shape_ = 0;   ///< the frame whose shape was sent last
  double drift_ = 0.0;
  std::uint64_t skipped_ = 0;
};

} // namespace nendo::web
