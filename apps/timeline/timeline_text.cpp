// Writing timelines, and files of them.

#include <algorithm>
#include <array>
#include <cstdio>

#include <nendo/base/endings.hpp>
#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/flow/setting.hpp>

#include "timeline/timeline.hpp"

namespace nendo::timeline {
namespace {

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::string text;
  for (const double value : numbers)
    text += (text.empty() ? "" : ", ") + decimal_text(value);
  return "[" + text + "]";
}

std::string toml_string(std::string_view text) {
  std::string written = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04X", unsigned{byte});
      written += escaped;
      continue;
    }
    if (c == '"' || c == '\\') written += '\\';
    written += c;
  }
  return written + "\"";
}

std::string line(std::string_view name, const std::string& value) {
  return std::string(name) + " = " + value + "\n";
}

std::string supports_text(const deform::Supports& supports, std::string_view of_own) {
  std::string shared;
  for (const auto& support : supports.shared)
    shared += (shared.empty() ? "" : ", ") + list(std::array{support.radius, support.weight});
  std::string own;
  for (const auto& one : supports.own)
    own += (own.empty() ? "{ " : ", { ") + std::string(of_own) + " = " + std::to_string(one.point) +
           ", radius = " + decimal_text(one.support.radius) +
           ", weight = " + decimal_text(one.support.weight) + " }";
  return line("shared", "[" + shared + "]") + line("own", "[" + own + "]");
}

std::string brush_names(const std::array<deform::Brush, 5>& brushes) {
  std::string names;
  for (const deform::Brush brush : brushes)
    names += (names.empty() ? "" : ", ") + toml_string(name_of(brush));
  return "[" + names + "]";
}

/// Returns the value of a setting as a file has it.
struct SettingValue {
  const flow::LoopSettings& settings;

  template <class T>
  std::string operator()(const flow::ChoiceSetting<T>& choice) const {
    return toml_string(choice.name_of(choice.of(settings)));
  }
  std::string operator()(const flow::SwitchSetting& on) const {
    return on.of(settings) ? "true" : "false";
  }
  std::string operator()(const flow::NumberSetting& number) const {
    return decimal_text(number.of(settings));
  }
  std::string operator()(const flow::FingersSetting& lengths) const {
    return list(lengths.of(settings));
  }
  std::string operator()(const flow::BrushesSetting& brushes) const {
    return brush_names(brushes.of(settings));
  }
};

std::string sculptor_text(const flow::SculptorOptions& sculptor, bool is_puppet) {
  const auto& options = sculptor.deformer;
  const flow::LoopSettings settings = flow::plain_settings_of(sculptor);
  const auto set = [value = SettingValue{settings}](const auto& setting) {
    return line(setting.name, value(setting));
  };
  namespace setting = flow::setting;
  std::string text = "\n[sculptor]\n" + set(setting::mode) +
                     line("piece_length", decimal_text(sculptor.piece_length)) +
                     set(setting::brushes) + set(setting::brush_strength) + set(setting::kernel) +
                     line("polynomial", toml_string(name_of(options.csrbf.polynomial))) +
                     line("merge_fraction", decimal_text(options.csrbf.merge_fraction)) +
                     set(setting::keep_volume) + set(setting::hold) +
                     line("weight_bytes", std::to_string(options.evaluation.weight_bytes)) +
                     supports_text(options.supports, is_puppet ? "point" : "tip");
  text += line(rule_of_sculptor(is_puppet), "true");
  if (options.injective)
    text +=
        line("injective", "{ most_bound = " + decimal_text(options.injective->max_bound) +
                              ", most_links = " + std::to_string(options.injective->max_links) +
                              ", least_gap = " + decimal_text(options.injective->min_gap) + " }");
  return text;
}

std::string settings_text(const flow::LoopSettings& settings) {
  std::string text;
  flow::for_each_shape_setting([&](const auto& setting) {
    text += (text.empty() ? "{ " : ", ") + std::string(setting.name) + " = " +
            SettingValue{settings}(setting);
  });
  return text + " }";
}

