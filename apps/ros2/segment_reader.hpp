#pragma once
// Reads the hands from a segment that another program publishes (apps/publish/FORMAT.md).

#include <cstdint>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>

#include "publish/hands_record.hpp"
#include "publish/mapped_segment.hpp"

namespace nendo::ros2 {

using publish::HandsRecord;

/// Returns the segment of a run that lives, or nullopt if no run publishes under that name now.
/// Errors: those of MappedSegment::open().
Result<std::optional<publish::MappedSegment>> attach(const std::string& name);

/// Copies record `number`. Returns false if it is not there, or no longer.
bool read(const publish::CheckedSegment& segment, std::uint64_t number, HandsRecord& out) noexcept;

} // namespace nendo::ros2
