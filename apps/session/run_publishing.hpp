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
  std::uint64_t shape_changes = 0; ///< changes of the shape; only in a segment
  std::uint64_t bytes = 0;         ///< the size of the segment, or of all sent data
  bool is_segment = false;
  bool is_locked = false; ///< the segment is locked in memory
  std::uint64_t datagrams = 0;
  std::uint64_t lost_records = 0;      ///< overwritten before they were sent
  std::uint64_t refused_datagrams = 0; ///< refused by the system
};

/// Publishes to one target.
class PublishingSink : public Sink {
public:
  /// Ends publishing, and returns the counts. Idempotent.
  virtual PublishedTo end() = 0;
};

void add_publish_option(cli::Command& command, std::vector<std::string>& targets);

/// Makes one sink for each target, which publishes after its begin(). Error: usage.
Result<std::vector<std::unique_ptr<PublishingSink>>>
publish_to(const std::vector<std::string>& targets);

} // namespace nendo::session
