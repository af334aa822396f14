// What a CyberGlove's interface unit answers to queries.

#include "units/cyberglove_unit.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nendo::emulator {

using namespace unit;

namespace {

constexpr std::array<std::string_view, 3> model_names{"CyberGlove", "CyberGlove II",
                                                      "CyberGlove III"};

// What the firmware of each model says is not published. Known is that a right glove's text begins
// with CG, by which one host distinguishes the hands, and that hosts look in it for the model's
// name; those that look for the glove's port among others also look for who made it.
constexpr std::array<std::string_view, 3> makers{"Virtual Technologies, Inc.",
                                                 "Immersion Corporation, CyberGlove Systems",
                                                 "CyberGlove Systems LLC"};

std::string information(unsigned model, const PluggedGlove& glove) {
  const std::string sensors = std::to_string(glove.sensors());
  return " \r\n" + std::string(glove.side == Side::right ? "CG" : "LG") + sensors + " " +
         std::string(model_names[model - 1]) + ", " + sensors + " sensors, " +
         std::string(name_of(glove.side)) + " hand\r\n" + std::string(makers[model - 1]) +
         "\r\nemulated by Nendo\r\n";
}

// It is known that there is such a text, but not what it says.
constexpr std::string_view help =
    " \r\n"
    "G one record, S stream, ^C stop, ^I read the glove again, ^R restart\r\n"
    "set: A B C D F J L M N P Q T U W Y; ask: ? and the letter, also G K R S V i\r\n"
    "small letters: numbers in text, and so are the answers\r\n"
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
  Message message{'?', letter};
  if (const auto words = text(letter)) {
    append(message, *words);
  } else if (const auto values = numbers(letter)) {
    // The order of T's bytes is disputed, that of the others is not.
    const bool high_first = letter == 'T' && !options_.period_low_first;
    for (const unsigned value : *values) {
      Message bytes = low_first(value, static_cast<unsigned>(number_width(letter)));
      if (high_first) std::reverse(bytes.begin(), bytes.end());
      message.insert(message.end(), bytes.begin(), bytes.end());
    }
  } else {
    message = {'e', '?'};
  }
  message.push_back(0);
  reply(message);
}

// A small letter asks for the same numbers in text, as decimals. That there are so many of them for
// each letter, is known from a driver for the hardware, and that bytes of masks come lowest first.
// Another one reads the number from the fourth byte of the answer on. The blank before each number,
// and the end of the line, are those of records in text.
std::optional<std::string> CyberGloveUnit::text(Byte letter) const {
  switch (letter) {
  case 'i':
    return information(options_.model, known_);
  case '?':
    return std::string(help);
  case 'c':
    return " \r\n" + calibration_text(settings_, known_.mask);
  default:
    break;
  }
  const auto values =
      is_lower(letter) ? numbers(letter == 'y' ? letter : to_upper(letter)) : std::nullopt;
  if (!values) return std::nullopt;
  std::string line;
  for (const unsigned value : *values)
    line += " " + std::to_string(value);
  return line + "\r\n";
}

std::optional<std::vector<unsigned>> CyberGloveUnit::numbers(Byte letter) const {
  using Numbers = std::vector<unsigned>;
  const auto all = [](const auto& bytes) { return Numbers(bytes.begin(), bytes.end()); };
  switch (letter) {
  case 'A':
    if (!options_.touch) return std::nullopt;
    return all(settings_.vibration);
  case 'B':
    return Numbers{settings_.baud};
  case 'C':
    return all(calibration(settings_, known_.mask));
  case 'G':
    return Numbers{plugged_ ? 3U : 1U}; // initialised, and connected
  case 'K':
    return all(low_first(known_.mask, 3));
  case 'M':
    return all(low_first(settings_.mask, 3));
  case 'N':
    return Numbers{settings_.values};
  case 'P':
    return all(low_first(parameters(), 3));
  case 'R':
    return Numbers{known_.side == Side::right ? 1U : 0U};
  case 'S':
    return Numbers{static_cast<unsigned>(known_.sensors())};
  case 'T':
    return Numbers{settings_.period_ticks, settings_.period_repeats};
  case 'V':
    return Numbers{2, 1}; // of unit and glove; as bytes with zeros, so that hosts must count them
  default:
    break;
  }
  if (const auto state = switch_state(settings_, letter)) return Numbers{*state ? 1U : 0U};
  return std::nullopt;
}

} // namespace nendo::emulator
