#include "viewer/setting_controls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/flow/setting.hpp>
#include <nendo/hand/joints.hpp>

#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"

namespace nendo::viewer {
namespace {

/// The row of the command table that changes a setting by a key; "": none does.
std::string_view row_of(std::string_view setting) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> rows{
      {{"kernel", "next kernel"},
       {"injective", "folding"},
       {"radius_m", "larger radii"},
       {"brushes", "next brush"},
       {"brush_strength", "stronger brush"},
       {"keep_volume", "more clay"},
       {"hold", "whole hand"},
       {"filter", "filter"}}};
  const auto* const found =
      std::find_if(rows.begin(), rows.end(), [&](const auto& one) { return one.first == setting; });
  return found == rows.end() ? "" : found->second;
}

void show_setting_help(const flow::SettingText& setting) {
  if (const std::string_view row = row_of(setting.name); !row.empty()) {
    show_help(row, setting.help);
  } else {
    show_text(setting.help);
  }
}

/// Returns the names of a list such as "off, mild or strong".
std::vector<std::string_view> names_in(std::string_view list) {
  std::vector<std::string_view> names;
  while (!list.empty()) {
    const std::size_t comma = list.find(", "), last = list.find(" or ");
    const std::size_t end = std::min(comma, last);
    names.push_back(list.substr(0, end));
    if (end == std::string_view::npos) break;
    list.remove_prefix(end + (end == comma ? 2 : 4));
  }
  return names;
}

void draw(const flow::SwitchSetting& setting, flow::LoopSettings& chosen) {
  check(setting.label, setting.of(chosen));
  show_setting_help(setting);
}

void draw(const flow::NumberSetting& setting, flow::LoopSettings& chosen) {
  if (setting.has_effect != nullptr && !setting.has_effect(chosen)) return;
  auto value = static_cast<float>(setting.of(chosen));
  const auto min = static_cast<float>(setting.range.min);
  const auto max = static_cast<float>(std::min(setting.range.max, 20.0)); // larger ones have no use
  if (number_field(setting.label, value, min, max, "%.2f"))
    setting.of(chosen) =
        setting.range.nearest(std::round(100.0 * static_cast<double>(value)) / 100.0);
  show_setting_help(setting);
}

template <class T>
void draw(const flow::ChoiceSetting<T>& setting, flow::LoopSettings& chosen) {
  const std::vector<std::string_view> names = names_in(setting.choices);
  const auto found = std::find(names.begin(), names.end(), setting.name_of(setting.of(chosen)));
  auto at = static_cast<std::size_t>(found - names.begin()) % names.size();
  bool is_changed = false;
  if (names.size() == 2) { // the second one is what the label says
    bool is_on = at == 1;
    is_changed = check(setting.label, is_on);
    at = is_on ? 1 : 0;
  } else {
    is_changed = choice_field(setting.label, names, at);
  }
  if (is_changed)
    if (const auto named = setting.named(names[at])) setting.of(chosen) = *named;
  show_setting_help(setting);
}

/// Calls draw_one(label, index) for all fingers together, or for each.
template <class Values, class DrawOne>
void draw_fingers(const flow::SettingText& setting, bool& is_one, Values& values,
                  const DrawOne& draw_one) {
  for (std::size_t finger = 0; finger < (is_one ? 1 : hand::finger_count); ++finger) {
    ImGui::PushID(setting.name.data());
    draw_one(is_one ? setting.label : name_of(static_cast<hand::Finger>(finger)), values[finger]);
    ImGui::PopID();
    show_setting_help(setting);
  }
  check("one " + std::string(setting.label) + " for all fingers", is_one);
  if (is_one) values.fill(values[0]);
}

void draw_radii(const flow::FingersSetting& setting, bool& is_one, flow::LoopSettings& chosen) {
  draw_fingers(setting, is_one, setting.of(chosen), [&](std::string_view label, double& radius_m) {
    auto cm = static_cast<float>(100.0 * radius_m);
    if (number_field(label, cm, static_cast<float>(100.0 * setting.handy.min),
                     static_cast<float>(100.0 * setting.handy.max), "%.1f cm"))
      radius_m = setting.handy.nearest(static_cast<double>(cm) / 100.0);
  });
}

void draw_brushes(const flow::BrushesSetting& setting, bool& is_one, flow::LoopSettings& chosen) {
  draw_fingers(setting, is_one, setting.of(chosen),
               [](std::string_view label, deform::Brush& brush) {
                 std::array<std::string_view, deform::brush_count> names;
                 for (std::uint8_t at = 0; at < deform::brush_count; ++at)
                   names[at] = name_of(static_cast<deform::Brush>(at));
                 auto at = static_cast<std::size_t>(brush);
                 if (choice_field(label, names, at)) brush = static_cast<deform::Brush>(at);
               });
}

} // namespace

void SettingControls::follow(const flow::PendingSettings& pending) noexcept {
  one_radius_ = one_radius_ && pending.has_one_radius();
  one_brush_ = one_brush_ && pending.has_one_brush();
}

void SettingControls::draw_modes(flow::LoopSettings& chosen) {
  auto mode = static_cast<std::size_t>(chosen.mode);
  if (one_of(flow::mode_labels, mode, flow::mode_count))
    chosen.mode = static_cast<flow::Mode>(mode);
  show_help("next mode", flow::modes_help);
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
