#pragma once
// The keys of a run, in the terminal that it was started from.

#include <chrono>
#include <string>

#include "cli/keys.hpp"
#include "session/observer.hpp"

namespace nendo::session {

class RunKeys final : public Observer {
public:
  /// Says on standard error what the keys are, if any can come. patience: how long update() waits
  /// for a key. keeps: a recording is kept in memory.
  RunKeys(std::chrono::milliseconds patience, bool keeps);

  void update(const RunStatus& status, flow::CommandRing& commands) override;
  /// Writes to standard error, whether keys can come or not.
  void report(const std::string& message) override;

private:
  cli::Keys keys_;
  std::chrono::milliseconds patience_;
};

} // namespace nendo::session
