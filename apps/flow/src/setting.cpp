#include <nendo/flow/setting.hpp>

#include <charconv>
#include <numeric>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/flow/finger_supports.hpp>
#include <nendo/puppet/rig.hpp>

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

/// Reads the value of a setting by its kind. Returns what can be used if the text is no such value;
/// empty: it was read.
struct ValueReader {
  std::string_view text;
  LoopSettings& settings;

  template <class T>
  std::string operator()(const ChoiceSetting<T>& choice) const {
    const auto named = choice.named(text);
    if (!named) return choice.choices();
    choice.of(settings) = *named;
    return {};
  }
  std::string operator()(const SwitchSetting& on) const {
    if (text != "true" && text != "false") return "true or false";
    on.of(settings) = text == "true";
    return {};
  }
  std::string operator()(const NumberSetting& number) const {
    const auto read = to_finite_number(text);
    if (!read) return "a number";
    number.of(settings) = *read;
    return {};
  }
  std::string operator()(const FingersSetting& fingers) const {
    const bool one_for_all = text.find(',') == std::string_view::npos;
    ItemReader items(text, ',');
    std::array<double, 5> lengths{};
    for (double& length : lengths) {
      const auto read = to_finite_number(one_for_all ? text : items.next());
      if (!read) return several;
      length = *read;
    }
    if (!one_for_all && !items.has_ended()) return several;
    fingers.of(settings) = lengths;
    return {};
  }
  std::string operator()(const BrushesSetting& brushes) const {
    const auto parsed = parse_brushes(text);
    if (!parsed) return deform::brush_words() + ", or five with commas between";
    brushes.of(settings) = *parsed;
    return {};
  }

  static constexpr const char* several = "metres, or five numbers with commas between";
};

