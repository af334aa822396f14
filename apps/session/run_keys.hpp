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
  /// Prints the keys on standard error, if keys can come. `timeout` is how long update() waits for
  /// a key. `keeps_last_minute` adds the key that saves it.
  RunKeys(std::chrono::milliseconds timeout, bool keeps_last_minute);

  void update(const RunStatus& status, flow::CommandRing& commands) override;
  /// Writes to standard error, also if no keys can come.
  void report(const std::string& message) override;

private:
  static void clutch(Side side, const flow::Frame& frame, flow::CommandRing& commands);
  void step(flow::Request request, std::uint64_t steps, flow::CommandRing& commands);
  void change(char key, const flow::Frame& frame, flow::CommandRing& commands);

  cli::Keys keys_;
  std::chrono::milliseconds timeout_;
  flow::WantedSettings wanted_;
};

} // namespace nendo::session
