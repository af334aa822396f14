#include "forms/setting_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/flow/setting.hpp>
#include <nendo/hand/joints.hpp>

#include "commands/commands.hpp"

namespace nendo::forms {
namespace {

/// Where controls are described.
struct Place {
  Form& form;
  std::uint8_t place;
};

/// Returns what the setting does, the range of its control, and the keys that change it.
std::string help_of(const Place& at, const flow::SettingText& setting,
                    const std::string& range = {}) {
  std::string text(setting.tip.empty() ? setting.help : setting.tip);
  if (!range.empty()) text += "\n" + range;
  for (const commands::Row& row : commands::table())
    if (row.setting == setting.name && (row.places & at.place) != 0)
      text += "\n" + commands::keys_of(row) + ": " + std::string(row.name);
  return text;
}

void describe_one(const Place& at, const flow::SwitchSetting& setting, flow::LoopSettings& chosen) {
  at.form.check(setting.label, help_of(at, setting), setting.of(chosen));
}

void describe_one(const Place& at, const flow::NumberSetting& setting, flow::LoopSettings& chosen) {
  if (setting.has_effect != nullptr && !setting.has_effect(chosen)) return;
  auto value = static_cast<float>(setting.of(chosen));
  const flow::Range range{setting.range.min, std::min(setting.range.max, 20.0)}; // more has no use
  if (at.form.number(setting.label, help_of(at, setting, in_words(range, setting.unit)), value,
                     static_cast<float>(range.min), static_cast<float>(range.max), setting.unit, 2))
    setting.of(chosen) =
        setting.range.nearest(std::round(100.0 * static_cast<double>(value)) / 100.0);
}

template <class T>
void describe_one(const Place& at, const flow::ChoiceSetting<T>& setting,
                  flow::LoopSettings& chosen) {
  T& value = setting.of(chosen);
  auto number = static_cast<std::size_t>(value);
  if constexpr (std::is_same_v<T, deform::Wendland>) {
    std::vector<Form::Choice> choices;
    for (const std::string_view name : setting.names())
      choices.push_back({name.substr(name.find('-') + 1), help_of(at, setting), name});
    at.form.lines_of(choices.size());
    at.form.one_of(setting.label, choices, number);
    at.form.lines_of(1);
  } else { // the second one is what the label says
    static_assert(sizeof(T) == 1);
    bool is_on = number == 1;
    at.form.check(setting.label, help_of(at, setting), is_on);
    number = is_on ? 1 : 0;
  }
  value = static_cast<T>(number);
}

/// Calls describe(label, value) for all fingers together, or for each.
template <class Values, class Describe>
void describe_fingers(const Place& at, const flow::SettingText& setting, bool& is_one,
                      Values& values, const Describe& describe) {
  is_one = is_one && std::ranges::count(values, values[0]) == std::ssize(values);
  for (std::size_t finger = 0; finger < (is_one ? 1 : hand::finger_count); ++finger)
    describe(is_one ? setting.label : name_of(static_cast<hand::Finger>(finger)), values[finger]);
  const std::string label(setting.label);
  at.form.check("one " + label + " for all fingers",
                "All fingers have the same " + label + ", or each its own.", is_one);
  if (is_one) values.fill(values[0]);
}

void describe_radii(const Place& at, const flow::FingersSetting& setting, bool& is_one,
                    flow::LoopSettings& chosen) {
  const flow::Range range{100.0 * setting.handy.min, 100.0 * setting.handy.max};
  describe_fingers(
      at, setting, is_one, setting.of(chosen), [&](std::string_view label, double& radius_m) {
        auto cm = static_cast<float>(100.0 * radius_m);
        if (at.form.number(label, help_of(at, setting, in_words(range, "cm")), cm,
                           static_cast<float>(range.min), static_cast<float>(range.max), "cm", 1))
          radius_m = setting.handy.nearest(static_cast<double>(cm) / 100.0);
      });
}

void describe_brushes(const Place& at, const flow::BrushesSetting& setting, bool& is_one,
                      flow::LoopSettings& chosen) {
  std::vector<Form::Choice> choices;
  std::vector<std::string_view> names;
  for (std::size_t brush = 0; brush < deform::brush_count; ++brush) {
    names.push_back(name_of(static_cast<deform::Brush>(brush)));
    choices.push_back({names.back(), std::string(flow::brush_helps[brush]), names.back()});
  }
  describe_fingers(
      at, setting, is_one, setting.of(chosen), [&](std::string_view label, deform::Brush& brush) {
        auto number = static_cast<std::size_t>(brush);
        if (is_one) {
          at.form.lines_of(3);
          at.form.one_of(label, choices, number);
          at.form.lines_of(1);
        } else {
          at.form.choice(label, choices[number].help + "\n" + help_of(at, setting), names, number);
        }
        brush = static_cast<deform::Brush>(number);
      });
}

} // namespace

void SettingForm::describe_modes(Form& form, flow::LoopSettings& chosen) {
  const std::string keys = "\n" + commands::keys_of(*commands::named("next mode")) + ": next mode";
  std::vector<Form::Choice> choices;
  for (std::size_t at = 0; at < flow::mode_count; ++at)
    choices.push_back({flow::mode_labels[at], std::string(flow::mode_helps[at]) + keys});
  auto mode = static_cast<std::size_t>(chosen.mode);
  form.lines_of(flow::mode_count);
  form.one_of("mode", choices, mode);
  chosen.mode = static_cast<flow::Mode>(mode);
}

void SettingForm::describe(Form& form, flow::LoopSettings& chosen) {
  const Place at{form, place_};
  const auto describe_if = [&](const auto& setting, bool of_fingers) {
    using Described = std::decay_t<decltype(setting)>;
    constexpr bool is_of_fingers = std::is_same_v<Described, flow::FingersSetting> ||
                                   std::is_same_v<Described, flow::BrushesSetting>;
    if (is_of_fingers != of_fingers || setting.option.empty() || !setting.works_in(chosen.mode))
      return;
    if constexpr (std::is_same_v<Described, flow::FingersSetting>) {
      describe_radii(at, setting, one_radius_, chosen);
    } else if constexpr (std::is_same_v<Described, flow::BrushesSetting>) {
      describe_brushes(at, setting, one_brush_, chosen);
    } else if constexpr (!std::is_same_v<Described, flow::ChoiceSetting<flow::Mode>>) {
      describe_one(at, setting, chosen);
    }
  };
  form.lines_of(1);
  for (const bool of_fingers : {true, false}) // what fingers do is changed most often
    flow::for_each_setting([&](const auto& setting) { describe_if(setting, of_fingers); });
}

} // namespace nendo::forms
