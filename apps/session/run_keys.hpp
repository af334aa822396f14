#pragma once
// The keys of a run, in the terminal that it was started from.

#include <chrono>
#include <string>

#include "cli/keys.hpp"
#include "session/observer.hpp"

namespace nendo::session {

class RunKeys final : public Observer {
public:
  /// Prints the keys on standard error, if keys can come. `patience` is how long update() waits for
  /// a key. `keeps` says that a recording is kept in memory.
  RunKeys(std::chrono::milliseconds patience, bool keeps);

  void update(const RunStatus& status, flow::CommandRing& commands) override;
  /// Writes to standard error, also if no keys can come.
  void report(const std::string& message) override;

private:
  cli::Keys keys_;
  std::chrono::milliseconds patience_;
};

} // namespace nendo::session
