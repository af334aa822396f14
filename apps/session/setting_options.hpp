#pragma once
// The options of settings, made from their description (flow/setting.hpp).

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/result.hpp>
#include <nendo/flow/setting.hpp>

#include "cli/command.hpp"

namespace nendo::session {

/// Adds the option of a choice. What `text` holds is the default, and it must outlive parsing.
template <class T>
void add_setting(cli::Command& command, const flow::ChoiceSetting<T>& choice, std::string& text) {
  command.add_option(std::string(choice.option), text, std::string(choice.help));
}
/// Error: usage, naming the choices.
template <class T>
Result<T> parse_setting(const flow::ChoiceSetting<T>& choice, const std::string& text) {
  if (const auto named = choice.named(text)) return *named;
  return Error{Errc::usage,
               fmt::format("{} {}: unknown; use {}", choice.option, text, choice.choices)};
}

/// The options of a command that takes several, as they were typed.
class SettingArguments {
public:
  /// Adds the option of a setting. This must outlive parsing.
  template <class T>
  void add(cli::Command& command, const flow::ChoiceSetting<T>& choice) {
    std::string& text = texts_[choice.name];
    if (choice.name != flow::setting::mode.name) // which a brush may choose
      text = choice.name_of(choice.of(usual_));
    add_setting(command, choice, text);
  }
  void add(cli::Command& command, const flow::BrushesSetting& brushes);
  void add(cli::Command& command, const flow::NumberSetting& number);
  void add(cli::Command& command, const flow::SwitchSetting& on);
  /// Adds the options of the hands' filter.
  void add_filter(cli::Command& command);

  /// Returns the settings that were asked for; others have their defaults. Error: usage, naming
  /// what can be used.
  Result<flow::LoopSettings> parse() const;

private:
  Result<void> parse_brushes(flow::LoopSettings& settings) const;
  Result<void> parse_number(const flow::NumberSetting& number, flow::LoopSettings& settings) const;

  std::map<std::string_view, std::string> texts_;
  std::map<std::string_view, std::optional<double>> numbers_;
  flow::LoopSettings usual_ = flow::usual_settings();
  flow::LoopSettings switched_ = usual_; ///< has those that are on or off
};

} // namespace nendo::session
