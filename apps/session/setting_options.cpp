#include "session/setting_options.hpp"

#include <type_traits>

namespace nendo::session {

void SettingArguments::add(cli::Command& command, const flow::BrushesSetting& brushes) {
  command.add_option(std::string(brushes.option), texts_[brushes.name], std::string(brushes.help));
}

void SettingArguments::add(cli::Command& command, const flow::NumberSetting& number) {
  command.add_option(std::string(number.option), numbers_[number.name], std::string(number.help));
}

void SettingArguments::add(cli::Command& command, const flow::SwitchSetting& on) {
  command.add_flag(std::string(on.option), on.of(switched_), std::string(on.help));
}

Result<flow::LoopSettings> SettingArguments::parse() const {
  flow::LoopSettings settings = switched_;
  std::optional<Error> wrong;
  flow::for_each_setting([&](const auto& setting) {
    if (wrong) return;
    if constexpr (requires { setting.named; }) {
      const auto text = texts_.find(setting.name);
      if (text == texts_.end() || text->second.empty()) return;
      const auto chosen = parse_setting(setting, text->second);
      if (chosen)
        setting.of(settings) = *chosen;
      else
        wrong = chosen.error();
    } else if constexpr (std::is_same_v<decltype(setting), const flow::NumberSetting&>) {
      const auto number = numbers_.find(setting.name);
      if (number == numbers_.end() || !number->second) return;
      setting.of(settings) = *number->second;
      if (!setting.range.has(*number->second))
        wrong =
            Error{Errc::usage, fmt::format("{} {}: use {} to {}", setting.option, *number->second,
                                           setting.range.min, setting.range.max)};
    }
  });
  if (wrong) return *wrong;
  if (const auto fine = parse_brushes(settings); !fine) return fine.error();
  return settings;
}

/// Whoever names a brush and no mode wants type 2, which has brushes.
Result<void> SettingArguments::parse_brushes(flow::LoopSettings& settings) const {
  constexpr const flow::BrushesSetting& brushes = flow::setting::brushes;
  const auto text = texts_.find(brushes.name);
  const auto strength = numbers_.find(flow::setting::brush_strength.name);
  if (text == texts_.end() || text->second.empty()) {
    if (strength == numbers_.end() || !strength->second) return {};
    return Error{Errc::usage, fmt::format("{}: there is no brush; add --brush, as in "
                                          "--brush inflate",
                                          flow::setting::brush_strength.option)};
  }
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
