#pragma once
// The one description of each setting: names, range, help. Options, timelines, reports and widgets
// are made from it by for_each_setting().

#include <string>
#include <string_view>
#include <type_traits>

#include <nendo/base/result.hpp>
#include <nendo/deform/brush.hpp>
#include <nendo/flow/filter_setting.hpp>
#include <nendo/flow/setting_kinds.hpp>

namespace nendo::flow {

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
                                          mode_names,
                                          name_of,
                                          mode_named};
inline constexpr ChoiceSetting<deform::Wendland> kernel{
    {{"kernel", "--kernel", "kernel", "kernel",
      "wendland-c0, wendland-c2, wendland-c4 or wendland-c6", StepKind::kernel},
     &LoopSettings::kernel},
    "wendland-c0, wendland-c2, wendland-c4 or wendland-c6",
    deform::name_of,
    deform::wendland_named};
inline constexpr SwitchSetting injective{
    {"injective", "--injective", "never folding", "never folds",
     "Prevent folds: large moves are split so that the surface never folds; points whose paths "
     "cross are kept apart",
     StepKind::folding},
    &LoopSettings::injective};
inline constexpr FingersSetting radius{
    {{"radius_m", "--radius", "radius", "radius",
      "Radius of a fingertip's influence, in the model's units, or with a unit on the stage, e.g. "
      "3cm; without it, 0.2 of the model's longest side; "
      "or five with commas between, thumb to little finger; 10+40:0.5 is a mix",
      StepKind::radius},
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
     StepKind::brush},
    &LoopSettings::brushes};
inline constexpr NumberSetting brush_strength{
    {{"brush_strength", "--strength", "strength", "strength",
      "The strength of brushes; below 0 their effect is reversed", StepKind::brush},
     &LoopSettings::brush_strength},
    {-1.0, 1.0},
    "",
    has_brush,
    "--brush inflate"};
inline constexpr NumberSetting keep_volume{
    {{"keep_volume", "--keep-volume", "keeping the volume", "volume",
      "0: compressible; 1: volume-preserving, so that pressed-in volume comes out nearby",
      StepKind::volume},
     &LoopSettings::keep_volume},
    {0.0, 1.0}};
inline constexpr ChoiceSetting<Hold> hold{
    {{"hold", "--hold", "whole hand", "whole hand",
      "The points of a hand that hold the model in type 1: tips, or hand, 45 points of the whole "
      "hand",
      StepKind::hold},
     &LoopSettings::hold},
    "tips or hand",
    name_of,
    hold_named};

} // namespace setting

/// Calls see(setting) with each description but those of the filter, in the order of files.
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

/// Calls see(setting) with each setting that SculptorOptions have (set_plain_settings()).
template <class See>
constexpr void for_each_plain_setting(const See& see) {
  see(setting::mode);
  see(setting::kernel);
  see(setting::brushes);
  see(setting::brush_strength);
  see(setting::keep_volume);
  see(setting::hold);
}

/// Returns the value of a setting as reports have it: names of choices, or else the value itself.
/// May allocate.
template <class Described>
auto reported_value(const Described& setting, const LoopSettings& settings) {
  if constexpr (requires { setting.name_of; })
    return setting.name_of(setting.of(settings));
  else if constexpr (std::is_same_v<Described, BrushesSetting>)
    return std::string(in_words(setting.of(settings)));
  else
    return setting.of(settings);
}

/// Returns a range as messages show it: "0.01 to 1000 Hz". Allocates.
NENDO_API std::string in_words(const Range& range, std::string_view unit);
/// Checks that a loop takes all of these. Error: bad_input, naming the first that is out of its
/// range, and the range: "keep_volume: use 0 to 1". Allocates.
NENDO_API Result<void> check_ranges(const LoopSettings& settings);
/// Returns their description for messages: "type1, wendland-c2, never folds, radius 13.2 cm
/// (0.248)".
NENDO_API std::string in_words(const LoopSettings& settings, double units_per_metre);

} // namespace nendo::flow
