#include <nendo/flow/setting.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <nendo/flow/finger_supports.hpp>

namespace nendo::flow {
namespace {

template <class T>
bool is_in_range(const Setting<T>& /*setting*/, const LoopSettings& /*settings*/) noexcept {
  return true;
}
bool is_in_range(const NumberSetting& number, const LoopSettings& settings) noexcept {
  return number.range.has(number.of(settings));
}
bool is_in_range(const FingersSetting& fingers, const LoopSettings& settings) noexcept {
  const auto& lengths = fingers.of(settings);
  return std::all_of(lengths.begin(), lengths.end(),
                     [&](double length) { return fingers.range.has(length); });
}
bool is_in_range(const FilterSetting& filter, const LoopSettings& settings) noexcept {
  const hand::FilterOptions& options = filter.of(settings);
  return std::isfinite(options.min_cutoff_hz) && std::isfinite(options.beta_hz_per_rad_s) &&
         std::isfinite(options.derivative_cutoff_hz);
}

std::string shortest_text(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string range_words(const SettingText& /*setting*/) {
  return " must be finite";
}
template <class Ranged>
  requires requires(const Ranged& ranged) { ranged.range; }
std::string range_words(const Ranged& ranged) {
  return " must lie within " + shortest_text(ranged.range.min) + " and " +
         shortest_text(ranged.range.max);
}

} // namespace

bool LoopSettings::are_usable() const noexcept {
  bool usable = true;
  for_each_setting([&](const auto& setting) { usable = usable && is_in_range(setting, *this); });
  return usable;
}

std::string complaint_about(const LoopSettings& settings) {
  std::string complaint;
  for_each_setting([&](const auto& setting) {
    if (complaint.empty() && !is_in_range(setting, settings))
      complaint = std::string(setting.name) + range_words(setting);
  });
  return complaint;
}

std::string in_words(const LoopSettings& settings, double units_per_metre) {
  std::string words(name_of(settings.mode));
  const auto add = [&](const std::string& more) { words += ", " + more; };
  if (settings.hold == Hold::hand) add(std::string(setting::hold.words));
  if (settings.mode == Mode::type2 && !deform::are_all_pull(settings.brushes))
    add(in_words(settings.brushes) + " at strength " + shortest_text(settings.brush_strength));
  add(std::string(deform::name_of(settings.kernel)));
  if (settings.keep_volume > 0.0)
    add(shortest_text(settings.keep_volume) + " of clay");
  else if (!is_by_hands(settings.mode))
    add(settings.injective ? std::string(setting::injective.label) : "may fold");
  add("radius " + radius_text(settings.radius_m, units_per_metre));
  return words;
}

StepKind kind_of_change(const LoopSettings& before, const LoopSettings& after) noexcept {
  std::optional<StepKind> kind;
  for_each_setting([&](const auto& setting) {
    if (setting.of(before) == setting.of(after)) return;
    kind = kind && *kind != setting.step ? StepKind::settings : setting.step;
  });
  return kind.value_or(StepKind::mode);
}

} // namespace nendo::flow
