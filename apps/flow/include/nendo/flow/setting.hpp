#pragma once
// The description of each setting: names, range, help. Options, timelines, reports and widgets use
// it through for_each_setting(). Also checks which settings can be combined.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <nendo/base/figures.hpp>
#include <nendo/base/result.hpp>
#include <nendo/deform/brush.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/step.hpp>
#include <nendo/hand/joint_filter.hpp>

namespace nendo::puppet {
struct Puppet;
class Rig;
} // namespace nendo::puppet

namespace nendo::flow {

constexpr std::uint8_t in_mode(Mode mode) noexcept {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(mode));
}
inline constexpr std::uint8_t in_all_modes = (1U << mode_count) - 1U;
/// The modes in windows and on the page, in their order, and what they are.
inline constexpr std::array<std::string_view, mode_count> mode_labels{"Pull", "Strokes", "Clay",
                                                                      "Parts"};
inline constexpr std::array<std::string_view, mode_count> mode_helps{
    "Pull: the surface follows the fingertips from rest.",
    "Strokes: the surface follows the paths of the fingertips, or brushes change it along them.",
    "Clay: whole hands press the surface.", "Parts: a hand that closes takes the part under it."};
/// What each brush does.
inline constexpr std::array<std::string_view, deform::brush_count> brush_helps{
    "Pull: the surface follows the fingertip.",
    "None: the finger does not change the surface.",
    "Push: the surface moves inwards; with volume, it bulges nearby.",
    "Inflate: the surface swells outwards.",
    "Smooth: bumps disappear, and the volume stays.",
    "Flatten: the surface becomes a plane.",
    "Twist: the surface turns about the fingertip.",
    "Scale: the surface grows about the fingertip.",
    "Pinch: the surface gathers under the fingertip."};
inline constexpr std::uint8_t by_points = in_mode(Mode::type1) | in_mode(Mode::type2);

/// The strings of a setting for messages, files and widgets, and where it works.
struct SettingText {
  std::string_view name;              ///< the key in timelines and JSON
  std::string_view option;            ///< the command line option; empty: none
  std::string_view words;             ///< the name in messages of a run
  std::string_view label;             ///< the label of its widget
  std::string_view help;              ///< the option's help
  StepKind step = StepKind::settings; ///< the undo step of changing only this setting
  std::uint8_t modes = in_all_modes;  ///< the modes in which it has an effect, as bits of in_mode()
  std::string_view tip{};             ///< the tooltip of its widget; empty: as `help`

  constexpr bool works_in(Mode mode) const noexcept { return (modes & in_mode(mode)) != 0; }
};

template <class T>
struct Setting : SettingText {
  T LoopSettings::* member = nullptr;
  T hand::FilterOptions::* filter_member =
      nullptr; ///< a member of LoopSettings::filter; used if `member` is null

  const T& of(const LoopSettings& settings) const noexcept {
    return member != nullptr ? settings.*member : settings.filter.*filter_member;
  }
  T& of(LoopSettings& settings) const noexcept {
    return member != nullptr ? settings.*member : settings.filter.*filter_member;
  }
  // For descriptions with filter_member.
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
  std::string_view unit{}; ///< empty: no unit
  /// Whether it has an effect with these settings; null: always.
  bool (*has_effect)(const LoopSettings& settings) noexcept = nullptr;
  std::string_view remedy{}; ///< an option that gives it an effect, with an example
};
/// A length for each finger, thumb to little finger, in metres on the stage.
struct FingersSetting : Setting<std::array<double, 5>> {
  Range range; ///< the values that a loop accepts
  std::string_view unit{};
  Range handy; ///< the range of keys and widgets
};
/// A choice among named values, which are the numbers from 0.
template <class T>
struct ChoiceSetting : Setting<T> {
  std::size_t count = 0; ///< the number of values
  std::string_view (*name_of)(T choice) noexcept = nullptr;
  std::optional<T> (*named)(std::string_view name) noexcept = nullptr;

  /// Returns the names of all values, in their order.
  std::vector<std::string_view> names() const {
    std::vector<std::string_view> all;
    for (std::size_t at = 0; at < count; ++at)
      all.push_back(name_of(static_cast<T>(at)));
    return all;
  }
  /// Returns the same for messages: "off, mild or strong".
  std::string choices() const { return alternatives(names()); }
};

/// Returns "measured" or "closed".
NENDO_API std::string_view name_of_pinches(bool are_closed) noexcept;
NENDO_API std::optional<bool> pinches_named(std::string_view name) noexcept;

