#pragma once
// Passes commands to a running loop. Nothing is dropped silently.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/flow/command.hpp>

namespace nendo::session {

/// For one thread but for ring(), of which the loop is the consumer.
class LoopCommands {
public:
  explicit LoopCommands(std::size_t at_least) : ring_(at_least) {}

  flow::CommandRing& ring() noexcept { return ring_; }
  /// Returns how many the loop has not taken yet.
  std::size_t size() const noexcept { return ring_.size(); }
  /// Passes the command on. Returns false if the ring is full, as when the loop has stopped; the
  /// command is then dropped, and named by the next dropped().
  bool push(const flow::Command& command);
  /// Passes the command on, or returns false if the ring is full.
  bool try_push(const flow::Command& command) noexcept { return ring_.try_push(command); }
  /// Returns a message that names what was dropped since the last call, or nothing. Each command is
  /// named once until one is passed on again.
  std::optional<std::string> dropped();

private:
  flow::CommandRing ring_;
  std::vector<std::string_view> dropped_; ///< since the last command that was passed on
  std::size_t reported_ = 0;              ///< how many of these dropped() has named
};

} // namespace nendo::session
