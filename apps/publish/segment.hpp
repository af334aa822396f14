#pragma once
// The shared-memory segment of `--publish shm:NAME`. It has a header, the data of the loop, a ring
// of records and a ring of shapes.

#include <memory>
#include <optional>
#include <string>

#include <nendo/flow/frame_sink.hpp>

#include "publish/frame_record.hpp"
#include "publish/shape_ring.hpp"
#include "publish/shared_memory.hpp"

namespace nendo::publish {

/// Sizes and offsets in bytes, with the names of nendo_publish_header.
struct SegmentPlan {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t record_slots = 0, record_stride = 0;
  std::uint64_t shape_slots = 0, shape_stride = 0;
  std::uint64_t setup_offset = 0, triangles_offset = 0, rest_offset = 0;
  std::uint64_t records_offset = 0, shapes_offset = 0, segment_bytes = 0;

  friend bool operator==(const SegmentPlan&, const SegmentPlan&) = default;
};
/// Returns the plan for such a loop. It has room for the records of one second, but at least 4, at
/// most 1024 and, above 4, at most 16 MiB. It has room for four shapes.
SegmentPlan plan_segment(const LoopOutline& outline) noexcept;

struct SegmentCounts {
  std::uint64_t records = 0;       ///< frames shown
  std::uint64_t shape_changes = 0; ///< of those, with a shape that differs from the previous one
  std::uint64_t bytes = 0;         ///< of the segment
  bool is_locked = false;          ///< in memory, so that it cannot be swapped out
};

class SegmentPublisher final : public flow::FrameSink {
public:
  SegmentPublisher(std::string name, std::optional<unsigned> group)
      : name_(std::move(name)), group_(group) {}
  /// Does what end() does.
  ~SegmentPublisher() override { end(); }

  /// To be called before each loop's first tick, while no loop runs. The segment stays the same if
  /// it has room for this loop at the same offsets, as after a change of settings. Otherwise the
  /// old segment is ended, and a new one takes its name. Errors: those of SharedMemory.
  Result<void> begin(const LoopOutline& outline);
  /// Does what begin() does for the first loop, but gives the segment no name yet.
  Result<void> lay_out(const LoopOutline& outline);
  /// Gives it the name. Errors: those of SharedMemory::announce().
  Result<void> announce();
  /// Writes a frame. Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override;
  /// Tells the readers that the segment has ended, and removes its name. To be called while no loop
  /// runs.
  void end() noexcept;

  /// Returns the counts. To be called while no loop runs.
  SegmentCounts counts() const noexcept;

private:
  void describe(const LoopOutline& outline);
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
