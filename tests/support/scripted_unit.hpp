#pragma once
// A CyberGlove's interface unit with the commands that a driver uses, written in the simplest way
// from the published facts. It knows nothing of the code under test.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace nendo::test {

enum class Manner { good, silent, babbling, modem, no_glove };

struct Script {
  Manner manner = Manner::good;
  unsigned sensors = 22; // 22 or 18
  bool right = true;
  bool knows_options = true; // D and U
  bool knows_all = false;    // every command, not just the old ones
  bool knows_rate = true;    // ?T and t
  bool third = false;        // and those of a CyberGlove III
  bool cybertouch = false;
  unsigned swap_after = 0;    // records after which it is a glove of 18 sensors; 0: never
  bool long_replies = false;  // set replies of three bytes, as the vendor's library expects them
  bool low_first = true;      // the words of ?T
  unsigned fastest_hz = 1000; // a shorter period is answered by es
  std::string never_answered; // letters of queries
  std::string waiting;        // sent before the host says anything
  bool streaming = false;     // from the start
  unsigned baud = 0;          // the only one at which it hears and is heard; 0: any
};

/// Makes a unit's answers, and the records that it streams. Value k of a record is 10 + k.
class ScriptedUnit {
public:
  explicit ScriptedUnit(const Script& script)
      : streaming(script.streaming), script_(script), sensors_(script.sensors) {}

  /// Obeys and removes the first command of `input`; keeps it if it is incomplete.
  std::string answer(std::string_view& input) {
    const char command = input.front();
    if (streaming && command != '\x03') return skip(input, 1), std::string{};
    const std::size_t size = size_of(input);
    if (size > input.size()) {
      held = input;
      input = {};
      return {};
    }
    const std::string_view whole = input.substr(0, size);
    heard += whole;
    skip(input, size);
    return handle(whole);
  }

  std::string record() {
    if (++records_ == script_.swap_after) sensors_ = 18;
    std::string bytes = is_on('Y') ? "Y" : "S";
    for (unsigned k = 0; k < sent(); ++k)
      bytes.push_back(static_cast<char>(10 + k));
    if (is_on('D')) bytes += stamp(0x00010002U + (records_ - 1) * period_[0] * period_[1]);
    if (is_on('U')) bytes += '\x87';
    if (unplugged) bytes += "eg";
    bytes.push_back('\0');
    return bytes;
  }

  bool streaming;
  bool unplugged = false;
  std::string held;  // a command whose argument has not arrived
  std::string heard; // every whole command

private:
  static void skip(std::string_view& input, std::size_t count) { input.remove_prefix(count); }
  static bool is_switch(char letter) {
    return std::string_view("DFJLQUWY").find(letter) != std::string_view::npos;
  }
  bool is_on(char letter) const { return switches_[static_cast<unsigned char>(letter)]; }
  bool knows(char letter) const {
    if (letter == 'D' || letter == 'U') return script_.knows_options;
    if (letter == 't') return script_.knows_rate;
    return script_.knows_all;
  }

  std::size_t size_of(std::string_view input) const {
    const auto byte = [&](std::size_t at) {
      return at < input.size() ? static_cast<unsigned char>(input[at]) : 0U;
    };
    const char letter = input.front();
    if (letter == '?') return 2;
    if (letter == '1' && script_.third) return byte(1) == 'S' ? 2 : 3;
    if (!knows(letter)) return 1; // what follows is taken for other commands
    if (is_switch(letter) || letter == 'N' || letter == 'B') return 2;
    if (letter == 'M' || letter == 'P') return 4;
    if (letter == 'A') return byte(1) == 0xFF ? 8 : 2 + 2 * byte(1);
    if (letter == 't') return std::min(input.find('\r'), input.size()) + 1;
    return 1;
  }

  std::string handle(std::string_view whole) {
    const char letter = whole.front();
    switch (letter) {
    case '\x09':
    case '\x03':
      streaming = streaming && letter != '\x03';
      return {letter, '\0'};
    case '?':
      return script_.never_answered.find(whole[1]) == std::string::npos ? query(whole[1]) : "";
    case 'S':
      streaming = true;
      return {};
    case '1':
      if (!script_.third) return unknown();
      streaming = whole[1] == 'S';
      return streaming ? std::string{} : std::string(whole) + '\0';
    default:
      return knows(letter) ? set(letter, whole.substr(1)) : unknown();
    }
  }

