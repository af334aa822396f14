#pragma once
// Carries frames from the loop's thread to the server's thread. For each frame it makes a record,
// which is encoded as PROTOCOL.md describes. From the records a client can follow the shape by
// itself. The whole shape is copied only when the server asks for it. A feed decides which of the
// records and shapes one client is sent. Nothing here knows of sockets.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/frame.hpp>

namespace nendo::web {

/// One frame, encoded for clients.
struct Record {
  std::uint64_t number = 0; ///< the frame's, counted from 1
  /// The step does not continue the previous record, so a client needs the shape again.
  bool discontinuous = false;
  bool bakes = false; ///< the step changes the base, and is not only drawn over it
  /// The rounding errors that a client, which adds up in float, may collect by this step, as a
  /// share of the allowed errors. When the shares add up to 1, the client needs a fresh shape.
  double drift = 0.0;
  /// deform::SurfaceField::number() of the weights that the step needs; 0: of none.
  std::uint64_t weights = 0;
  std::vector<std::byte> head; ///< head and hands of an update message, with `steps` 0
  std::vector<std::byte> step; ///< one step of an update message
};

class FrameStream final : public flow::FrameSink {
public:
  /// The most that a frame may have, whatever the settings become.
  struct Capacity {
    std::size_t fields = 0;
    std::size_t functions = 0; ///< max per field
    std::size_t vectors = 0;   ///< max of deform::SurfaceMove
  };

  /// layout: that of a loop that has not begun yet. Allocates all that show() needs.
  FrameStream(const deform::BlockLayout& layout, const Capacity& capacity);

  /// Writes a record while the stream is active. Copies the changed blocks of the shape if the
  /// shape was requested, after a commit and after an undo. Called in the tick; wait-free.
  void show(const flow::Frame& frame) noexcept override;

  // All functions that follow are for one other thread.

  /// Switches the stream on or off. While it is not active, no records are made. Wait-free.
  void set_active(bool active) noexcept { active_.store(active, std::memory_order_relaxed); }
  /// Appends the records since the last call. Allocates; does not block.
  void take(std::vector<Record>& records);
  /// Requests a copy of the next frame's shape. Has no effect while one is on its way. Wait-free.
  void request_shape() noexcept;
  /// A shape message: the base after the record `number`, which take() has not returned yet.
  struct Shape {
    std::uint64_t number = 0;
    std::vector<std::byte> message;
  };
  /// Returns the requested shape, or nothing if it has not come yet. To be called after take().
  /// Allocates; does not block.
  std::optional<Shape> take_shape();
  /// Returns how many frames came when the ring was full. Any thread may call it.
  std::uint64_t lost() const noexcept { return ring_.counters().refused; }

private:
  struct alignas(64) Chunk {
    std::array<std::byte, 64> bytes;
  };
  struct RecordHead;
  enum class ShapeRequest : std::uint8_t { none, pending, ready };

  void copy_shape(const flow::Frame& frame) noexcept;
  void push(const flow::Frame& frame, bool jumped, bool committed) noexcept;
  double drift_of(const flow::Frame& frame) const noexcept;

  const Eigen::Vector3d origin_;
  const double unit_;
  const std::size_t vertices_;
  const double max_drift_; ///< squared, in units
  // Used by the tick only.
  deform::BlockShape rest_; ///< in Type-1, the shape that fields are applied to; in Type-2, that of
                            ///< the last commit or undo
  std::uint64_t number_ = 0;
  std::uint64_t rest_changes_ = 0;
  std::uint64_t jumps_ = 0;
  std::vector<std::byte> record_;
  // Shared.
  SpscRing<Chunk> ring_;
  std::atomic<bool> active_{false};
  std::atomic<ShapeRequest> request_{ShapeRequest::none};
  deform::BlockShape shape_copy_; ///< the tick's while pending, the other thread's while ready
  std::uint64_t shape_copy_number_ = 0;
  // Used by the other thread only.
  std::uint64_t taken_ = 0;
  std::vector<std::byte> incoming_;
};

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
