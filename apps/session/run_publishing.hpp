#pragma once
// The option --publish: sends every frame to other programs.

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "cli/command.hpp"
#include "publish/datagrams.hpp"
#include "publish/segment.hpp"
#include "session/sink.hpp"

namespace nendo::session {

/// The result of one --publish.
struct PublishedTo {
  std::string target; ///< the option's value
  std::variant<publish::SegmentCounts, publish::DatagramCounts> counts{};
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
