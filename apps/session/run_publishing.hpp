#pragma once
// The option --to: sends every frame to other programs.

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "cli/command.hpp"
#include "publish/osc_publisher.hpp"
#include "publish/segment.hpp"
#include "publish/vrpn_publisher.hpp"
#include "session/sink.hpp"

namespace nendo::session {

/// The result of one --to.
struct PublishedTo {
  std::string target; ///< the option's value
  std::variant<publish::SegmentCounts, publish::OscCounts, publish::VrpnCounts> counts{};
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
