#include "session/run_keys.hpp"

#include <iostream>

#include <nendo/flow/setting.hpp>

#include "cli/cli.hpp"
#include "commands/commands.hpp"

namespace nendo::session {

RunKeys::RunKeys(std::chrono::milliseconds timeout) : timeout_(timeout) {
  if (keys_.are_available()) cli::note("keys: ? lists them, q ends the run");
}

void RunKeys::update(const RunStatus& status, Asks& asks) {
  const auto key = keys_.next(timeout_);
  if (!key) return;
  const auto* const row = commands::with_key({&*key, 1}, commands::in_terminal);
  if (row == nullptr) return;
  if (!row->is_for_run())
    return report("keys:" + commands::key_list(commands::in_terminal, "\n  ", "  "));
  wanted_.follow(status.frame.settings);
  const commands::Answer answer = commands::press(*row, status.situation(), wanted_);
  if (answer.command) asks.emplace_back(*answer.command);
  if (answer.refusal != nullptr) report(answer.refusal);
  if (row->choose != nullptr && answer.command)
    report(flow::in_words(wanted_.now, status.frame.units_per_metre));
}

void RunKeys::report(const std::string& message) {
  std::cerr << '\n'; // so that a line of progress stays as it is
  cli::note(message);
}

} // namespace nendo::session
