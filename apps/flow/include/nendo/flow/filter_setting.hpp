#pragma once
// The description of the settings of both hands' filter (LoopSettings::filter), a part of
// setting.hpp.

#include <optional>
#include <string_view>

#include <nendo/flow/setting_kinds.hpp>
#include <nendo/hand/joint_filter.hpp>

namespace nendo::flow {

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
      StepKind::filter},
     nullptr,
     &hand::FilterOptions::kind},
    "off or one-euro",
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
      StepKind::filter},
     nullptr,
     &hand::FilterOptions::close_pinches},
    "measured or closed",
    name_of_pinches,
    pinches_named};
} // namespace setting

/// Calls see(setting) with the numbers of the filter, in the order of files.
template <class See>
constexpr void for_each_filter_number(const See& see) {
  see(setting::min_cutoff);
  see(setting::beta);
  see(setting::derivative_cutoff);
}

/// Calls see(setting) with each description of LoopSettings::filter. Timelines have none of them:
/// their keys are poses that were filtered.
template <class See>
constexpr void for_each_filter_setting(const See& see) {
  see(setting::filter);
  for_each_filter_number(see);
  see(setting::pinches);
}

} // namespace nendo::flow