  std::string set(char letter, std::string_view argument) {
    if (is_switch(letter)) switches_[static_cast<unsigned char>(letter)] = argument[0] != '\0';
    if (letter == 'M') mask_ = argument;
    if (letter == 'N') values_ = argument;
    if (letter == 't') {
      unsigned ticks = 0;
      unsigned times = 0;
      if (std::sscanf(std::string(argument).c_str(), "%u %u", &ticks, &times) != 2)
        return {'e', 'n', '\0'};
      if (ticks * times < 115200U / script_.fastest_hz) return {'e', 's', '\0'};
      period_ = {ticks, times};
    }
    return script_.long_replies ? std::string{letter, '\x01', '\0'} : std::string{letter, '\0'};
  }

  std::string_view hardware() const { return sensors_ == 22 ? "\x7F\xFF\x7F" : "\x3F\xBB\x7B"; }
  unsigned sent() const {
    unsigned count = 0;
    for (std::size_t k = 0; k < 3; ++k)
      count += static_cast<unsigned>(
          std::popcount(static_cast<unsigned char>(hardware()[k] & mask_[k])));
    return std::min<unsigned>(count, static_cast<unsigned char>(values_[0]));
  }

  // Bit k of the first byte: byte k was 0 and is sent as 1. Bit 7 is always set (manual).
  static std::string stamp(unsigned ticks) {
    std::string bytes = "\x80";
    for (unsigned k = 0; k < 4; ++k) {
      const auto byte = static_cast<char>(ticks >> 8U * k);
      bytes.push_back(byte == '\0' ? '\x01' : byte);
      if (byte == '\0') bytes[0] = static_cast<char>(bytes[0] | 1 << k);
    }
    return bytes;
  }

  static std::string unknown() { return {'e', '?', '\0'}; }
  static std::string reply(char letter, std::string_view data) {
    std::string bytes{'?', letter};
    bytes += data;
    bytes.push_back('\0');
    return bytes;
  }
  std::string word(unsigned value) const {
    const char low = static_cast<char>(value & 0xFFU);
    const char high = static_cast<char>(value >> 8U);
    return script_.low_first ? std::string{low, high} : std::string{high, low};
  }
  std::string parameters() const {
    const auto bit = [&](char letter, unsigned at) { return is_on(letter) ? 1U << at : 0U; };
    const unsigned first = 0x81U | bit('W', 1) | bit('L', 2);
    const unsigned second = bit('Y', 0) | bit('U', 2) | bit('J', 3) | bit('F', 4) | bit('D', 5) |
                            (script_.right ? 0x40U : 0U) | 0x80U;
    const unsigned third = bit('Q', 0) | (script_.cybertouch ? 2U : 0U);
    return {static_cast<char>(first), static_cast<char>(second), static_cast<char>(third)};
  }

  std::string query(char letter) const {
    using namespace std::string_view_literals;
    switch (letter) {
    case 'G':
      return reply(letter, script_.manner == Manner::no_glove || unplugged ? "\x01"sv : "\x03"sv);
    case 'S':
      return reply(letter, sensors_ == 22 ? "\x16"sv : "\x12"sv);
    case 'K':
      return reply(letter, hardware());
    case 'M':
      return reply(letter, mask_);
    case 'N':
      return reply(letter, values_);
    case 'R':
      return reply(letter, script_.right ? "\x01"sv : "\x00"sv);
    case 'T':
      return script_.knows_rate ? reply(letter, word(period_[0]) + word(period_[1])) : unknown();
    case 'i':
      return reply(letter, " \r\nScripted\x1B CyberGlove \r\nsecond line\r\n"sv);
    default:
      break;
    }
    if (!script_.knows_all) return unknown();
    if (is_switch(letter)) return reply(letter, is_on(letter) ? "\x01"sv : "\x00"sv);
    switch (letter) {
    case 'P':
      return reply(letter, parameters());
    case 'V':
      return reply(letter, "\x02\x00\x01\x00"sv);
    case 'v':
      return reply(letter, " 2.1\r\n"sv);
    case 'B':
      return reply(letter, "\x10"sv);
    case 'A':
      return reply(letter, "\x00\x01\x02\x03\x04\xFF"sv);
    case 'C':
      return reply(letter, std::string(sensors_, '\x0A') + std::string(sensors_, '\0'));
    default:
      return unknown();
    }
  }

  const Script script_;
  unsigned sensors_;
  unsigned records_ = 0;
  std::array<bool, 256> switches_ = [] {
    std::array<bool, 256> on{};
    on['F'] = on['J'] = true;
    return on;
  }();
  std::string mask_ = "\xFF\xFF\xFF";
  std::string values_ = "\x18";
  std::array<unsigned, 2> period_{1280, 1}; // 90 Hz
};

} // namespace nendo::test
