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

namespace {

std::optional<PointerInput> pointer_in(std::string_view text) noexcept {
  constexpr std::array<std::string_view, 6> events{"size", "leave", "move", "down", "drag", "up"};
  const auto* const event = std::ranges::find(events, cut(text, '\t'));
  ItemReader words(text, ' ');
  std::array<double, 5> numbers{};
  if (event == events.end() || !read_numbers(words, numbers) || !words.has_ended())
    return std::nullopt;
  for (double& number : numbers)
    number = std::clamp(number, -PointerInput::max_number, PointerInput::max_number);
  return PointerInput{static_cast<PointerInput::Event>(event - events.begin()),
                      numbers[0],
                      numbers[1],
                      numbers[2],
                      numbers[3],
                      numbers[4] != 0.0};
}

double limited_sum(double a, double b) noexcept {
  return std::clamp(a + b, -PointerInput::max_number, PointerInput::max_number);
}

} // namespace

bool FormInput::take_in(const FormInput& next) {
  using Event = PointerInput::Event;
  if (control != next.control || form != next.form ||
      pointer.has_value() != next.pointer.has_value())
    return false;
  if (!pointer) {
    if (next.value.empty()) return false; // two presses of a button
    value = next.value;
    return true;
  }
  const Event event = pointer->event;
  if (event != next.pointer->event || event == Event::down || event == Event::up) return false;
  const PointerInput before = *std::exchange(pointer, next.pointer);
  pointer->panned = limited_sum(before.panned, pointer->panned);
  pointer->wheel = limited_sum(before.wheel, pointer->wheel);
  return true;
}

Result<FormInput> parse_form_input(std::string_view text) {
  std::string_view value = text;
  const std::string_view form = cut(value, '\t');
  const std::string_view control = cut(value, '\t');
  const auto is_control_character = [](char c) {
    return static_cast<unsigned char>(c) < ' ' || c == '\x7F';
  };
  const bool is_panel = form == "panel";
  const auto pointer = pointer_in(value);
  if (pointer) value = {};
  if ((!is_panel && form != "form") || control.empty() ||
      std::ranges::any_of(control, is_control_character) ||
      std::ranges::any_of(value, is_control_character))
    return Error{Errc::bad_input,
                 "form: write form or panel, the id of a control and its value, after tabs"};
  return FormInput{std::string(control), std::string(value),
                   is_panel ? FormKind::run : FormKind::screen, pointer};
}

namespace {

// A test sees that no help has a quotation mark, a backslash or a "<". A button may have a "<",
// which ends no script.
std::string js_text(std::string_view text) {
  return '"' + std::string(text) + '"';
}

const char* js_truth(bool is_true) noexcept {
  return is_true ? "true" : "false";
}

} // namespace

std::string page_commands() {
  std::string list = "[";
  for (const commands::Row& row : commands::table()) {
    const bool in_run = (row.places & commands::on_page) != 0;
    if (!in_run && !row.edit) continue;
    list += "\n  { name: " + js_text(row.name) + ", keys: [";
    for (const std::string_view key : row.keys)
      if (!key.empty()) list += js_text(key) + ',';
    list += "], help: " + js_text(row.help) + ", button: " + js_text(row.button) +
            ", isForRun: " + js_truth(row.is_for_run()) +
            ", isEdit: " + js_truth(row.edit.has_value()) + ", inRun: " + js_truth(in_run) +
            ", inTimeline: " + js_truth((row.places & commands::in_timeline) != 0) +
            ", repeats: " + js_truth(row.repeats) + " },";
  }
  return list + "\n]";
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
