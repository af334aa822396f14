#include "session/run_keys.hpp"

#include <algorithm>
#include <iostream>

#include <spdlog/fmt/fmt.h>

#include "cli/cli.hpp"
#include "commands/commands.hpp"

namespace nendo::session {

namespace {

std::string brush_words(const flow::LoopSettings& settings) {
  const auto& brushes = settings.brushes;
  if (settings.mode != flow::Mode::type2 ||
      std::all_of(brushes.begin(), brushes.end(),
                  [](deform::Brush one) { return one == deform::Brush::pull; }))
    return {};
  return fmt::format(", {} at strength {:g}", flow::in_words(brushes), settings.brush_strength);
}

/// Says which settings were chosen.
std::string words_of(const flow::LoopSettings& wanted) {
  const auto [least, most] = std::minmax_element(wanted.radius_m.begin(), wanted.radius_m.end());
  return fmt::format("{}{}{}, {}, {}, radius {:.1f}{} cm", name_of(wanted.mode),
                     wanted.hold == flow::Hold::hand ? ", whole hand" : "", brush_words(wanted),
                     deform::name_of(wanted.kernel),
                     wanted.keep_volume > 0.0 ? fmt::format("{:g} of clay", wanted.keep_volume)
                     : wanted.injective       ? "never folds"
                                              : "may fold",
                     100.0 * *least,
                     *least == *most ? std::string() : fmt::format(" to {:.1f}", 100.0 * *most));
}

} // namespace

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
  if (row->choose != nullptr && answer.command) report(words_of(wanted_.now));
}

void RunKeys::report(const std::string& message) {
  std::cerr << '\n'; // so that a line of progress stays as it is
  cli::note(message);
}

} // namespace nendo::session
