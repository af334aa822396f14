#include "lucidgloves/lucidgloves_parser.hpp"

#include <algorithm>
#include <utility>

#include <nendo/base/number_in.hpp>

namespace nendo::driver::lucidgloves {
namespace {

using Number = std::optional<std::int64_t>;

constexpr bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}
constexpr bool is_upper(char c) noexcept {
  return c >= 'A' && c <= 'Z';
}
/// Thumb to little finger are A to E, and so are the joints of a finger; at least `count` for
/// others.
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

/// A letter, or letters in brackets, which are taken off: the brackets only distinguish
/// them. Empty: neither.
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

/// Takes a number of 32 bits with or without a sign, which is all that a firmware can have. A key
/// without a number is a pressed button. Returns false if it is no such number.
bool take_number(std::string_view& text, Number& number) noexcept {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const auto digits = take_while(text, is_digit);
  if (digits.empty()) return !negative;
  const auto value = number_in<std::uint32_t>(digits);
  if (value) number = negative ? -std::int64_t{*value} : std::int64_t{*value};
  return value.has_value();
}

class LineDecoder {
public:
  explicit LineDecoder(std::uint16_t range) noexcept : range_(range) {}

  bool decode(std::string_view text) noexcept {
    const bool legacy = is_digit(text.front()) || text.front() == '-';
    return legacy ? decode_legacy(text) : decode_alpha(text);
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
    return far_values_ == 0 || are_credible();
  }

  /// Where two numbers ran into one, the letter between them is missing, and with it a value of its
  /// group. A legacy line would have too few numbers.
  bool are_credible() const noexcept {
    const auto is_set = [](const Line::Value& value) { return value.has_value(); };
    const bool curls = (far_values_ & far_curl) == 0 || line_.is_whole();
    const bool splays = (far_values_ & far_splay) == 0 ||
                        std::all_of(line_.splay.begin(), line_.splay.end(), is_set);
    return curls && splays && (far_values_ & far_joint) == 0;
  }

  bool decode_legacy(std::string_view text) noexcept {
    line_.legacy = true;
    for (std::size_t k = 0; k < legacy_values; ++k) {
      Number number;
      if (!take_number(text, number) || !number) return false;
      if (k < fingers && !set(line_.curl[k], number, far_curl)) return false;
      if (k + 1 == legacy_values) break;
      if (text.empty() || text.front() != '&') return false;
      text.remove_prefix(1);
    }
    return text.empty();
  }

  bool set_short(char letter, const Number& number) noexcept {
    if (const auto finger = index_of(letter); finger < fingers)
      return set(line_.curl[finger], number, far_curl);
    const std::uint32_t bit = 1U << index_of(letter);
    return (std::exchange(buttons_, buttons_ | bit) & bit) == 0;
  }

  bool set_long(std::string_view key, const Number& number) noexcept {
    if (key == "ZV") return set_once(line_.firmware, number);
    if (key == "ZG") return set_once(line_.device, number);
    if (key == "ZH") return set_once(line_.hand, number);
    const auto finger = index_of(key[0]);
    if (finger >= fingers) return true; // a key of some other firmware
    if (key.size() == 2 && key[1] == 'B') return set(line_.splay[finger], number, far_splay);
    if (key.size() != 3 || key[1] != 'A' || index_of(key[2]) >= joints) return true;
    return set(line_.joint[finger][index_of(key[2])], number, far_joint);
  }

  bool set(Line::Value& value, const Number& number, unsigned far_kind) noexcept {
    if (value || !number) return false;
    if (*number > max_beyond_range || *number < -max_beyond_range) far_values_ |= far_kind;
    line_.above_range += *number > range_ ? 1U : 0U;
    line_.below_range += *number < 0 ? 1U : 0U;
    value = static_cast<std::uint16_t>(std::clamp<std::int64_t>(*number, 0, range_));
    return true;
  }
  static bool set_once(std::optional<std::uint32_t>& value, const Number& number) noexcept {
    if (value || !number || *number < 0) return false;
    value = static_cast<std::uint32_t>(*number);
    return true;
  }