namespace setting {

constexpr bool is_filtered(const LoopSettings& settings) noexcept {
  return settings.filter.kind != hand::FilterKind::off;
}

inline constexpr ChoiceSetting<hand::FilterKind> filter{
    {{"filter", "--filter", "smooth hands", "smooth hands",
      "off, or one-euro: smooths the joint angles, at rest more than in motion; the summary shows "
      "the "
      "delay",
      StepKind::filter, in_all_modes, "Smooths the joint angles, at rest more than in motion."},
     nullptr,
     &hand::FilterOptions::kind},
    2,
    hand::name_of,
    hand::filter_named};
inline constexpr NumberSetting min_cutoff{
    {{"min_cutoff_hz", "--filter-min-cutoff", "min cutoff", "cutoff at rest",
      "The filter's cutoff for a joint at rest; a lower one is smoother, with more delay",
      StepKind::filter},
     nullptr,
     &hand::FilterOptions::min_cutoff_hz},
    {0.01, 1000.0}, // wider than any use: below, a hand is minutes late; above, nothing is smoothed
    "Hz",
    is_filtered,
    "--filter one-euro"};
inline constexpr NumberSetting beta{
    {{"beta_hz_per_rad_s", "--filter-beta", "beta", "cutoff in motion",
      "The increase of the cutoff with a joint's speed; a higher one has less delay in motion",
      StepKind::filter},
     nullptr,
     &hand::FilterOptions::beta_hz_per_rad_s},
    {0.0, 1000.0},
    "Hz per rad/s",
    is_filtered,
    "--filter one-euro"};
inline constexpr NumberSetting derivative_cutoff{
    {{"derivative_cutoff_hz", "", "derivative cutoff", "cutoff of the speed", "", StepKind::filter},
     nullptr,
     &hand::FilterOptions::derivative_cutoff_hz},
    {0.01, 1000.0},
    "Hz",
    is_filtered};
inline constexpr ChoiceSetting<bool> pinches{
    {{"pinches", "--pinches", "pinches", "closed pinches",
      "closed: pads of thumb and finger that are nearly together meet, but not in clay; or "
      "measured: they keep the measured distance, to the millimetre",
      StepKind::filter, static_cast<std::uint8_t>(in_all_modes & ~in_mode(Mode::clay)),
      "Pads of thumb and finger that are nearly together meet."},
     nullptr,
     &hand::FilterOptions::close_pinches},
    2,
    name_of_pinches,
    pinches_named};
} // namespace setting

/// Calls see(setting) with each number of the filter, in file order.
template <class See>
constexpr void for_each_filter_number(const See& see) {
  see(setting::min_cutoff);
  see(setting::beta);
  see(setting::derivative_cutoff);
}

/// Calls see(setting) with each description of LoopSettings::filter. Timelines do not have these,
/// because their keys are filtered poses.
template <class See>
constexpr void for_each_filter_setting(const See& see) {
  see(setting::filter);
  for_each_filter_number(see);
  see(setting::pinches);
}

namespace setting {

inline bool has_brush(const LoopSettings& settings) noexcept {
  return !deform::are_all_pull(settings.brushes);
}

inline constexpr ChoiceSetting<Mode> mode{{{"mode", "--mode", "mode", "mode",
                                            "type1 (from rest): the rest shape follows the "
                                            "fingertips; type2 (accumulating): strokes along "
                                            "their paths; clay: whole hands press; parts: closing "
                                            "hands grab and move parts of the model; "
                                            "default: type1, or type2 with a brush",
                                            StepKind::mode},
                                           &LoopSettings::mode},
                                          mode_count,
                                          name_of,
                                          mode_named};
inline constexpr ChoiceSetting<deform::Wendland> kernel{
    {{"kernel", "--kernel", "kernel", "kernel",
      "wendland-c0, wendland-c2, wendland-c4 or wendland-c6", StepKind::kernel, by_points,
      "The kernel: how a fingertip's influence falls off to the radius, from pointed to smooth."},
     &LoopSettings::kernel},
    4,
    deform::name_of,
    deform::wendland_named};
inline constexpr SwitchSetting injective{
    {"injective", "--injective", "never folding", "never folds",
     "Prevent folds: large moves are split so that the surface never folds; points whose paths "
     "cross are kept apart",
     StepKind::folding, by_points},
    &LoopSettings::injective};
inline constexpr FingersSetting radius{
    {{"radius_m", "--radius", "radius", "radius",
      "Radius of a fingertip's influence, in the model's units, or with a unit on the stage, e.g. "
      "3cm; without it, 0.2 of the model's longest side; "
      "or five with commas between, thumb to little finger; 10+40:0.5 is a mix",
      StepKind::radius, by_points, "How far a fingertip's influence reaches."},
     &LoopSettings::radius_m},
    {1e-9, 1e9},
    "m",
    {0.01, 0.4}};
/// The unit is the minimum radius.
inline constexpr NumberSetting piece_fraction{
    {{"piece_fraction", "", "length of a piece", "piece", ""}, &LoopSettings::piece_fraction},
    {1e-3, 1e3}};
inline constexpr BrushesSetting brushes{
    {"brushes", "--brush", "brush", "brush",
     "The effect of a fingertip along its path, in type 2: pull, none, push, inflate, smooth, "
     "flatten, "
     "twist, scale or pinch; or five with commas between, thumb to little finger",
     StepKind::brush, in_mode(Mode::type2), "What a fingertip does to the surface along its path."},
    &LoopSettings::brushes};
inline constexpr NumberSetting brush_strength{
    {{"brush_strength", "--strength", "strength", "strength",
      "The strength of brushes; below 0 their effect is reversed", StepKind::brush,
      in_mode(Mode::type2)},
     &LoopSettings::brush_strength},
    {-1.0, 1.0},
    "",
    has_brush,
    "--brush inflate"};
inline constexpr NumberSetting keep_volume{
    {{"keep_volume", "--keep-volume", "keeping the volume", "volume",
      "0: compressible; 1: volume-preserving, so that pressed-in volume comes out nearby",
      StepKind::volume, by_points},
     &LoopSettings::keep_volume},
    {0.0, 1.0}};
inline constexpr ChoiceSetting<Hold> hold{
    {{"hold", "--hold", "whole hand", "whole hand",
      "The points of a hand that hold the model in type 1: tips, or hand, 45 points of the whole "
      "hand",
      StepKind::hold, in_mode(Mode::type1),
      "Whole hands hold the model, by 45 points each, not only fingertips."},
     &LoopSettings::hold},
    2,
    name_of,
    hold_named};

} // namespace setting