std::string key_text(const Key& key) {
  std::string angles;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    angles += (at == 0 ? "" : ", ") + std::string(hand::angle_names[at]) + " = " +
              decimal_text(key.angles[hand::angle_at(at)]);
  const Eigen::Quaterniond& turn = key.wrist_turn;
  return "\n[[hands.keys]]\n" + line("time_s", decimal_text(key.time_s)) +
         line("wrist_m", list(std::array{key.wrist_m.x(), key.wrist_m.y(), key.wrist_m.z()})) +
         line("wrist_turn", list(std::array{turn.w(), turn.x(), turn.y(), turn.z()})) +
         line("angles_rad", "{ " + angles + " }");
}

/// Of several lines, as it is if TOML can have it so.
std::string toml_lines(const std::string& text) {
  const bool is_plain = std::ranges::all_of(text, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return c == '\n' || c == '\t' || (byte >= 0x20 && byte != 0x7F);
  });
  if (!is_plain || text.find("'''") != std::string::npos || text.ends_with('\''))
    return toml_string(text);
  return "'''\n" + text + "'''";
}

std::string word(bool truth) {
  return truth ? "true" : "false";
}

std::string puppet_text(const puppet::Rig& rig, const puppet::RigState& state) {
  const puppet::Puppet& puppet = rig.puppet();
  std::string functions;
  for (std::size_t at = 0; at < puppet.functions.size(); ++at) {
    const puppet::FunctionState& function = state.functions[at];
    functions += "  { name = " + toml_string(puppet.functions[at].name) +
                 ", input = " + toml_string(function.input.name()) +
                 ", asked = " + decimal_text(function.asked) + ", held = " + word(function.held) +
                 " },\n";
  }
  std::string starts;
  for (std::size_t at = 0; at < puppet.points.size(); ++at)
    starts += line(puppet.points[at].name, list(rig.starts().col(static_cast<Eigen::Index>(at))));
  return "\n[puppet]\n" + line("symmetric", word(state.symmetric)) + "functions = [\n" + functions +
         "]\n" + line("text", toml_lines(puppet.text)) + "\n[puppet.starts]\n" + starts;
}

std::string clutch_text(const flow::SetClutch& clutch) {
  return "{ hand = " + toml_string(name_of(clutch.side)) +
         ", finger = " + toml_string(clutched_name(clutch.finger)) +
         ", holds = " + word(clutch.holds) + " }";
}

/// The strings of all masks, by their numbers.
std::string masks_text(const Timeline& timeline) {
  if (timeline.masks.empty()) return {};
  std::string lines;
  for (const auto& masks : timeline.masks)
    lines += "  " + (masks ? toml_lines(masks->puppet().text) : std::string("\"\"")) + ",\n";
  return "masks = [\n" + lines + "]\n";
}

/// The places of all wires, by their numbers.
std::string wires_text(const Timeline& timeline) {
  if (timeline.wires.empty()) return {};
  std::string lines;
  for (const auto& wire : timeline.wires) {
    lines += "  [\n";
    for (const deform::WirePlace& place : wire) {
      Eigen::Matrix<double, 6, 1> ends;
      ends << place.from, place.to;
      lines += "    " + list(ends) + ",\n";
    }
    lines += "  ],\n";
  }
  return "wires = [\n" + lines + "]\n";
}

