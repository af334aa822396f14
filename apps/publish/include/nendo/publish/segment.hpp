#pragma once
// The segment that `--publish shm:NAME` shows: header, what belongs to the loop, records, shapes.

#include <memory>
#include <optional>
#include <string>

#include <nendo/flow/frame_sink.hpp>
#include <nendo/publish/frame_record.hpp>
#include <nendo/publish/shape_ring.hpp>
#include <nendo/publish/shared_memory.hpp>

namespace nendo::publish {

/// Sizes and offsets in bytes, as nendo_publish_header names them.
struct SegmentPlan {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t record_slots = 0, record_stride = 0;
  std::uint64_t shape_slots = 0, shape_stride = 0;
  std::uint64_t setup_offset = 0, triangles_offset = 0, rest_offset = 0;
  std::uint64_t records_offset = 0, shapes_offset = 0, segment_bytes = 0;

  friend bool operator==(const SegmentPlan&, const SegmentPlan&) = default;
};
/// For such a loop: records for a second (4 to 1024, in 16 MiB), four shapes.
SegmentPlan plan_segment(const LoopOutline& outline) noexcept;

struct SegmentCounts {
  std::uint64_t records = 0;       ///< frames shown
  std::uint64_t shape_changes = 0; ///< of those, with another shape than the one before
  std::uint64_t bytes = 0;         ///< of the segment
  bool is_locked = false;          ///< in memory
};

class SegmentPublisher final : public flow::FrameSink {
public:
  SegmentPublisher(std::string name, std::optional<unsigned> group)
      : name_(std::move(name)), group_(group) {}
  /// Its readers are told that it has ended.
  ~SegmentPublisher() override { end(); }

  /// Before each loop's first tick, while no loop runs. The segment stays if it has room for this
  /// loop in the same places, as it has after a renewal; otherwise the old one is ended and another
  /// one takes its name. Errors: SharedMemory's.
  Result<void> begin(const LoopOutline& outline);
  /// Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override;
  /// Tells the readers that it has ended, and takes its name away. No loop runs.
  void end() noexcept;

  /// While no loop runs.
  SegmentCounts counts() const noexcept;

private:
  void write_header() noexcept;
  void write_setup(const LoopOutline& outline);

  std::string name_;
  std::optional<unsigned> group_;
  std::optional<SharedMemory> memory_;
  SegmentPlan plan_;
  RecordRing records_;
  ShapeRing shapes_;
  FrameRecord record_;
  std::uint64_t generation_ = 0;
  std::uint64_t number_ = 0;
  SegmentCounts counts_;
};

} // namespace nendo::publish
