#include "viewer/setting_controls.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/flow/setting.hpp>
#include <nendo/hand/joints.hpp>

#include "commands/commands.hpp"
#include "viewer/controls.hpp"
#include "viewer/setting_pictures.hpp"

namespace nendo::viewer {
namespace {

/// Returns what the setting does, the range of its widget, and the keys that change it.
std::string help_of(const flow::SettingText& setting, const std::string& range = {}) {
  std::string text(setting.tip.empty() ? setting.help : setting.tip);
  if (!range.empty()) text += "\n" + range + "; drag, double click to type, or ctrl and the wheel";
  for (const commands::Row& row : commands::table())
    if (row.setting == setting.name && (row.places & commands::in_window) != 0)
      text += "\n" + commands::keys_of(row) + ": " + std::string(row.name);
  return text;
}

void draw(const flow::SwitchSetting& setting, flow::LoopSettings& chosen) {
  check(setting.label, setting.of(chosen));
  show_text(help_of(setting));
}

void draw(const flow::NumberSetting& setting, flow::LoopSettings& chosen) {
  if (setting.has_effect != nullptr && !setting.has_effect(chosen)) return;
  auto value = static_cast<float>(setting.of(chosen));
  const flow::Range range{setting.range.min, std::min(setting.range.max, 20.0)}; // more has no use
  const std::string format = "%.2f" + (setting.unit.empty() ? "" : " " + std::string(setting.unit));
  if (number_field(setting.label, value, static_cast<float>(range.min),
                   static_cast<float>(range.max), format.c_str()))
    setting.of(chosen) =
        setting.range.nearest(std::round(100.0 * static_cast<double>(value)) / 100.0);
  show_text(help_of(setting, in_words(range, setting.unit)));
}

template <class T>
void draw(const flow::ChoiceSetting<T>& setting, flow::LoopSettings& chosen) {
  const std::vector<std::string_view> names = setting.names();
  T& value = setting.of(chosen);
  auto at = static_cast<std::size_t>(value);
  if constexpr (std::is_same_v<T, deform::Wendland>) {
    std::vector<Choice> choices;
    for (const std::string_view name : names)
      choices.push_back({name.substr(name.find('-') + 1), help_of(setting)});
    one_of(choices, at, names.size(), draw_kernel);
  } else { // the second one is what the label says
    static_assert(sizeof(T) == 1);
    bool is_on = at == 1;
    check(setting.label, is_on);
    at = is_on ? 1 : 0;
    show_text(help_of(setting));
  }
  value = static_cast<T>(at);
}

/// Calls draw_one(label, value) for all fingers together, or for each.
template <class Values, class DrawOne>
void draw_fingers(const flow::SettingText& setting, bool& is_one, Values& values,
                  const DrawOne& draw_one) {
  for (std::size_t finger = 0; finger < (is_one ? 1 : hand::finger_count); ++finger) {
    ImGui::PushID(setting.name.data());
    draw_one(is_one ? setting.label : name_of(static_cast<hand::Finger>(finger)), values[finger]);
    ImGui::PopID();
  }
  const std::string label(setting.label);
  check("one " + label + " for all fingers", is_one);
  show_text("All fingers have the same " + label + ", or each its own.");
  if (is_one) values.fill(values[0]);
}

void draw_radii(const flow::FingersSetting& setting, bool& is_one, flow::LoopSettings& chosen) {
  const flow::Range range{100.0 * setting.handy.min, 100.0 * setting.handy.max};
  draw_fingers(setting, is_one, setting.of(chosen), [&](std::string_view label, double& radius_m) {
    auto cm = static_cast<float>(100.0 * radius_m);
    if (number_field(label, cm, static_cast<float>(range.min), static_cast<float>(range.max),
                     "%.1f cm"))
      radius_m = setting.handy.nearest(static_cast<double>(cm) / 100.0);
    show_text(help_of(setting, in_words(range, "cm")));
  });
}

void draw_brushes(const flow::BrushesSetting& setting, bool& is_one, flow::LoopSettings& chosen) {
  std::vector<Choice> choices;
  std::vector<std::string_view> names;
  for (std::size_t at = 0; at < deform::brush_count; ++at) {
    names.push_back(name_of(static_cast<deform::Brush>(at)));
    choices.push_back({names.back(), std::string(flow::brush_helps[at])});
  }
  draw_fingers(setting, is_one, setting.of(chosen),
               [&](std::string_view label, deform::Brush& brush) {
                 auto at = static_cast<std::size_t>(brush);
                 if (is_one) {
                   one_of(choices, at, 3, draw_brush);
                 } else {
                   choice_field(label, names, at);
                   show_text(choices[at].help + "\n" + help_of(setting));
                 }
                 brush = static_cast<deform::Brush>(at);
               });
}

} // namespace

void SettingControls::follow(const flow::PendingSettings& pending) noexcept {
  one_radius_ = one_radius_ && pending.has_one_radius();
  one_brush_ = one_brush_ && pending.has_one_brush();
}

void SettingControls::draw_modes(flow::LoopSettings& chosen) {
  const std::string keys = "\n" + commands::keys_of(*commands::named("next mode")) + ": next mode";
  std::vector<Choice> choices;
  for (std::size_t at = 0; at < flow::mode_count; ++at)
    choices.push_back({flow::mode_labels[at], std::string(flow::mode_helps[at]) + keys});
  auto mode = static_cast<std::size_t>(chosen.mode);
  one_of(choices, mode, flow::mode_count);
  chosen.mode = static_cast<flow::Mode>(mode);
}

void SettingControls::draw(flow::LoopSettings& chosen) {
  const auto draw_if = [&](const auto& setting, bool of_fingers) {
    using Described = std::decay_t<decltype(setting)>;
    constexpr bool is_of_fingers = std::is_same_v<Described, flow::FingersSetting> ||
                                   std::is_same_v<Described, flow::BrushesSetting>;
    if (is_of_fingers != of_fingers || setting.option.empty() || !setting.works_in(chosen.mode))
      return;
    if constexpr (std::is_same_v<Described, flow::FingersSetting>) {
      draw_radii(setting, one_radius_, chosen);
    } else if constexpr (std::is_same_v<Described, flow::BrushesSetting>) {
      draw_brushes(setting, one_brush_, chosen);
    } else if constexpr (!std::is_same_v<Described, flow::ChoiceSetting<flow::Mode>>) {
      viewer::draw(setting, chosen);
    }
  };
  for (const bool of_fingers : {true, false}) // what fingers do is changed most often
    flow::for_each_setting([&](const auto& setting) { draw_if(setting, of_fingers); });
}

} // namespace nendo::viewer
