#pragma once
// Passes frames from the loop's thread to the server's thread, as records in the encoding of
// PROTOCOL.md, from which a client can compute the shape. Copies the whole shape only at the
// server's request. A feed selects the records and shapes for one client. Independent of sockets.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/triple_buffer.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/frame.hpp>

#include "ros/frame_hands.hpp"

namespace nendo::web {

/// What a feed must know of a frame.
struct RecordFacts {
  std::uint64_t number = 0; ///< the frame's number, counted from 1
  /// The step does not continue the previous record: clients need a new shape.
  bool discontinuous = false;
  bool bakes = false; ///< the step changes the base shape, not only the drawn one
  /// A bound of the float rounding error that a client accumulates by this step, as a fraction of
  /// the allowed error. When the sum reaches 1, the client needs a new shape.
  double drift = 0.0;
  /// deform::SurfaceField::number() of the step's weights; 0: none.
  std::uint64_t weights = 0;
};

/// One frame, encoded for clients.
struct Record : RecordFacts {
  std::vector<std::byte> head; ///< head and hands of an update message, with `steps` 0
  std::vector<std::byte> step; ///< one step of an update message
};

class FrameStream final : public flow::FrameSink {
public:
  /// layout: of a loop that has not begun yet. Allocates all memory for show().
  FrameStream(const deform::BlockLayout& layout, const flow::FrameCapacity& capacity);

  /// Writes a record if the stream is active. Copies the shape's changed blocks if it was
  /// requested, after a commit and after an undo. Loop's thread; wait-free.
  void show(const flow::Frame& frame) noexcept override;

  // The following functions are for one other thread.

  /// Switches the stream on or off. An inactive stream makes no records. Wait-free.
  void set_active(bool active) noexcept { active_.store(active, std::memory_order_relaxed); }
  /// Appends the records since the last call. Allocates; does not block.
  void take(std::vector<Record>& records);
  /// Requests a copy of the next frame's shape. Has no effect while a request is pending.
  /// Wait-free.
  void request_shape() noexcept;
  /// A shape message: the base shape after the record `number`, which take() has not returned yet.
  struct Shape {
    std::uint64_t number = 0;
    std::vector<std::byte> message;
  };
  /// Returns the requested shape, or nothing if it is not ready. Call it after take(). Allocates;
  /// does not block.
  std::optional<Shape> take_shape();
  /// Switches on or off that show() passes on the hands. Wait-free.
  void set_hands_active(bool active) noexcept {
    hands_active_.store(active, std::memory_order_relaxed);
  }
  struct Hands {
    ros::FrameHands present;
    HostTime woke{}; ///< Frame::woke
  };
  /// Returns the newest hands, which are valid until the next call; null if there were none since
  /// the last one. Wait-free.
  const Hands* take_hands() noexcept { return hands_.update() ? &hands_.front() : nullptr; }
  /// Requests a copy of the next frame's shape as it is drawn. Has no effect while a request is
  /// pending. Wait-free.
  void request_drawn() noexcept;
  /// Writes the drawn shape to `xyz`, as in a shape message, and returns its Frame::woke; nothing
  /// if it is not ready. Allocates; does not block.
  std::optional<HostTime> take_drawn(std::vector<float>& xyz);
  /// Returns the number of frames that the full ring refused. Thread-safe.
  std::uint64_t lost() const noexcept { return ring_.counters().refused; }

private:
  struct alignas(64) Chunk {
    std::array<std::byte, 64> bytes;
  };
  struct RecordHead;
  enum class ShapeRequest : std::uint8_t { none, pending, ready };

  /// A copy of a shape for the other thread.
  struct ShapeCopy {
    explicit ShapeCopy(const deform::BlockShape& initial) : shape(initial) {}
    std::atomic<ShapeRequest> request{ShapeRequest::none};
    deform::BlockShape shape; ///< the tick's while pending, the other thread's while ready
    std::uint64_t number = 0;
    HostTime woke{};
  };

  static void request(ShapeCopy& copy) noexcept;
  void copy_if_asked(ShapeCopy& copy, const deform::BlockShape& shape,
                     const flow::Frame& frame) noexcept;
  void push(const flow::Frame& frame, bool jumped, bool committed) noexcept;
  double drift_of(const flow::Frame& frame) const noexcept;

  const Eigen::Vector3d origin_;
  const double unit_;
  const std::size_t vertices_;
  const double max_drift_; ///< squared, in units
  // Used by the tick only.
  deform::BlockShape rest_; ///< in type 1, the shape to which fields apply; in type 2, the shape of
                            ///< the last commit or undo
  std::uint64_t number_ = 0;
  std::uint64_t rest_changes_ = 0;
  std::uint64_t jumps_ = 0;
  std::vector<std::byte> record_;
  // Shared.
  SpscRing<Chunk> ring_;
  std::atomic<bool> active_{false};
  ShapeCopy base_;  ///< the shape to which the next steps apply
  ShapeCopy drawn_; ///< the shape of a frame
  std::atomic<bool> hands_active_{false};
  TripleBuffer<Hands> hands_{Hands{}};
  // Used by the other thread only.
  std::uint64_t taken_ = 0;
  std::vector<std::byte> incoming_;
};

class Feed {
public:
  /// Must be called with the records before update() or skip().
  void look_at(std::span<const Record> records) noexcept;
  /// Returns the weights to send to the client first (Record::weights); 0: none.
  std::uint64_t wanted_weights() const noexcept { return needed_ == weights_ ? 0 : needed_; }
  /// Must be called after sending these weights, which replace the client's previous ones.
  void weights_sent(std::uint64_t weights) noexcept { weights_ = weights; }
  /// Returns whether the client needs a shape: initially, after missed steps, and when its rounding
  /// errors may be too large. False while it needs weights.
  bool wants_shape() const noexcept {
    return wanted_weights() == 0 && (lacks_shape_ || drift_ >= 1.0);
  }
  /// Must be called after sending the shape of that frame.
  void shape_sent(std::uint64_t number) noexcept;

  /// Makes an update message from the records since the last call; nothing if there are none. The
  /// message has no steps while the client needs a shape. `lost` is FrameStream::lost().
  std::optional<std::vector<std::byte>> update(std::span<const Record> records, std::uint64_t lost);
  /// Must be called instead of update() when nothing can be sent to the client.
  void skip(std::span<const Record> records) noexcept;

private:
  std::span<const Record> unseen(std::span<const Record> records) noexcept;
  bool can_follow(std::span<const Record> records) const noexcept;

  bool lacks_shape_ = true;
  std::uint64_t needed_ = 0;  ///< the newest step's weights
  std::uint64_t weights_ = 0; ///< the client's weights
  std::uint64_t base_ = 0;    ///< the last frame that the client has
  std::uint64_t shape_ = 0;   ///< the frame of the last sent shape
  double drift_ = 0.0;
  std::uint64_t skipped_ = 0;
};

} // namespace nendo::web
