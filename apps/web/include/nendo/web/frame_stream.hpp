#pragma once
// From the tick to the server's thread: a compact record of each frame while somebody looks, and
// the whole shape when it is asked for. A record is what a client needs to follow the shape with a
// vertex shader of its own, in the bytes that go to it (PROTOCOL.md).

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/frame_sink.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::web {

/// A frame as a client is told of it.
struct Record {
  std::uint64_t number = 0; ///< of the frame, as the tap counts them, from 1
  bool broken = false;      ///< its step does not go on from the record before: the shape is needed
  bool bakes = false;       ///< its step becomes the base
  /// By how much a follower, who adds up in float, may be off for it: when these add up to 1, it
  /// wants a fresh shape.
  double wear = 0.0;
  std::vector<std::byte> told; ///< head and hands of an update message, `steps` 0
  std::vector<std::byte> step; ///< one step of it
};

class FrameStream final : public flow::FrameSink {
public:
  /// Of a loop that is about to begin. Allocates for everything that show() needs.
  /// most_fields, most_functions: of a frame, and of a field.
  FrameStream(const deform::BlockLayout& layout, flow::Mode mode, std::size_t most_fields,
              std::size_t most_functions);

  /// In the tick. Wait-free: a copy of the shape's changed blocks if it was asked for, and in
  /// Type-1 another one if the hands committed or undid.
  void show(const flow::Frame& frame) noexcept override;

  /// The rest is for one other thread.
  /// While nobody listens, no records are made. Wait-free.
  void listen(bool wanted) noexcept { listened_to_.store(wanted, std::memory_order_relaxed); }
  /// Appends the records since the last call. Allocates; does not block.
  void take(std::vector<Record>& records);
  /// The shape of the next frame is wanted; more calls before it has come change nothing.
  void ask_for_shape() noexcept;
  /// A shape message: the base after the record `number`, which take() has not given before.
  struct Shape {
    std::uint64_t number = 0;
    std::vector<std::byte> message;
  };
  /// To be called after take(). Nothing: it has not come yet. Allocates; does not block.
  std::optional<Shape> take_shape();
  /// Frames that found no room in the ring. Any thread.
  std::uint64_t lost() const noexcept { return ring_.counters().refused; }

private:
  struct alignas(64) Chunk {
    std::array<std::byte, 64> bytes;
  };
  struct RecordHead;
  enum class Request : std::uint8_t { none, asked, ready };

  void give_shape(const flow::Frame& frame) noexcept;
  void push(const flow::Frame& frame, bool undone, bool committed) noexcept;
  double wear_of(const flow::Frame& frame) const noexcept;

  const Eigen::Vector3d origin_;
  const double unit_;
  const std::size_t vertices_;
  const bool type1_;
  const double most_wear_; ///< squared, in units
  // The tick's own.
  deform::BlockShape rest_; ///< of type 1: what fields are applied to
  std::uint64_t number_ = 0;
  std::uint64_t commits_ = 0;
  std::uint64_t undos_ = 0;
  std::vector<std::byte> record_;
  // Shared.
  SpscRing<Chunk> ring_;
  std::atomic<bool> listened_to_{false};
  std::atomic<Request> request_{Request::none};
  deform::BlockShape given_; ///< the tick's while asked, the other thread's while ready
  std::uint64_t given_number_ = 0;
  // The other thread's own.
  std::uint64_t taken_ = 0;
  std::vector<std::byte> incoming_;
};

} // namespace nendo::web