  static constexpr unsigned far_curl = 1, far_splay = 2, far_joint = 4;
  const std::uint16_t range_;
  std::uint32_t buttons_ = 0; ///< buttons in the line, by letter
  unsigned far_values_ = 0;   ///< kinds of values that were very far out of range
  Line line_;
};

bool any(const std::array<Line::Value, fingers>& values) noexcept {
  return std::any_of(values.begin(), values.end(), [](const auto& value) { return bool(value); });
}

constexpr Sensor none = Sensor::unused;

/// By finger and joint, from the metacarpal out.
constexpr std::array<std::array<Sensor, joints>, fingers> joint_slots{
    {{none, Sensor::thumb_mcp, Sensor::thumb_ip, none},
     {none, Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip},
     {none, Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip},
     {none, Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip},
     {none, Sensor::little_mcp, Sensor::little_pip, Sensor::little_dip}}};
constexpr std::size_t mcp = 1;   ///< a joint
constexpr std::size_t index = 1; ///< a finger

std::uint16_t apart(std::uint16_t one, std::uint16_t other, std::uint16_t range) noexcept {
  const int difference = one > other ? one - other : other - one;
  return static_cast<std::uint16_t>(std::min(2 * difference, int{range}));
}

} // namespace

bool Line::measures() const noexcept {
  const auto has_value = [](const Value& value) { return value.has_value(); };
  return any(curl) || any(splay) || std::any_of(joint.begin(), joint.end(), [&](const auto& of) {
           return std::any_of(of.begin(), of.end(), has_value);
         });
}

bool Line::is_whole() const noexcept {
  return std::all_of(curl.begin(), curl.end(), [](const Value& value) { return bool(value); });
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

void fill_slots(const Line& line, std::uint16_t range, GloveSample& sample) noexcept {
  for (std::size_t finger = 0; finger < fingers; ++finger) {
    if (line.curl[finger]) sample.set(joint_slots[finger][mcp], RawCount{*line.curl[finger]});
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const Sensor sensor = joint_slots[finger][joint];
      if (line.joint[finger][joint] && sensor != none)
        sample.set(sensor, RawCount{*line.joint[finger][joint]});
    }
  }
  if (line.splay[0]) sample.set(Sensor::thumb_abduction, RawCount{*line.splay[0]});
  for (std::size_t pair = 0; pair < gap_sensors.size(); ++pair) {
    const auto& one = line.splay[index + pair];
    const auto& other = line.splay[index + pair + 1];
    if (one && other) sample.set(gap_sensors[pair], RawCount{apart(*one, *other, range)});
  }
}

std::optional<Line> Parser::push_byte(std::byte byte) noexcept {
  const char c = std::to_integer<char>(byte);
  if (c == '\n') return end_line();
  if (state_ != State::in_line && state_ != State::first_piece) {
    ++counters_.discarded_bytes;
    return std::nullopt;
  }
  line_[held_++] = c;
  if (held_ == line_.size()) { // the LF does not fit
    discard_held();
    state_ = state_ == State::first_piece ? State::begin_unseen : State::overlong;
  }
  return std::nullopt;
}

std::optional<Line> Parser::end_line() noexcept {
  const State before = std::exchange(state_, State::in_line);
  const std::size_t bytes = std::exchange(held_, 0) + 1;
  std::string_view text(line_.data(), bytes - 1);
  if (text.ends_with('\r')) text.remove_suffix(1);
  const bool empty = before == State::in_line && text.empty();
  const bool readable = before == State::in_line || before == State::first_piece;
  auto line = readable ? decode_line(text, range_) : std::nullopt;
  if (before == State::first_piece && line && !line->is_whole()) line.reset();
  if (line && line->measures()) {
    ++counters_.records;
    counters_.clamped += line->above_range + line->below_range;
    counters_.record_bytes += bytes;
    return line;
  }
  counters_.discarded_bytes += bytes;
  const bool may_be_cut = before == State::begin_unseen || before == State::first_piece;
  if (!line && !empty && !may_be_cut) count_bad();
  return line;
}

void Parser::reset() noexcept {
  discard_held();
  state_ = first_ == FirstPiece::skip ? State::begin_unseen : State::first_piece;
}

} // namespace nendo::driver::lucidgloves
