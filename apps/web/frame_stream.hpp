#pragma once
// Carries frames from the loop's thread to the server's thread. For each frame it makes a record,
// which is encoded as PROTOCOL.md describes. From the records a client can follow the shape by
// itself. The whole shape is copied only when the server asks for it.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/deform/vertex_blocks.hpp>
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

} // namespace nendo::web
