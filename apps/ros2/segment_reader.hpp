#pragma once
// Reads the hands from a segment that another program publishes (apps/publish/FORMAT.md).

#include <cstdint>
#include <optional>
#include <string>

#include <nendo_publish.h>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

namespace nendo::ros2 {

/// One tick of a run.
struct HandsRecord {
  nendo_publish_record record{};
  nendo_publish_states states{}; ///< zeros if the run is older than version 1.2
};

/// A segment of a run that lives, or that has ended since. It copies the header once, and checks
/// the copy, so that a writer who changes the header cannot make this reader leave the memory.
class SegmentReader {
public:
  /// Returns nullopt if no run publishes under that name now. Errors: no_permission; bad_input
  /// (another file, another version).
  static Result<std::optional<SegmentReader>> attach(const std::string& name);
  ~SegmentReader();
  SegmentReader(SegmentReader&& other) noexcept;
  SegmentReader& operator=(SegmentReader&&) = delete;

  /// Returns the number of the newest record; 0: there is none yet.
  std::uint64_t newest() const noexcept { return nendo_publish_newest(base_); }
  /// Returns how many records the segment keeps.
  std::uint32_t capacity() const noexcept { return header_.record_slots; }
  /// Copies record `number`. Returns false if it is not there, or no longer.
  bool read(std::uint64_t number, HandsRecord& out) const noexcept;
  /// Returns whether the run has ended or was killed: while it lives, it holds a lock. One system
  /// call.
  bool has_ended() const noexcept;

private:
  SegmentReader(UniqueFd file, const char* base, std::uint64_t bytes) noexcept;

  UniqueFd file_;
  const char* base_;
  std::uint64_t bytes_;
  nendo_publish_header header_{};
};

} // namespace nendo::ros2
