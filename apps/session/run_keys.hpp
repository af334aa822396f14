#pragma once
// The keys of a run, in the terminal that it was started from.

#include <chrono>
#include <string>

#include <nendo/flow/wanted_settings.hpp>

#include "cli/terminal.hpp"
#include "session/observer.hpp"

namespace nendo::session {

class RunKeys final : public Observer {
public:
  /// Says on standard error which key lists the keys, if keys can come. `timeout` is how long
  /// update() waits for a key.
  explicit RunKeys(std::chrono::milliseconds timeout);

  void update(const RunStatus& status, Asks& asks) override;
  /// Writes to standard error, also if no keys can come.
  void report(const std::string& message) override;

private:
  cli::Keys keys_;
  std::chrono::milliseconds timeout_;
  flow::WantedSettings wanted_;
};

} // namespace nendo::session
