#pragma once
// The kinds of settings: what each has of its own, and how code reaches its value.

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/step.hpp>

namespace nendo::flow {

/// The strings about a setting for messages, files and widgets.
struct SettingText {
  std::string_view name;              ///< in timelines and JSON
  std::string_view option;            ///< the option of the command line; empty: none
  std::string_view words;             ///< its name in messages about a run
  std::string_view label;             ///< beside a widget
  std::string_view help;              ///< the option's help
  StepKind step = StepKind::settings; ///< a change of it alone
};

template <class T>
struct Setting : SettingText {
  T LoopSettings::* member = nullptr;
  T hand::FilterOptions::* filter_member =
      nullptr; ///< a member of LoopSettings::filter, without `member`

  const T& of(const LoopSettings& settings) const noexcept {
    return member != nullptr ? settings.*member : settings.filter.*filter_member;
  }
  T& of(LoopSettings& settings) const noexcept {
    return member != nullptr ? settings.*member : settings.filter.*filter_member;
  }
  // For the description of a filter's setting.
  const T& of(const hand::FilterOptions& filter) const noexcept { return filter.*filter_member; }
  T& of(hand::FilterOptions& filter) const noexcept { return filter.*filter_member; }
};

struct Range {
  double min = 0.0;
  double max = 0.0;

  constexpr bool has(double value) const noexcept { // false for NaN
    return value >= min && value <= max;
  }
  constexpr double nearest(double value) const noexcept { return std::clamp(value, min, max); }
};

using SwitchSetting = Setting<bool>;
/// A choice for each finger, thumb to little finger.
using BrushesSetting = Setting<std::array<deform::Brush, 5>>;
struct NumberSetting : Setting<double> {
  Range range;             ///< the values that a loop accepts
  std::string_view unit{}; ///< empty: it has none
  /// Whether other settings give it an effect; null: it always has one.
  bool (*has_effect)(const LoopSettings& settings) noexcept = nullptr;
  std::string_view remedy{}; ///< an option that gives it an effect, with an example
};
/// A length for each finger, thumb to little finger, in metres on the stage.
struct FingersSetting : Setting<std::array<double, 5>> {
  Range range; ///< the values that a loop accepts
  std::string_view unit{};
  Range handy; ///< that keys and widgets choose from
};
/// One of several, which have names.
template <class T>
struct ChoiceSetting : Setting<T> {
  std::string_view choices; ///< all names for messages, in the order of their numbers
  std::string_view (*name_of)(T choice) noexcept = nullptr;
  std::optional<T> (*named)(std::string_view name) noexcept = nullptr;
};

} // namespace nendo::flow
