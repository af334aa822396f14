#include "c/setting_text.hpp"

#include <optional>
#include <string>

#include <nendo/base/text.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/setting.hpp>

namespace nendo::c {
namespace {

// Each returns what the value must be, or nothing if it was set.

std::optional<std::string> set(const flow::SwitchSetting& setting, flow::LoopSettings& settings,
                               std::string_view value) {
  if (value != "true" && value != "false") return "true or false";
  setting.of(settings) = value == "true";
  return std::nullopt;
}

std::optional<std::string> set(const flow::NumberSetting& setting, flow::LoopSettings& settings,
                               std::string_view value) {
  const auto number = to_finite_number(value);
  if (!number) return "a number";
  setting.of(settings) = *number;
  return std::nullopt;
}

/// One number for all fingers.
std::optional<std::string> set(const flow::FingersSetting& setting, flow::LoopSettings& settings,
                               std::string_view value) {
  const auto number = to_finite_number(value);
  if (!number) return "a number";
  setting.of(settings).fill(*number);
  return std::nullopt;
}

std::optional<std::string> set(const flow::BrushesSetting& setting, flow::LoopSettings& settings,
                               std::string_view value) {
  const auto brushes = flow::parse_brushes(value);
  if (!brushes) return "one name of a brush, or five with commas between";
  setting.of(settings) = *brushes;
  return std::nullopt;
}

template <class T>
std::optional<std::string> set(const flow::ChoiceSetting<T>& setting, flow::LoopSettings& settings,
                               std::string_view value) {
  const auto choice = setting.named(value);
  if (!choice) return std::string(setting.choices);
  setting.of(settings) = *choice;
  return std::nullopt;
}

} // namespace

Result<void> change(flow::LoopSettings& settings, std::string_view name, std::string_view value) {
  bool is_known = false;
  std::optional<std::string> wanted;
  std::string names;
  flow::for_each_setting([&](const auto& setting) {
    names += (names.empty() ? "" : ", ") + std::string(setting.name);
    if (setting.name != name) return;
    is_known = true;
    wanted = set(setting, settings, value);
  });
  if (!is_known)
    return Error{Errc::usage, std::string(name) + ": no such setting; there are " + names};
  if (wanted) return Error{Errc::usage, std::string(name) + ": use " + *wanted};
  return {};
}

} // namespace nendo::c
