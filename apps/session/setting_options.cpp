#include "session/setting_options.hpp"

#include <type_traits>

namespace nendo::session {

void SettingArguments::add(cli::Command& command, const flow::BrushesSetting& brushes) {
  command.add_option(std::string(brushes.option), texts_[brushes.name], std::string(brushes.help));
}

void SettingArguments::add(cli::Command& command, const flow::NumberSetting& number) {
  command.add_option(std::string(number.option), numbers_[number.name],
                     fmt::format("{} ({}; without it, {:g})", number.help,
                                 flow::in_words(number.range, number.unit), number.of(usual_)));
}

void SettingArguments::add(cli::Command& command, const flow::SwitchSetting& on) {
  command.add_flag(std::string(on.option), on.of(switched_), std::string(on.help));
}

void SettingArguments::add_filter(cli::Command& command) {
  flow::for_each_filter_setting([&](const auto& setting) {
    if (!setting.option.empty()) add(command, setting);
  });
}

Result<flow::LoopSettings> SettingArguments::parse() const {
  flow::LoopSettings settings = switched_;
  Result<void> fine;
  flow::for_each_setting([&](const auto& setting) {
    if constexpr (requires { setting.named; }) {
      const auto text = texts_.find(setting.name);
      if (!fine || text == texts_.end() || text->second.empty()) return;
      if (const auto chosen = parse_setting(setting, text->second))
        setting.of(settings) = *chosen;
      else
        fine = chosen.error();
    }
  });
  if (fine) fine = parse_brushes(settings);
  flow::for_each_setting([&](const auto& setting) {
    if constexpr (std::is_same_v<decltype(setting), const flow::NumberSetting&>)
      if (fine) fine = parse_number(setting, settings);
  });
  if (!fine) return fine.error();
  return settings;
}

/// The settings have all that is not a number.
Result<void> SettingArguments::parse_number(const flow::NumberSetting& number,
                                            flow::LoopSettings& settings) const {
  const auto found = numbers_.find(number.name);
  if (found == numbers_.end() || !found->second) return {};
  number.of(settings) = *found->second;
  if (!number.range.has(*found->second))
    return Error{Errc::usage, fmt::format("{} {}: use {}", number.option, *found->second,
                                          flow::in_words(number.range, number.unit))};
  if (number.has_effect != nullptr && !number.has_effect(settings))
    return Error{Errc::usage, fmt::format("{} {}: has no effect by itself; add {}", number.option,
                                          *found->second, number.remedy)};
  return {};
}

/// Whoever names a brush and no mode wants type 2, which has brushes.
Result<void> SettingArguments::parse_brushes(flow::LoopSettings& settings) const {
  constexpr const flow::BrushesSetting& brushes = flow::setting::brushes;
  const auto text = texts_.find(brushes.name);
  if (text == texts_.end() || text->second.empty()) return {};
  const auto parsed = flow::parse_brushes(text->second);
  if (!parsed)
    return Error{Errc::usage,
                 fmt::format("{} {}: use {}, or five of them with commas between, thumb to little "
                             "finger",
                             brushes.option, text->second, deform::brush_words())};
  brushes.of(settings) = *parsed;
  if (texts_.at(flow::setting::mode.name).empty()) settings.mode = flow::Mode::type2;
  return {};
}

} // namespace nendo::session
