#include "lucidgloves/lucidgloves_parser.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

namespace nendo::driver::lucidgloves {
namespace {

using Number = std::optional<std::uint32_t>;

constexpr bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}
constexpr bool is_upper(char c) noexcept {
  return c >= 'A' && c <= 'Z';
}
/// Thumb to pinky are A to E, and so are the joints of a finger; at least `count` for others.
constexpr std::size_t index_of(char letter) noexcept {
  return static_cast<std::size_t>(static_cast<unsigned char>(letter)) - 'A';
}

/// Takes what `belongs` from the front of `text`.
template <class Belongs>
std::string_view take_while(std::string_view& text, Belongs&& belongs) noexcept {
  const auto end = std::find_if_not(text.begin(), text.end(), belongs);
  const auto part = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(part.size());
  return part;
}

/// A letter, or letters in brackets, which are taken off: the brackets only tell one from the
/// other. Empty: neither.
struct Key {
  std::string_view letters;
  bool bracketed = false;
};
Key take_key(std::string_view& text) noexcept {
  Key key;
  if (text.front() != '(') {
    if (!is_upper(text.front())) return key;
    key.letters = text.substr(0, 1);
    text.remove_prefix(1);
    return key;
  }
  text.remove_prefix(1);
  const auto letters = take_while(text, is_upper);
  if (text.empty() || text.front() != ')') return key;
  text.remove_prefix(1);
  return {letters, true};
}

/// False: more digits than a number has. A key without a number is a pressed button.
bool take_number(std::string_view& text, Number& number) noexcept {
  const auto digits = take_while(text, is_digit);
  if (digits.empty()) return true;
  std::uint32_t value = 0;
  const auto [stopped, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value);
  number = value;
  return error == std::errc{};
}

class LineDecoder {
public:
  explicit LineDecoder(std::uint16_t range) noexcept : range_(range) {}

  bool decode(std::string_view text) noexcept {
    return is_digit(text.front()) ? decode_legacy(text) : decode_alpha(text);
  }
  const Line& line() const noexcept { return line_; }

private:
  bool decode_alpha(std::string_view text) noexcept {
    while (!text.empty()) {
      const Key key = take_key(text);
      Number number;
      if (key.letters.empty() || !take_number(text, number)) return false;
      if (!(key.bracketed ? set_long(key.letters, number) : set_short(key.letters[0], number)))
        return false;
    }
    return true;
  }

  bool decode_legacy(std::string_view text) noexcept {
    line_.legacy = true;
    for (std::size_t k = 0; k < legacy_values; ++k) {
      Number number;
      if (!take_number(text, number) || !number) return false;
      if (k < fingers && !set(line_.curl[k], number)) return false;
      if (k + 1 == legacy_values) break;
      if (text.empty() || text.front() != '&') return false;
      text.remove_prefix(1);
    }
    return text.empty();
  }

  bool set_short(char letter, const Number& number) noexcept {
    if (const auto finger = index_of(letter); finger < fingers)
      return set(line_.curl[finger], number);
    const std::uint32_t bit = 1U << index_of(letter);
    return (std::exchange(buttons_, buttons_ | bit) & bit) == 0;
  }

  bool set_long(std::string_view key, const Number& number) noexcept {
    if (key == "ZV") return set_once(line_.firmware, number);
    if (key == "ZG") return set_once(line_.device, number);
    if (key == "ZH") return set_once(line_.hand, number);
    const auto finger = index_of(key[0]);
    if (finger >= fingers) return true; // a key of some other firmware
    if (key.size() == 2 && key[1] == 'B') return set(line_.splay[finger], number);
    if (key.size() != 3 || key[1] != 'A' || index_of(key[2]) >= joints) return true;
    return set(line_.joint[finger][index_of(key[2])], number);
  }

  bool set(Line::Value& value, const Number& number) noexcept {
    if (value || !number || *number > most_above_range) return false;
    line_.clamped = line_.clamped || *number > range_;
    value = static_cast<std::uint16_t>(std::min<std::uint32_t>(*number, range_));
    return true;
  }
  static bool set_once(Number& value, const Number& number) noexcept {
    if (value || !number) return false;
    value = number;
    return true;
  }

  const std::uint16_t range_;
  std::uint32_t buttons_ = 0; ///< that the line has told, by letter
  Line line_;
};

bool any(const std::array<Line::Value, fingers>& values) noexcept {
  return std::any_of(values.begin(), values.end(), [](const auto& value) { return bool(value); });
}

} // namespace

bool Line::measures() const noexcept {
  const auto has_value = [](const Value& value) { return value.has_value(); };
  return any(curl) || any(splay) || std::any_of(joint.begin(), joint.end(), [&](const auto& of) {
           return std::any_of(of.begin(), of.end(), has_value);
         });
}

bool Line::informs() const noexcept {
  return firmware || device || hand;
}

std::optional<Line> decode_line(std::string_view text, std::uint16_t range) noexcept {
  LineDecoder decoder(range);
  if (text.empty() || !decoder.decode(text)) return std::nullopt;
  if (!decoder.line().measures() && !decoder.line().informs()) return std::nullopt;
  return decoder.line();
}

std::optional<Line> Parser::push_byte(std::byte byte) noexcept {
  ++counters_.bytes;
  const char c = std::to_integer<char>(byte);
  if (c == '\n') return end_line();
  if (state_ != State::in_line) {
    ++counters_.discarded_bytes;
    return std::nullopt;
  }
  line_[held_++] = c;
  if (held_ == line_.size()) { // there is no room for the LF
    discard_held();
    state_ = State::overlong;
  }
  return std::nullopt;
}

std::optional<Line> Parser::end_line() noexcept {
  const State before = std::exchange(state_, State::in_line);
  const std::size_t bytes = std::exchange(held_, 0) + 1;
  std::string_view text(line_.data(), bytes - 1);
  if (text.ends_with('\r')) text.remove_suffix(1);
  const bool empty = before == State::in_line && text.empty();
  const auto line = before == State::in_line ? decode_line(text, range_) : std::nullopt;
  if (line && line->measures()) {
    ++counters_.records;
    counters_.record_bytes += bytes;
    return line;
  }
  counters_.discarded_bytes += bytes;
  if (!line && !empty && before != State::begin_unseen) count_bad();
  return line;
}

void Parser::discard_held() noexcept {
  counters_.discarded_bytes += held_;
  held_ = 0;
}

void Parser::reset() noexcept {
  discard_held();
  state_ = State::begin_unseen;
}

} // namespace nendo::driver::lucidgloves