/// Calls see(setting) with each description except those of the filter, in file order.
template <class See>
constexpr void for_each_shape_setting(const See& see) {
  see(setting::mode);
  see(setting::kernel);
  see(setting::injective);
  see(setting::radius);
  see(setting::piece_fraction);
  see(setting::brushes);
  see(setting::brush_strength);
  see(setting::keep_volume);
  see(setting::hold);
}

/// Calls see(setting) with each description.
template <class See>
constexpr void for_each_setting(const See& see) {
  for_each_shape_setting(see);
  for_each_filter_setting(see);
}

/// Calls see(setting) with each setting in SculptorOptions (set_plain_settings()).
template <class See>
constexpr void for_each_plain_setting(const See& see) {
  see(setting::mode);
  see(setting::kernel);
  see(setting::brushes);
  see(setting::brush_strength);
  see(setting::keep_volume);
  see(setting::hold);
}

/// Returns a setting's value for reports: a choice's name, or the value itself. May allocate.
template <class Described>
auto reported_value(const Described& setting, const LoopSettings& settings) {
  if constexpr (requires { setting.name_of; })
    return setting.name_of(setting.of(settings));
  else if constexpr (std::is_same_v<Described, BrushesSetting>)
    return std::string(in_words(setting.of(settings)));
  else
    return setting.of(settings);
}

/// Returns a range for messages: "0.01 to 1000 Hz". Allocates.
NENDO_API std::string in_words(const Range& range, std::string_view unit);
/// Checks that all settings are within their ranges. Error: bad_input, naming the first one that is
/// not, and its range: "keep_volume: use 0 to 1". Allocates.
NENDO_API Result<void> check_ranges(const LoopSettings& settings);
/// Changes the setting of this name. value: true or false, a number, or a name; for all fingers
/// one, or five with commas between, thumb to little finger. Error: bad_input (no such setting, or
/// not its value), which lists what there is. Ranges are for check_ranges(). Allocates.
NENDO_API Result<void> set_from_text(LoopSettings& settings, std::string_view name,
                                     std::string_view value);
/// Returns the settings for messages: "type1, wendland-c2, never folds, radius 13.2 cm (0.248)".
NENDO_API std::string in_words(const LoopSettings& settings, double units_per_metre);

/// The distances of a puppet. `nothing`: no puppet is played; hands touch the model.
enum class Played : std::uint8_t { nothing, through_air, along_surface };

NENDO_API Played played_by(const puppet::Puppet& puppet) noexcept;
/// Does the same; null: nothing is played.
NENDO_API Played played_by(const puppet::Rig* rig) noexcept;

/// How messages name a setting: by its option, or in words.
enum class Naming : std::uint8_t { options, words };

/// Checks that the settings can be combined. Error, in one line: which two exclude each other, why,
/// and a remedy; usage with Naming::options, otherwise bad_input. Allocates.
NENDO_API Result<void> compatible(const LoopSettings& settings, Played played,
                                  Naming naming = Naming::words);
/// Checks the same, and that each setting has an effect. A loop accepts settings without effect, so
/// that users can choose them in any order; on the command line they are an error.
NENDO_API Result<void> all_effective(const LoopSettings& settings, Played played,
                                     Naming naming = Naming::words);

} // namespace nendo::flow
