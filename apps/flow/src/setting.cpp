#include <nendo/flow/setting.hpp>

#include <algorithm>
#include <array>
#include <charconv>
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

std::string shortest_text(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

constexpr std::array<std::string_view, 21> step_names{
    "stroke",   "reset",     "mode",  "kernel", "radius", "folding", "filter",
    "settings", "subdivide", "brush", "puppet", "volume", "hold",    "mask",
    "symmetry", "refine",    "cut",   "join",   "copy",   "remove",  "topology"};
constexpr std::array<std::string_view, 2> pinches_names{"measured", "closed"};

} // namespace

std::string_view name_of_pinches(bool are_closed) noexcept {
  return pinches_names[are_closed ? 1 : 0];
}

std::optional<bool> pinches_named(std::string_view name) noexcept {
  if (name == pinches_names[0]) return false;
  if (name == pinches_names[1]) return true;
  return std::nullopt;
}

std::string in_words(const Range& range, std::string_view unit) {
  return shortest_text(range.min) + " to " + shortest_text(range.max) + (unit.empty() ? "" : " ") +
         std::string(unit);
}

bool LoopSettings::are_usable() const noexcept {
  bool usable = true;
  for_each_setting([&](const auto& setting) { usable = usable && is_in_range(setting, *this); });
  return usable;
}

Result<void> check_ranges(const LoopSettings& settings) {
  Result<void> fine;
  for_each_setting([&](const auto& setting) {
    if constexpr (requires { setting.range; })
      if (fine && !is_in_range(setting, settings))
        fine = Error{Errc::bad_input,
                     std::string(setting.name) + ": use " + in_words(setting.range, setting.unit)};
  });
  return fine;
}

std::string in_words(const LoopSettings& settings, double units_per_metre) {
  std::string words(name_of(settings.mode));
  const auto add = [&](const std::string& more) { words += ", " + more; };
  if (settings.hold == Hold::hand) add(std::string(setting::hold.words));
  if (settings.mode == Mode::type2 && setting::has_brush(settings))
    add(in_words(settings.brushes) + " at strength " + shortest_text(settings.brush_strength));
  add(std::string(deform::name_of(settings.kernel)));
  if (settings.keep_volume > 0.0)
    add(shortest_text(settings.keep_volume) + " of clay");
  else if (!is_by_hands(settings.mode))
    add(settings.injective ? std::string(setting::injective.label) : "may fold");
  add("radius " + radius_text(settings.radius_m, units_per_metre));
  return words;
}

std::string_view name_of(StepKind kind) noexcept {
  return step_names[static_cast<std::size_t>(kind)];
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
