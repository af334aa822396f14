#pragma once
// Options of the commands that run the loop or deform: the settings, from their descriptions
// (flow/setting.hpp), and the loop's timing, rights and threads.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/result.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/realtime.hpp>
#include <nendo/flow/setting.hpp>

#include "cli/command.hpp"

namespace nendo::session {

/// Adds the option of a choice. `text` holds the default, and must outlive parsing.
template <class T>
void add_setting(cli::Command& command, const flow::ChoiceSetting<T>& choice, std::string& text) {
  command.add_option(std::string(choice.option), text, std::string(choice.help));
}
/// Error: usage, naming the choices.
template <class T>
Result<T> parse_setting(const flow::ChoiceSetting<T>& choice, const std::string& text) {
  if (const auto named = choice.named(text)) return *named;
  return Error{Errc::usage,
               fmt::format("{} {}: unknown; use {}", choice.option, text, choice.choices())};
}

/// The values of several options of settings.
class SettingArguments {
public:
  /// Adds the option of a setting. This must outlive parsing.
  template <class T>
  void add(cli::Command& command, const flow::ChoiceSetting<T>& choice) {
    std::string& text = values_[choice.name];
    if (choice.name != flow::setting::mode.name) // a brush may choose it
      text = choice.name_of(choice.of(usual_));
    add_setting(command, choice, text);
  }
  void add(cli::Command& command, const flow::BrushesSetting& brushes);
  void add(cli::Command& command, const flow::NumberSetting& number);
  void add(cli::Command& command, const flow::SwitchSetting& on);
  /// Does what the option of a choice does.
  void choose(const flow::SettingText& choice, const std::string& value) {
    values_[choice.name] = value;
  }
  /// Adds the options of the hands' filter.
  void add_filter(cli::Command& command);

  /// Returns the requested settings; others have their defaults. Error: usage.
  Result<flow::LoopSettings> parse() const;

private:
  Result<void> parse_brushes(flow::LoopSettings& settings) const;
  Result<void> parse_number(const flow::NumberSetting& number, flow::LoopSettings& settings) const;

  std::map<std::string_view, std::string> values_;
  std::map<std::string_view, std::optional<double>> numbers_;
  flow::LoopSettings usual_ = flow::usual_settings();
  flow::LoopSettings switched_ = usual_; ///< has the switch settings
};

struct LoopArguments {
  std::uint32_t priority = 0;
  std::string affinity{};
  bool lock_memory = false;
  std::string policy = "skip";
  std::string spin = "auto";
  std::uint32_t threads = 1;

  /// Adds the options, which have cyclictest's names. With `short_names`, adds -p, -a and -m.
  void add_to(const cli::Command& command, bool short_names = false);
  /// Reads the options into `loop` and `realtime`. Errors: usage; failed (no processor for a second
  /// thread).
  Result<void> parse(flow::LoopOptions& loop, flow::RealtimeOptions& realtime) const;

private:
  Result<void> check_threads() const;
};

/// Adds --polynomial. `name` holds the default.
void add_polynomial_option(cli::Command& command, std::string& name);
/// Returns the solver's options for these settings. Error: usage.
Result<deform::CsrbfOptions> csrbf_for(const flow::LoopSettings& settings,
                                       const std::string& polynomial);

/// Returns one object per requested right, with name, wanted, granted, why and remedy.
nlohmann::ordered_json grants_json(const std::vector<flow::Grant>& grants);

} // namespace nendo::session
