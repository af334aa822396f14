#pragma once
// The shared-memory segment of `--to shm:NAME`. It has a header, the data of the loop, a ring
// of records and a ring of shapes.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo_publish.h>

#include "publish/frame_record.hpp"

namespace nendo::publish {

/// A shared-memory object that this process writes and other processes map for reading.
class SharedMemory {
public:
  /// Makes zeroed memory that has no name yet. All pages are present and, if allowed, locked, so
  /// that writing never waits. This user can read it, and so can `group`, if given. No reader can
  /// write it. Errors: failed (no space), no_permission (this user is not in the group).
  static Result<SharedMemory> create(const std::string& name, std::size_t bytes,
                                     const std::optional<unsigned>& group);
  /// Gives the memory the name /dev/shm/nendo-`name`, with its present contents. Replaces a segment
  /// that a crashed run left, but nothing else. If several runs want the name at once, one gets it.
  /// Errors: failed (another run has the name, or the file is no segment), no_permission (it
  /// belongs to another user).
  Result<void> announce();
  /// Removes the name, if it still belongs to this memory. Processes that have mapped the memory
  /// keep it.
  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;

  /// Returns the memory, which is aligned to a page.
  AtomicWord* words() const noexcept { return static_cast<AtomicWord*>(memory_); }
  std::size_t bytes() const noexcept { return bytes_; }
  /// Returns true if the pages cannot be swapped out.
  bool is_locked() const noexcept { return locked_; }

private:
  SharedMemory(std::string path, UniqueFd file, std::size_t bytes)
      : path_(std::move(path)), file_(std::move(file)), bytes_(bytes) {}
  Result<void> lay_out(const std::optional<unsigned>& group);

  std::string path_;
  UniqueFd file_; ///< its lock shows that the writer is alive
  void* memory_ = nullptr;
  std::size_t bytes_;
  bool locked_ = false;
  bool named_ = false;
};

/// Returns the least length, in words, of a slot for this number of vertices: nendo_publish_shape
/// and then the floats.
std::size_t shape_slot_words(std::size_t vertices) noexcept;

/// A ring of slots for deformed vertices. Each slot has all vertices in the order of the mesh. The
/// writer rewrites only the blocks that changed since that slot was written last.
class ShapeRing {
public:
  ShapeRing() = default;
  /// `memory` must have slots * slot_words zeros and must outlive the ring. slot_words must be at
  /// least shape_slot_words(). Allocates; the other functions do not.
  ShapeRing(AtomicWord* memory, std::size_t slots, std::size_t slot_words, std::size_t vertices);

  /// To be called before a loop's first frame. `layout` must have that number of vertices, and must
  /// exist as long as shapes are written.
  void begin(const deform::BlockLayout& layout) noexcept { layout_ = &layout; }
  /// Writes the shape that belongs to record `number`. Numbers begin with 1 and rise by 1.
  /// Wait-free, without allocation. The cost is a look at each block's stamp, and three stores for
  /// each vertex of the changed blocks.
  void write(std::uint64_t number, const deform::BlockShape& shape) noexcept;
  /// Returns how often a shape differed from the previous one.
  std::uint64_t changes() const noexcept { return changes_; }

private:
  using Stamps = std::vector<std::uint64_t>;
  void write_block(const deform::BlockShape& shape, std::size_t block, AtomicWord* slot) noexcept;

  AtomicWord* memory_ = nullptr;
  std::size_t slot_words_ = 0;
  std::size_t vertices_ = 0;
  std::vector<Stamps> stamps_; ///< each slot's stamps of its blocks
  const deform::BlockLayout* layout_ = nullptr;
  std::uint64_t changes_ = 0;
};

/// Returns the header of the segment of such a loop, without the writer and the times. The segment
/// has space for the records of one second, but at least 4, at most 1024 and, above 4, at most 16
/// MiB, and for four shapes.
nendo_publish_header plan_segment(const LoopOutline& outline) noexcept;

struct SegmentCounts {
  std::uint64_t records = 0;       ///< frames shown
  std::uint64_t shape_changes = 0; ///< frames with a shape that differs from the previous one
  std::uint64_t bytes = 0;         ///< the size of the segment
  bool is_locked = false;          ///< in memory, so that it cannot be swapped out
};

class SegmentPublisher final : public flow::FrameSink {
public:
  SegmentPublisher(std::string name, std::optional<unsigned> group)
      : name_(std::move(name)), group_(group) {}
  /// Does what end() does.
  ~SegmentPublisher() override { end(); }

  /// To be called before each loop's first tick, while no loop runs. The segment stays the same if
  /// it has space for this loop at the same offsets, as after a change of settings. Otherwise the
  /// old segment is ended, and a new one takes its name. Errors: those of SharedMemory.
  Result<void> begin(const LoopOutline& outline);
  /// Does what begin() does for the first loop, but gives the segment no name yet.
  Result<void> lay_out(const LoopOutline& outline);
  /// Gives it the name. Errors: those of SharedMemory::announce().
  Result<void> announce();
  /// Writes a frame. Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override;
  /// Marks the segment as ended, and removes its name. To be called while no loop
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
  nendo_publish_header plan_{};
  RecordRing records_;
  RecordRing states_;
  ShapeRing shapes_;
  FrameRecord record_;
  std::uint64_t generation_ = 0;
  std::uint64_t number_ = 0;
  SegmentCounts counts_;
};

} // namespace nendo::publish
