// What a CyberGlove's interface unit answers to queries.

#include "units/cyberglove_unit.hpp"

#include <array>
#include <string>
#include <string_view>

namespace nendo::emulator {

using namespace unit;

namespace {

constexpr std::array<std::string_view, 3> model_names{"CyberGlove", "CyberGlove II",
                                                      "CyberGlove III"};

// A right glove's text begins with CG: one known host tells the hands apart by that.
std::string information(unsigned model, const PluggedGlove& glove) {
  const std::string sensors = std::to_string(glove.sensors());
  return " \r\n" + std::string(glove.side == Side::right ? "CG" : "LG") + sensors + " " +
         std::string(model_names[model - 1]) + ", " + sensors + " sensors, " +
         std::string(name_of(glove.side)) + " hand\r\nemulated by Nendo\r\n";
}

// It is known that there is such a text, but not what it says.
constexpr std::string_view help =
    " \r\n"
    "G one record, S stream, ^C stop, ^I read the glove again, ^R restart\r\n"
    "set: A B C D F J L M N P Q T U W Y; ask: ? and the letter, also ?G ?K ?R ?S ?V ?i\r\n"
    "errors: e? unknown, en number, ey sync rate, eg no glove, es sampling rate\r\n";

Message calibration(const Settings& settings, std::uint32_t mask) {
  Message data;
  for (const auto* numbers : {&settings.offsets, &settings.gains}) {
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      if (((mask >> slot) & 1U) != 0) data.push_back((*numbers)[slot]);
    }
  }
  return data;
}

// It is known that there are three lines with a number for each sensor. Chosen: the slots of the
// sensors, their offsets, their gains.
std::string calibration_text(const Settings& settings, std::uint32_t mask) {
  std::string slots;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (((mask >> slot) & 1U) != 0) slots += " " + std::to_string(slot);
  }
  const Message numbers = calibration(settings, mask);
  std::string text = slots + "\r\n";
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    text += " " + std::to_string(numbers[k]);
    if (k + 1 == numbers.size() / 2 || k + 1 == numbers.size()) text += "\r\n";
  }
  return text;
}

} // namespace

std::uint32_t CyberGloveUnit::parameters() const noexcept {
  constexpr std::uint32_t plugged_in = 1U << 0U;
  constexpr std::uint32_t always = 1U << 7U;
  constexpr std::uint32_t right_hand = 1U << 14U;
  constexpr std::uint32_t valid = 1U << 15U;
  constexpr std::uint32_t has_touch = 1U << 17U;
  return writable_parameters(settings_) | always | valid | (plugged_ ? plugged_in : 0) |
         (known_.side == Side::right ? right_hand : 0) | (options_.touch ? has_touch : 0);
}

void CyberGloveUnit::answer(Byte letter) {
  const auto data = lookup(letter);
  if (!data) {
    reply({'e', '?', 0});
    return;
  }
  Message message{'?', letter};
  message.insert(message.end(), data->begin(), data->end());
  message.push_back(0);
  reply(message);
}

std::optional<Message> CyberGloveUnit::lookup(Byte letter) const {
  const auto text = [](std::string_view words) { return Message(words.begin(), words.end()); };
  switch (letter) {
  case 'A':
    if (!options_.touch) return std::nullopt;
    return Message(settings_.vibration.begin(), settings_.vibration.end());
  case 'B':
    return Message{settings_.baud};
  case 'C':
    return calibration(settings_, known_.mask);
  case 'c':
    return text(" \r\n" + calibration_text(settings_, known_.mask));
  case 'G':
    return Message{static_cast<Byte>(plugged_ ? 3 : 1)}; // initialised, and connected
  case 'K':
    return low_first(known_.mask, 3);
  case 'M':
    return low_first(settings_.mask, 3);
  case 'N':
    return Message{settings_.values};
  case 'P':
    return low_first(parameters(), 3);
  case 'R':
    return Message{static_cast<Byte>(known_.side == Side::right ? 1 : 0)};
  case 'S':
    return Message{static_cast<Byte>(known_.sensors())};
  case 'T': {
    Message words;
    for (const std::uint16_t word : {settings_.period_ticks, settings_.period_repeats}) {
      const auto high = static_cast<Byte>(word >> 8U);
      const auto low = static_cast<Byte>(word);
      const bool high_first = options_.period_order == WordOrder::high_first;
      words.push_back(high_first ? high : low);
      words.push_back(high_first ? low : high);
    }
    return words;
  }
  case 'V':
    return Message{2, 0, 1, 0}; // zeros on purpose: hosts must count bytes, not look for NUL
  case 'v':
    return text(" 2.1\r\n");
  case 'i':
    return text(information(options_.model, known_));
  case '?':
    return text(help);
  default:
    break;
  }
  if (const auto state = switch_state(settings_, letter)) {
    return Message{static_cast<Byte>(*state ? 1 : 0)};
  }
  return std::nullopt;
}

} // namespace nendo::emulator