std::string event_text(const Timeline& timeline, const Event& event) {
  const flow::Command& command = event.command;
  if (const auto* change = std::get_if<flow::ChangeSettings>(&command))
    return "settings = " + settings_text(change->settings);
  if (const auto* clutch = std::get_if<flow::SetClutch>(&command))
    return "clutch = " + clutch_text(*clutch);
  if (const auto* role = std::get_if<flow::SetRole>(&command))
    return "role = { function = " +
           toml_string(timeline.rig->puppet().functions[role->function].name) +
           ", input = " + toml_string(role->input.name()) + " }";
  if (const auto* change = std::get_if<flow::ChangePuppet>(&command))
    return "masks = " + std::to_string(change->number);
  if (const auto* symmetry = std::get_if<flow::SetSymmetry>(&command))
    return "symmetric = " + word(symmetry->on);
  if (const auto* refine = std::get_if<flow::Refine>(&command))
    return "refine = " + std::to_string(refine->max_vertices);
  if (const auto* change = std::get_if<flow::ChangeModel>(&command))
    return "cut = " + std::to_string(change->number);
  if (const auto* join = std::get_if<flow::JoinParts>(&command))
    return "join = " + decimal_text(join->seam_width);
  if (const auto* edit = std::get_if<flow::EditPart>(&command))
    return (edit->removes ? "remove_part = " : "copy_part = ") + std::to_string(edit->part);
  return "request = " + toml_string(in_words(timeline, event));
}

std::string head_text(const Timeline& timeline) {
  std::string events;
  for (const Event& event : timeline.events)
    events +=
        "  { time_s = " + decimal_text(event.time_s) + ", " + event_text(timeline, event) + " },\n";
  return "# Key poses of hands over a model; `nendo edit` works on it, and so does a text "
         "editor.\n" +
         line("version", "1") + line("take", toml_string(timeline.take)) +
         line("units_per_metre", decimal_text(timeline.units_per_metre)) +
         line("rate_hz", decimal_text(timeline.rate_hz)) +
         line("duration_s", decimal_text(timeline.duration_s)) + line("held", word(timeline.held)) +
         line(pull_rule, "true") + masks_text(timeline) + wires_text(timeline) + "events = [\n" +
         events + "]\n" + "\n[model]\n" + line("file", toml_string(timeline.mesh)) +
         line("vertices", std::to_string(timeline.mesh_sum.vertices)) +
         line("crc32c", std::to_string(timeline.mesh_sum.crc));
}

/// Empty for an average hand.
std::string shape_text(const hand::WearerShape& shape) {
  if (shape.is_average()) return {};
  return line("shape", list(shape.terms));
}

} // namespace

Result<std::string> timeline_text(const Timeline& timeline) {
  const auto failed = [](const std::string& what) { return Error{Errc::failed, what}; };
  if (std::string wrong = complaint_about(timeline); !wrong.empty()) return failed(wrong);
  if (!is_utf8(timeline.mesh) || !is_utf8(timeline.take))
    return failed("the name of the model's or the take's file is no UTF-8; rename it");
  const bool is_puppet = timeline.rig != nullptr;
  std::string text = head_text(timeline) + sculptor_text(timeline.sculptor, is_puppet);
  if (is_puppet) text += puppet_text(*timeline.rig, timeline.rig_state);
  for (const HandTrack& hand : timeline.hands) {
    text += "\n[[hands]]\n" + line("side", toml_string(name_of(hand.side))) +
            line("length_m", decimal_text(hand.size.length_m)) +
            line("breadth_m", decimal_text(hand.size.breadth_m)) + shape_text(hand.size.shape);
    for (const Key& key : hand.keys) {
      text += key_text(key);
      if (text.size() > max_file_bytes)
        return failed("so many keys are too much for a file; make it with a greater --tolerance");
    }
  }
  return text;
}

Result<Timeline> read_timeline(const std::filesystem::path& path) {
  const auto text = read_file(path, max_file_bytes, "timeline");
  if (!text) return text.error();
  return parse_timeline(*text, path.string());
}

Result<void> write_timeline(const std::filesystem::path& path, const Timeline& timeline) {
  const auto text = timeline_text(timeline);
  if (!text) return Error{text.error().code, path.string() + ": " + text.error().message};
  return replace_file(path, *text);
}

bool is_timeline(const std::filesystem::path& path) {
  return ends_in(path.filename().string(), file_ending);
}

} // namespace nendo::timeline
