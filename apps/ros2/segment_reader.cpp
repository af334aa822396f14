#include "ros2/segment_reader.hpp"

namespace nendo::ros2 {

Result<std::optional<publish::MappedSegment>> attach(const std::string& name) {
  auto mapped = publish::MappedSegment::open(publish::segment_path(name));
  if (!mapped && mapped.error().code == Errc::no_permission)
    return Error{Errc::no_permission,
                 mapped.error().message +
                     "; run nendo-ros2 as the user of the run, or give the run --to shm:" + name +
                     "?group=GROUP"};
  if (mapped && *mapped && (*mapped)->has_ended()) // what a killed run left
    return std::optional<publish::MappedSegment>();
  return mapped;
}

bool read(const publish::CheckedSegment& segment, std::uint64_t number, HandsRecord& out) noexcept {
  if (!segment.copy(segment.record_at(number), number, out.record)) return false;
  if (segment.has_states()) return segment.copy(segment.states_at(number), number, out.states);
  out.states = {};
  return true;
}

} // namespace nendo::ros2
