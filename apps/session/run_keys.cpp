#include "session/run_keys.hpp"

#include <iostream>

#include "cli/cli.hpp"

namespace nendo::session {

RunKeys::RunKeys(std::chrono::milliseconds timeout, bool keeps_last_minute) : timeout_(timeout) {
  if (!keys_.are_available()) return;
  cli::note(
      "keys: g lets go, takes hold again; c keeps the shape so far; u undoes, r redoes; s saves; " +
      std::string(keeps_last_minute ? "k keeps the recording of what was just done; " : "") +
      "q ends");
}

void RunKeys::update(const RunStatus& status, flow::CommandRing& commands) {
  const auto key = keys_.next(timeout_);
  if (!key) return;
  const bool held = status.frame.held;
  if (*key == 'g') commands.try_push(held ? flow::Request::let_go : flow::Request::grab);
  if (*key == 'c' || *key == ' ') commands.try_push(flow::Request::commit);
  if (*key == 'u') step(flow::Request::undo, status.frame.undo_steps, commands);
  if (*key == 'r' || *key == 'U') step(flow::Request::redo, status.frame.redo_steps, commands);
  if (*key == 's') commands.try_push(flow::SaveShape{});
  if (*key == 'k') commands.try_push(flow::SaveRecording{});
  if (*key == 'q') commands.try_push(flow::EndRun{});
}

// The loop is asked in any case, because it may be a few ticks ahead of `steps`.
void RunKeys::step(flow::Request request, std::uint64_t steps, flow::CommandRing& commands) {
  commands.try_push(request);
  if (steps == 0)
    report(request == flow::Request::undo ? "there is nothing to undo"
                                          : "there is nothing to redo");
}

void RunKeys::report(const std::string& message) {
  std::cerr << '\n'; // so that a line of progress stays as it is
  cli::note(message);
}

} // namespace nendo::session
