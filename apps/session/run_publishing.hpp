#pragma once
// The option --publish: sends every frame to other programs.

#include <memory>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "session/sink.hpp"

namespace nendo::session {

/// The result of one --publish.
struct PublishedTo {
  std::string target; ///< the option's value
  std::uint64_t records = 0;
  std::uint64_t shape_changes = 0; ///< only for a segment
  std::uint64_t bytes = 0;         ///< the segment's size, or the sent bytes
  bool is_segment = false;
  bool is_locked = false; ///< no page of the segment can be swapped out
  std::uint64_t datagrams = 0;
  std::uint64_t lost_records = 0;      ///< overwritten before they were sent
  std::uint64_t refused_datagrams = 0; ///< refused by the system
};

/// Publishes to one place.
class PublishingSink : public Sink {
public:
  /// Ends publishing, if it has not ended, and returns the counts.
  virtual PublishedTo end() = 0;
};

void add_publish_option(cli::Command& command, std::vector<std::string>& targets);

/// Makes one sink for each target. None publishes before its begin(). Error: usage.
Result<std::vector<std::unique_ptr<PublishingSink>>>
publish_to(const std::vector<std::string>& targets);

} // namespace nendo::session