std::string shortest_text(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

constexpr std::array<std::string_view, 21> step_names{
    "stroke",   "reset",     "mode",  "kernel", "radius", "folding", "filter",
    "settings", "subdivide", "brush", "puppet", "volume", "hold",    "mask",
    "symmetry", "refine",    "cut",   "join",   "copy",   "remove",  "topology"};
constexpr std::array<std::string_view, 2> pinches_names{"measured", "closed"};

enum class Party : std::uint8_t { mode, hold, brushes, volume, injective, puppet };

bool is_chosen(Party party, const LoopSettings& settings, Played played) noexcept {
  switch (party) {
  case Party::mode:
    return true;
  case Party::hold:
    return settings.hold == Hold::hand;
  case Party::brushes:
    return setting::has_brush(settings);
  case Party::volume:
    return setting::keep_volume.of(settings) > 0.0;
  case Party::injective:
    return settings.injective;
  case Party::puppet:
    return played != Played::nothing;
  }
  return false;
}

std::string words_for(Party party, const LoopSettings& settings, Naming naming) {
  const bool is_option = naming == Naming::options;
  const auto named = [&](const SettingText& setting, std::string_view value = {}) {
    return std::string(is_option ? setting.option : setting.words) + (value.empty() ? "" : " ") +
           std::string(value);
  };
  switch (party) {
  case Party::mode:
    return named(setting::mode, name_of(settings.mode));
  case Party::hold:
    return named(setting::hold, is_option ? name_of(settings.hold) : "");
  case Party::brushes:
    return named(setting::brushes, in_words(settings.brushes));
  case Party::volume:
    return named(setting::keep_volume);
  case Party::injective:
    return named(setting::injective);
  case Party::puppet:
    return is_option ? "--puppet" : "the puppet";
  }
  return {};
}

/// Both are chosen, and the rest of `applies` is true.
struct Exclusion {
  Party one, other;
  bool (*applies)(Mode mode, Played played);
  std::string_view reason;
  bool has_no_effect = true; ///< one of them; otherwise a loop cannot shape with both
};

constexpr bool always(Mode /*mode*/, Played /*played*/) {
  return true;
}
constexpr bool by_hands(Mode mode, Played /*played*/) {
  return is_by_hands(mode);
}
constexpr bool in_type2(Mode mode, Played /*played*/) {
  return mode == Mode::type2;
}
constexpr bool in_another_type(Mode mode, Played /*played*/) {
  return mode != Mode::type2;
}
constexpr bool on_surface(Mode /*mode*/, Played played) {
  return played == Played::along_surface;
}

constexpr std::array exclusions{
    Exclusion{Party::mode, Party::puppet, by_hands,
              "whole hands press clay and move parts, and a puppet has points", false},
    Exclusion{Party::mode, Party::hold, by_hands, "hands hold clay or a part by closing on it"},
    Exclusion{Party::mode, Party::volume, by_hands,
              "clay keeps its volume by itself, and parts move as they are"},
    Exclusion{Party::puppet, Party::hold, always, "a puppet's own points hold the model"},
    Exclusion{Party::puppet, Party::brushes, always,
              "fingertips have brushes, and a puppet's points pull"},
    Exclusion{Party::puppet, Party::injective, always,
              "fold prevention does not cover the surface of a puppet"},
    Exclusion{Party::puppet, Party::volume, on_surface,
              "a puppet's distances go along the surface, where no kernel is known that keeps the "
              "volume, but distance = \"air\" in its file allows both",
              false},
    Exclusion{Party::mode, Party::brushes, in_another_type, "only type 2 has brushes"},
    Exclusion{Party::mode, Party::hold, in_type2, "type 2 needs fingertip paths"},
    Exclusion{Party::hold, Party::volume, always,
              "90 points that keep the volume take longer than a tick"},
    Exclusion{Party::volume, Party::injective, always,
              "moves that keep the volume cannot be split for fold prevention; their steps are so "
              "short that a single finger does not fold the surface"},
};

Result<void> first_exclusion(const LoopSettings& settings, Played played, Naming naming,
                             bool with_effects) {
  const auto* const found =
      std::find_if(exclusions.begin(), exclusions.end(), [&](const Exclusion& one) {
        return (with_effects || !one.has_no_effect) && is_chosen(one.one, settings, played) &&
               is_chosen(one.other, settings, played) && one.applies(settings.mode, played);
      });
  if (found == exclusions.end()) return {};
  return Error{naming == Naming::options ? Errc::usage : Errc::bad_input,
               words_for(found->one, settings, naming) + " cannot be combined with " +
                   words_for(found->other, settings, naming) + ": " + std::string(found->reason) +
                   "; choose one of them"};
}

/// Returns the ratio of the sums of the radii.
double scale_of_radii(const LoopSettings& settings, const LoopSettings& first) noexcept {
  const auto sum = [](const auto& radii) {
    return std::accumulate(radii.begin(), radii.end(), 0.0);
  };
  return sum(settings.radius_m) / sum(first.radius_m);
}

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

Result<void> set_from_text(LoopSettings& settings, std::string_view name, std::string_view value) {
  std::optional<std::string> usable;
  std::vector<std::string_view> names;
  for_each_setting([&](const auto& setting) {
    names.push_back(setting.name);
    if (setting.name == name) usable = ValueReader{value, settings}(setting);
  });
  const std::string shown = printable(name);
  if (!usable)
    return Error{Errc::bad_input, shown + ": no such setting; use " + alternatives(names)};
  if (!usable->empty()) return Error{Errc::bad_input, shown + ": use " + *usable};
  return {};
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

Played played_by(const puppet::Puppet& puppet) noexcept {
  if (!puppet.is_played()) return Played::nothing;
  return puppet.distance == puppet::Distance::surface ? Played::along_surface : Played::through_air;
}

Played played_by(const puppet::Rig* rig) noexcept {
  return rig == nullptr ? Played::nothing : played_by(rig->puppet());
}

Result<void> compatible(const LoopSettings& settings, Played played, Naming naming) {
  return first_exclusion(settings, played, naming, false);
}

Result<void> all_effective(const LoopSettings& settings, Played played, Naming naming) {
  return first_exclusion(settings, played, naming, true);
}

LoopSettings usual_settings() noexcept {
  LoopSettings settings;
  settings.filter.close_pinches = true;
  return settings;
}

LoopSettings plain_settings_of(const SculptorOptions& sculptor) noexcept {
  const deform::DeformerOptions& deformer = sculptor.deformer;
  return {.mode = sculptor.mode,
          .kernel = deformer.csrbf.kernel,
          .injective = deformer.injective.has_value(),
          .brushes = sculptor.brushes,
          .brush_strength = sculptor.brush_strength,
          .keep_volume = deformer.csrbf.keep_volume,
          .hold = sculptor.hold};
}

void set_plain_settings(SculptorOptions& sculptor, const LoopSettings& settings) noexcept {
  sculptor.mode = settings.mode;
  sculptor.hold = settings.hold;
  sculptor.deformer.csrbf.kernel = settings.kernel;
  sculptor.deformer.csrbf.keep_volume = settings.keep_volume;
  sculptor.brushes = settings.brushes;
  sculptor.brush_strength = settings.brush_strength;
}

LoopSettings settings_of(const SculptorOptions& sculptor, const hand::FilterOptions& filter,
                         double units_per_metre) {
  const deform::Supports& supports = sculptor.deformer.supports;
  LoopSettings settings = plain_settings_of(sculptor);
  settings.radius_m = radii_on_stage(supports, units_per_metre);
  settings.piece_fraction = sculptor.piece_length / deform::min_radius(supports);
  settings.filter = filter;
  return settings;
}

deform::Supports scaled(deform::Supports supports, double scale) {
  for (deform::Support& shared : supports.shared)
    shared.radius *= scale;
  for (deform::OwnSupport& own : supports.own)
    own.support.radius *= scale;
  return supports;
}

SculptorSetup with_settings(const SculptorSetup& now, const SculptorSetup& first,
                            const LoopSettings& wanted, int hands, double units_per_metre) {
  if (wanted == first.settings) return first;
  SculptorOptions sculptor = now.options;
  deform::DeformerOptions& deformer = sculptor.deformer;
  set_plain_settings(sculptor, wanted);
  if (hands == 0) sculptor.hold = Hold::fingertips; // a puppet's points hold
  if (wanted.injective != now.settings.injective) {
    deformer.injective.reset();
    if (wanted.injective) deformer.injective.emplace();
  }
  const bool other_radii = wanted.radius_m != now.settings.radius_m;
  if (other_radii && hands == 0) {
    deformer.supports =
        scaled(first.options.deformer.supports, scale_of_radii(wanted, first.settings));
  } else if (other_radii) {
    // Both hands are alike, so that one hand has what two have.
    auto of_hands = supports_of_hands(supports_on_model(wanted.radius_m, units_per_metre), hands);
    if (of_hands && sculptor.mirror)
      of_hands = of_both_sides(*std::move(of_hands), Eigen::Index{5} * hands);
    if (of_hands) deformer.supports = *std::move(of_hands);
  }
  if (other_radii || wanted.piece_fraction != now.settings.piece_fraction)
    sculptor.piece_length = wanted.piece_fraction * deform::min_radius(deformer.supports);
  return {std::move(sculptor), wanted};
}

} // namespace nendo::flow
