#include "web/client_commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/flow/setting.hpp>

namespace nendo::web {

namespace {

/// Returns whether the text is `yes` and not `no`; nothing if it is neither.
std::optional<bool> truth_in(std::string_view text, std::string_view yes,
                             std::string_view no) noexcept {
  if (text == yes || text == no) return text == yes;
  return std::nullopt;
}

/// Takes the value of one setting. Returns why it is refused; empty: it was taken.
std::string take(std::string_view name, std::string_view value, NamedSettings& named) {
  std::uint32_t own = 0, bit = 1;
  flow::for_each_setting([&](const auto& setting) {
    if (setting.name == name) own = bit;
    bit <<= 1U;
  });
  if (own == 0) return "there is no setting " + in_quotes(name) + "; message 4 names all settings";
  if ((named.named & own) != 0)
    return std::string(name) + " is there twice; name each setting once";
  named.named |= own;
  const auto set = flow::set_from_text(named.values, name, value);
  return set ? std::string() : set.error().message;
}

/// Reads as many items, and returns whether all of them are finite numbers.
bool read_numbers(ItemReader& words, std::span<double> numbers) noexcept {
  for (double& number : numbers) {
    const auto value = to_finite_number(words.next());
    if (!value) return false;
    number = *value;
  }
  return true;
}

std::optional<flow::Command> wrist_in(ItemReader words) noexcept {
  constexpr double max_norm_error = 0.01; // six decimals for each part are precise enough
  const auto side = side_named(words.next());
  if (!side) return std::nullopt;
  flow::WristMove move;
  move.side = *side;
  if (!read_numbers(words, move.position_m) || !read_numbers(words, move.turn_xyzw) ||
      !words.has_ended())
    return std::nullopt;
  double squared = 0.0;
  for (const double part : move.turn_xyzw)
    squared += part * part;
  const double length = std::sqrt(squared);
  if (!(std::abs(length - 1.0) <= max_norm_error) || !move.is_usable()) return std::nullopt;
  for (double& part : move.turn_xyzw)
    part /= length;
  return move;
}

std::optional<flow::Command> clutch_in(ItemReader words) noexcept {
  const auto side = side_named(words.next());
  const auto finger = words.next();
  const auto holds = truth_in(words.next(), "on", "off");
  if (!side || !holds || !words.has_ended()) return std::nullopt;
  flow::SetClutch clutch{*side, puppet::RigPlayer::all_fingers, *holds};
  if (finger == "all") return clutch;
  clutch.finger = puppet::HandSignal::no_finger;
  if (finger == "wrist") return clutch;
  for (clutch.finger = 0; clutch.finger < hand::finger_count; ++clutch.finger)
    if (finger == name_of(static_cast<hand::Finger>(clutch.finger))) return clutch;
  return std::nullopt;
}

std::optional<flow::Command> mask_in(ItemReader words) noexcept {
  const auto edit = flow::mask_edit_named(words.next());
  if (edit != flow::MaskEdit::hold && edit != flow::MaskEdit::free) return std::nullopt;
  flow::SetMask mask{*edit};
  std::array<double, 1> radius{};
  if (!read_numbers(words, mask.at) || !read_numbers(words, radius)) return std::nullopt;
  mask.radius = radius[0];
  if (!words.has_ended() || !mask.is_usable()) return std::nullopt;
  return mask;
}

std::optional<flow::Command> role_in(ItemReader words) noexcept {
  std::array<double, 1> function{};
  if (!read_numbers(words, function)) return std::nullopt;
  const auto input = puppet::HandSignal::named(words.next());
  const bool exists = function[0] >= 0.0 && function[0] < puppet::Puppet::max_functions &&
                      function[0] == std::floor(function[0]);
  if (!input || !exists || !words.has_ended()) return std::nullopt;
  return flow::SetRole{static_cast<std::uint16_t>(function[0]), *input};
}

// What says more than the name of a row.
std::optional<flow::Command> command_in(std::string_view text) noexcept {
  if (text == "record") return flow::SetRecording{true};
  if (text == "end recording") return flow::SetRecording{false};
  ItemReader words(text, ' ');
  const auto first = words.next();
  if (first == "wrist") return wrist_in(words);
  if (first == "clutch") return clutch_in(words);
  if (first == "role") return role_in(words);
  if (first == "mask") return mask_in(words);
  const auto on = truth_in(words.next(), "on", "off");
  if (!on || !words.has_ended()) return std::nullopt;
  if (first == "symmetry") return flow::SetSymmetry{*on};
  if (first == "wire") return flow::DrawWire{*on};
  if (first == "knife") return flow::DrawWire{*on, flow::Blade::knife};
  return std::nullopt;
}

// Why a text is no command.
std::string_view refusal_of(std::string_view text) noexcept {
  if (text.starts_with("wrist "))
    return "wrist: within 100 m of the stage's middle on each axis, turned by a quaternion of "
           "length 1";
  return "no command of PROTOCOL.md, or a number out of its range";
}

} // namespace

void NamedSettings::apply_to(flow::LoopSettings& settings) const noexcept {
  std::uint32_t bits = named;
  flow::for_each_setting([&](const auto& setting) {
    if ((std::exchange(bits, bits >> 1U) & 1U) != 0) setting.of(settings) = setting.of(values);
  });
}

Result<NamedSettings> parse_named_settings(std::string_view text) {
  NamedSettings named;
  named.values.radius_m.fill(1.0); // usable, also if the text does not name them
  std::string why;
  if (text.empty() || text.ends_with(' '))
    why = "settings: write NAME=VALUE, with single spaces between, as in mode=type2";
  while (why.empty() && !text.empty()) {
    std::string_view value = cut(text, ' ');
    const std::string_view name = cut(value, '=');
    why = take(name, value, named);
  }
  if (!why.empty()) return Error{Errc::bad_input, why};
  if (auto checked = flow::check_ranges(named.values); !checked) return checked.error();
  return named;
}

Result<ClientCommand> parse_command(std::string_view text) {
  const auto* const row = commands::named(text);
  if (row != nullptr && row->is_for_run() && (row->places & commands::on_page) != 0)
    return ClientCommand(row);
  if (std::string_view rest = text; cut(rest, ' ') == "settings") {
    const auto settings = parse_named_settings(rest);
    if (!settings) return settings.error();
    return ClientCommand(*settings);
  }
  const auto command = command_in(text);
  if (!command) return Error{Errc::bad_input, std::string(refusal_of(text))};
  return ClientCommand(*command);
}

Result<FormInput> parse_form_input(std::string_view text) {
  std::string_view value = text;
  const bool is_form = cut(value, '\t') == "form";
  const std::string_view control = cut(value, '\t');
  const auto is_control_character = [](char c) {
    return static_cast<unsigned char>(c) < ' ' || c == '\x7F';
  };
  if (!is_form || control.empty() || std::ranges::any_of(control, is_control_character) ||
      std::ranges::any_of(value, is_control_character))
    return Error{Errc::bad_input, "form: write the id of a control and its value, after tabs"};
  return FormInput{std::string(control), std::string(value)};
}

namespace {

// A test sees that no text of the tables has a quotation mark, a backslash or a "<".
std::string js_text(std::string_view text) {
  return '"' + std::string(text) + '"';
}

std::string modes_of(const flow::SettingText& setting) {
  std::string list = ", modes: [";
  for (std::uint8_t number = 0; number < flow::mode_count; ++number)
    if (const auto mode = static_cast<flow::Mode>(number); setting.works_in(mode))
      list += js_text(name_of(mode)) + ',';
  return list + "]";
}

/// Which values it has, by its kind.
template <class T>
std::string values_of(const flow::ChoiceSetting<T>& choice) {
  return ", choices: " + js_text(choice.choices());
}
std::string values_of(const flow::SwitchSetting&) {
  return ", choices: \"false or true\"";
}
std::string values_of(const flow::BrushesSetting&) {
  return ", choices: " + js_text(deform::brush_words());
}
std::string limits(const flow::Range& range, std::string_view unit) {
  return ", min: " + decimal_text(range.min) + ", max: " + decimal_text(range.max) +
         ", unit: " + js_text(unit);
}
std::string values_of(const flow::FingersSetting& lengths) {
  return limits(lengths.handy, lengths.unit);
}
std::string values_of(const flow::NumberSetting& number) {
  std::string needs;
  if (number.has_effect == flow::setting::is_filtered) needs = ", needs: \"filter\"";
  if (number.has_effect == flow::setting::has_brush) needs = ", needs: \"brushes\"";
  return limits(number.range, number.unit) + needs;
}

std::string_view group_name(commands::Buttons group) noexcept {
  switch (group) {
  case commands::Buttons::hands:
    return "hands";
  case commands::Buttons::model:
    return "model";
  case commands::Buttons::more:
    return "more";
  default:
    return "";
  }
}

} // namespace

std::string page_commands() {
  std::string list = "[";
  for (const commands::Row& row : commands::table()) {
    if ((row.places & commands::on_page) == 0) continue;
    list += "\n  { name: " + js_text(row.name) + ", keys: [";
    for (const std::string_view key : row.keys)
      if (!key.empty()) list += js_text(key) + ',';
    list += "], help: " + js_text(row.help) + ", button: " + js_text(row.button) +
            ", buttonOn: " + js_text(row.button_on.empty() ? row.button : row.button_on) +
            ", group: " + js_text(group_name(row.group)) +
            ", isForRun: " + (row.is_for_run() ? "true" : "false") +
            ", isSetting: " + (row.choose != nullptr ? "true" : "false") + " },";
  }
  return list + "\n]";
}

std::string page_settings() {
  std::string list = "{";
  for (const bool of_fingers : {true, false}) // what fingers do is changed most often
    flow::for_each_setting([&](const auto& setting) {
      using Described = std::decay_t<decltype(setting)>;
      constexpr bool is_of_fingers = std::is_same_v<Described, flow::FingersSetting> ||
                                     std::is_same_v<Described, flow::BrushesSetting>;
      constexpr bool is_mode = std::is_same_v<Described, flow::ChoiceSetting<flow::Mode>>;
      if (setting.option.empty() || is_of_fingers != of_fingers) return;
      const commands::Row* const row = commands::row_changing(setting.name);
      list += "\n  " + std::string(setting.name) + ": { label: " + js_text(setting.label) +
              ", help: " + js_text(setting.tip.empty() ? setting.help : setting.tip) +
              ", command: " + js_text(row != nullptr ? row->name : "") + modes_of(setting) +
              values_of(setting) + ", isOfFingers: " + (is_of_fingers ? "true" : "false");
      if (is_mode) {
        list += ", labels: [";
        for (const std::string_view label : flow::mode_labels)
          list += js_text(label) + ',';
        list += "]";
      }
      list += " },";
    });
  return list + "\n}";
}

std::string page_hints() {
  std::string list = "[";
  for (const auto& [keys, text] : commands::hints)
    list += "\n  { keys: " + js_text(keys) + ", text: " + js_text(text) + " },";
  return list + "\n]";
}

std::string command_states(const commands::Situation& now) {
  std::string lines;
  for (const commands::Row& row : commands::table()) {
    if (!row.is_for_run() || (row.places & commands::on_page) == 0) continue;
    const bool is_hidden = row.is_shown != nullptr && !row.is_shown(now);
    const std::string_view state = row.is_on_in(now) ? "on" : is_hidden ? "hidden" : "off";
    const char* const refusal = row.refusal_in(now);
    if (state == "off" && refusal == nullptr) continue;
    lines.append(row.name).append("\t").append(state).append("\t");
    lines.append(refusal != nullptr ? refusal : "") += '\n';
  }
  return lines;
}

} // namespace nendo::web
