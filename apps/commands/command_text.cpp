#include "commands/command_text.hpp"

#include <variant>

#include <nendo/base/text.hpp>
#include <nendo/flow/setting.hpp>

#include "commands/commands.hpp"

namespace nendo::commands {
namespace {

struct ValueText {
  const flow::LoopSettings& settings;

  template <class T>
  std::string operator()(const flow::ChoiceSetting<T>& choice) const {
    return std::string(choice.name_of(choice.of(settings)));
  }
  std::string operator()(const flow::SwitchSetting& on) const {
    return on.of(settings) ? "true" : "false";
  }
  std::string operator()(const flow::NumberSetting& number) const {
    return decimal_text(number.of(settings));
  }
  std::string operator()(const flow::FingersSetting& fingers) const {
    std::string text;
    for (const double length : fingers.of(settings))
      text += (text.empty() ? "" : ",") + decimal_text(length);
    return text;
  }
  std::string operator()(const flow::BrushesSetting& brushes) const {
    return flow::in_words(brushes.of(settings));
  }
};

std::string switched(bool on) {
  return on ? " on" : " off";
}

template <class Numbers>
std::string numbered(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers)
    text += ' ' + decimal_text(number);
  return text;
}

std::string finger_name(std::uint8_t finger) {
  if (finger < hand::finger_count)
    return std::string(hand::name_of(static_cast<hand::Finger>(finger)));
  return finger == puppet::HandSignal::no_finger ? "wrist" : "all";
}

/// The text of commands whose row does not name all of their data. Others return an empty text.
struct CommandText {
  std::string operator()(const flow::ChangeSettings& change) const {
    return "settings " + text_of(change.settings);
  }
  std::string operator()(const flow::WristMove& move) const {
    return "wrist " + std::string(name_of(move.side)) + numbered(move.position_m) +
           numbered(move.turn_xyzw);
  }
  std::string operator()(const flow::SetRecording& recording) const {
    return recording.on ? "record" : "end recording";
  }
  std::string operator()(const flow::SetClutch& clutch) const {
    return "clutch " + std::string(name_of(clutch.side)) + ' ' + finger_name(clutch.finger) +
           switched(clutch.holds);
  }
  std::string operator()(const flow::SetRole& role) const {
    return "role " + std::to_string(role.function) + ' ' + role.input.name();
  }
  std::string operator()(const flow::SetSymmetry& symmetry) const {
    return "symmetry" + switched(symmetry.on);
  }
  std::string operator()(const flow::SetMask& mask) const {
    const std::string words = "mask " + std::string(name_of(mask.edit));
    const bool has_ball = mask.edit == flow::MaskEdit::hold || mask.edit == flow::MaskEdit::free;
    return has_ball ? words + numbered(mask.at) + ' ' + decimal_text(mask.radius) : words;
  }
  std::string operator()(const flow::SetLayer& layer) const {
    return "layer " + std::to_string(layer.input) + switched(layer.on);
  }
  std::string operator()(const flow::DrawWire& wire) const {
    return (wire.blade == flow::Blade::knife ? "knife" : "wire") + switched(wire.on);
  }
  std::string operator()(const flow::EditPart& edit) const {
    const std::string words = edit.removes ? "remove part" : "copy part";
    return edit.part == deform::no_index ? words : words + ' ' + std::to_string(edit.part);
  }
  std::string operator()(const flow::ChangeModel& change) const {
    return change.source == flow::ModelSource::cut ? "cut" : text_of(flow::asking_for(change));
  }
  std::string operator()(const flow::ChangePuppet& change) const {
    return "puppet " + std::to_string(change.number);
  }
  template <class Other>
  std::string operator()(const Other&) const {
    return {};
  }
};

} // namespace

std::string text_of(const flow::LoopSettings& settings) {
  std::string text;
  flow::for_each_setting([&](const auto& setting) {
    text +=
        (text.empty() ? "" : " ") + std::string(setting.name) + '=' + ValueText{settings}(setting);
  });
  return text;
}

std::string text_of(const flow::Command& command) {
  std::string text = std::visit(CommandText{}, command);
  return text.empty() ? std::string(name_of(command)) : text;
}

} // namespace nendo::commands
