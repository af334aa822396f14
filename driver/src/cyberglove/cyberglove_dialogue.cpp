#include "cyberglove/cyberglove_dialogue.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <optional>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

constexpr auto quiet_line = 50ms;
constexpr auto quiet_end = 30ms;       ///< after what may be the end of a reply, or not quite
constexpr auto rest_of_answer = 100ms; ///< after a beginning that came late; 90 bytes at 9600 baud
constexpr auto write_timeout = 200ms;
constexpr auto max_wait = 100ms; ///< between two looks at the stop token
constexpr std::size_t max_junk_bytes = 4096;
constexpr std::size_t max_text_bytes = 2048;
constexpr auto text_timeout = 1000ms; ///< the vendor's, for long strings [V]

/// The last error, if any; its NUL may not have arrived yet.
std::optional<Answer> error_at_end(const Tail& tail) noexcept {
  struct Known {
    char letter;
    Answer answer;
  };
  constexpr std::array all{
      Known{error_unknown_command, Answer::unknown}, Known{error_number, Answer::bad_number},
      Known{error_sync_rate, Answer::bad_sync_rate}, Known{error_no_glove, Answer::no_glove},
      Known{error_sampling_rate, Answer::bad_rate},
  };
  for (const Known& error : all) {
    const std::array pair{error_mark, error.letter};
    if (tail.ends_with({pair.data(), pair.size()})) return error.answer;
  }
  return std::nullopt;
}

/// The answer to a command in a frame that ends with `tail` and NUL.
std::optional<Answer> check_confirmation(const Tail& tail, std::string_view echo) noexcept {
  // An echo like "1es" ends like an error; one like "y" is the end of an error.
  if (echo.size() > 2 && tail.ends_with(echo)) return Answer::good;
  if (const auto error = error_at_end(tail)) return error;
  // Two bytes in most sources, three in the vendor's library; text commands may end their line.
  for (const unsigned more : {0U, 1U, 2U}) {
    if (more == 2 && !tail.ends_with("\r\n")) break;
    if (tail.ends_with(echo, more)) return Answer::good;
  }
  return std::nullopt;
}

/// Decodes the data of replies.
struct Decoder {
  ByteReader bytes;

  void operator()(std::uint8_t& value) noexcept { value = bytes.u8(); }
  void operator()(bool& value) noexcept { value = bytes.u8() != 0; }
  void operator()(Side& value) noexcept { value = bytes.u8() == 0 ? Side::left : Side::right; }
  void operator()(std::uint32_t& value) noexcept { value = bytes.u24_le(); }
  void operator()(SensorMask& value) noexcept { value.bits = bytes.u24_le(); }
  void operator()(GloveState& value) noexcept {
    const std::uint8_t bits = bytes.u8();
    value = {(bits & state_initialised) != 0, (bits & state_connected) != 0};
  }
  template <class Byte, std::size_t size>
  void operator()(std::array<Byte, size>& value) noexcept {
    for (Byte& byte : value)
      byte = Byte{bytes.u8()};
  }
};

} // namespace

bool Tail::ends_with(std::string_view pattern, unsigned back) const noexcept {
  std::uint64_t rest = bytes_ >> (8U * back);
  for (auto letter = pattern.rbegin(); letter != pattern.rend(); ++letter, rest >>= 8U) {
    if ((rest & 0xFFU) != static_cast<unsigned char>(*letter)) return false;
  }
  return true;
}

HostTime Dialogue::at_most(std::chrono::milliseconds timeout) const noexcept {
  return std::min(deadline_, HostClock::now() + timeout);
}

HostTime Dialogue::answered_by(std::chrono::milliseconds timeout) const noexcept {
  return at_most(std::max(timeout, slowest_answer_ * 3 / 2));
}

Answer Dialogue::send(std::span<const std::byte> command) noexcept {
  unread_ = {};
  if (cancelled_.stop_requested()) return Answer::silent;
  sent_at_ = HostClock::now();
  switch (transport_.write_all(command, write_timeout)) {
  case IoStatus::done:
    return Answer::good;
  case IoStatus::timeout:
    return Answer::silent;
  case IoStatus::gone:
    break;
  }
  return Answer::gone;
}

Answer Dialogue::next(std::byte& byte, HostTime until) noexcept {
  using std::chrono::milliseconds;
  while (unread_.empty()) {
    if (cancelled_.stop_requested()) return Answer::silent;
    // Bytes in the buffer count, even if this thread was delayed beyond `until`.
    const auto left = std::max(std::chrono::ceil<milliseconds>(until - HostClock::now()), 0ms);
    const auto [status, count] =
        transport_.read_some(buffer_, std::min<milliseconds>(left, max_wait));
    if (status == IoStatus::gone) return Answer::gone;
    if (count == 0 && left == 0ms) return Answer::silent;
    bytes_received_ += count;
    unread_ = std::span(buffer_).first(count);
  }
  byte = unread_.front();
  unread_ = unread_.subspan(1);
  return Answer::good;
}

template <class Judge>
Answer Dialogue::read_until(HostTime& until, Judge&& judge) noexcept {
  const HostTime quiet_until = std::max(until, std::min(deadline_, sent_at_ + quiet_wait_));
  for (std::size_t skipped = 0; skipped < max_junk_bytes; ++skipped) {
    std::byte byte{};
    const Answer answer = next(byte, skipped == 0 ? quiet_until : until);
    if (answer == Answer::silent && skipped > 0) return Answer::nonsense;
    if (answer != Answer::good) return answer;
    if (skipped == 0) until = std::max(until, at_most(rest_of_answer));
    const std::optional<Answer> judged = judge(byte);
    if (judged == Answer::good) {
      expect_late_answers(
          std::chrono::ceil<std::chrono::milliseconds>(HostClock::now() - sent_at_));
    }
    if (judged) return *judged;
  }
  return Answer::nonsense;
}

/// Reads up to and including the head of a reply.
Answer Dialogue::find_reply(std::string_view head, HostTime& until) noexcept {
  Tail tail;
  return read_until(until, [&](std::byte byte) -> std::optional<Answer> {
    if (byte == terminator) {
      if (const auto error = error_at_end(tail)) return error;
    }
    tail.push(byte);
    if (tail.ends_with(head)) return Answer::good;
    return std::nullopt;
  });
}

Answer Dialogue::drain(std::chrono::milliseconds max_time) noexcept {
  unread_ = {};
  const HostTime until = at_most(max_time);
  for (;;) {
    std::byte ignored{};
    const HostTime quiet_at = HostClock::now() + quiet_line;
    const Answer answer = next(ignored, std::min(quiet_at, until));
    if (answer == Answer::gone) return answer;
    if (answer == Answer::silent) return quiet_at <= until ? Answer::good : Answer::nonsense;
    unread_ = {};
    if (HostClock::now() >= until) return Answer::nonsense;
  }
}

Answer Dialogue::stop_stream(std::chrono::milliseconds max_time) noexcept {
  const Answer sent = send(std::span(&interrupt, 1));
  return sent == Answer::good ? drain(max_time) : sent;
}

Answer Dialogue::pause_stream(std::chrono::milliseconds timeout) noexcept {
  HostTime until = at_most(timeout);
  if (const Answer sent = send(std::span(&interrupt, 1)); sent != Answer::good) return sent;
  // 03 00 on its own is the answer. At the end of something longer it is the answer after a broken
  // record, or a record whose last value is 3: then more bytes follow, or none. A 03 of its own,
  // after a record of 12 bits, is the answer if nothing follows.
  bool perhaps = false;
  std::byte last{};
  for (std::size_t length = 1;; ++length) {
    std::byte byte{};
    const Answer answer = next(byte, until);
    if (answer == Answer::silent && perhaps) return Answer::good;
    if (answer != Answer::good) return answer;
    if (byte == terminator) {
      if (last == interrupt && length == 2) return Answer::good;
      if (last == interrupt && !perhaps) {
        perhaps = true;
        until = std::min(until, HostClock::now() + quiet_end);
      }
      length = 0;
    } else if (byte == interrupt && length == 1) {
      perhaps = true;
      until = std::min(until, HostClock::now() + quiet_end);
    }
    last = byte;
  }
}

Answer Dialogue::ask(char letter, std::span<std::byte> data,
                     std::chrono::milliseconds timeout) noexcept {
  HostTime until = answered_by(timeout);
  const std::array head{'?', letter};
  if (const Answer sent = send(std::as_bytes(std::span(head))); sent != Answer::good) return sent;
  Answer answer = find_reply({head.data(), head.size()}, until);
  for (std::size_t k = 0; k < data.size() && answer == Answer::good; ++k) {
    answer = next(data[k], until);
    if (answer == Answer::silent) return Answer::nonsense;
  }
  if (answer != Answer::good) return answer;
  std::byte end{};
  answer = next(end, until);
  if (answer == Answer::gone) return answer;
  return answer == Answer::good && end == terminator ? Answer::good : Answer::nonsense;
}

Answer Dialogue::ask_text(char letter, std::string& text, std::chrono::milliseconds timeout) {
  HostTime until = answered_by(timeout);
  const std::array head{'?', letter};
  if (const Answer sent = send(std::as_bytes(std::span(head))); sent != Answer::good) return sent;
  Answer answer = find_reply({head.data(), head.size()}, until);
  text.clear();
  for (std::byte byte{}; answer == Answer::good;) {
    answer = next(byte, until);
    if (answer != Answer::good) break;
    if (byte == terminator || text.size() == max_text_bytes) return Answer::good;
    text.push_back(std::to_integer<char>(byte));
  }
  return answer;
}

Answer Dialogue::command(std::span<const std::byte> bytes, std::string_view echo,
                         std::chrono::milliseconds timeout) noexcept {
  HostTime until = answered_by(timeout);
  if (const Answer sent = send(bytes); sent != Answer::good) return sent;
  Tail tail;
  return read_until(until, [&](std::byte byte) -> std::optional<Answer> {
    if (byte == terminator) {
      if (const auto judged = check_confirmation(tail, echo)) return judged;
    }
    tail.push(byte);
    return std::nullopt;
  });
}

Answer Dialogue::start_stream(std::string_view command) noexcept {
  return send(std::as_bytes(std::span(command)));
}

Answer Commands::send(std::string_view head, std::span<const std::uint8_t> arguments) noexcept {
  std::array<std::byte, 16> message{}; // the longest sets a period: t, two words and CR
  assert(head.size() + arguments.size() <= message.size());
  const auto letters = std::as_bytes(std::span(head));
  const auto numbers = std::as_bytes(arguments);
  const auto end = std::copy(letters.begin(), letters.end(), message.begin());
  std::copy(numbers.begin(), numbers.end(), end);
  const auto bytes = std::span(message).first(letters.size() + numbers.size());
  const Answer answer = dialogue_.command(bytes, head, timeout_);
  // A unit that does not know the command takes the arguments for further commands: their errors
  // must not be taken for the next replies, nor may one of them wait for an argument.
  if (answer != Answer::good && answer != Answer::gone) dialogue_.stop_stream();
  return answer;
}

Answer Commands::send(std::string_view head, std::uint8_t argument) noexcept {
  return send(head, std::span(&argument, 1));
}

Reply<std::string> Commands::information() {
  Reply<std::string> reply;
  reply.answer = dialogue_.ask_text(ask_information, reply.value, std::max(timeout_, text_timeout));
  return reply;
}

Reply<std::string> Commands::firmware_text() {
  Reply<std::string> reply;
  reply.answer = dialogue_.ask_text(ask_firmware_text, reply.value, timeout_);
  return reply;
}

template <class T>
Reply<T> Commands::ask(Query<T> query) noexcept {
  std::array<std::byte, sizeof(Vibration)> data{}; // the longest
  assert(query.data_bytes <= data.size());
  Reply<T> reply;
  reply.answer = dialogue_.ask(query.letter, std::span(data).first(query.data_bytes), timeout_);
  Decoder{ByteReader(data)}(reply.value);
  return reply;
}

template Reply<std::uint8_t> Commands::ask(Query<std::uint8_t>) noexcept;
template Reply<Side> Commands::ask(Query<Side>) noexcept;
template Reply<std::uint32_t> Commands::ask(Query<std::uint32_t>) noexcept;
template Reply<SensorMask> Commands::ask(Query<SensorMask>) noexcept;
template Reply<GloveState> Commands::ask(Query<GloveState>) noexcept;
template Reply<std::array<std::uint8_t, 4>>
    Commands::ask(Query<std::array<std::uint8_t, 4>>) noexcept;
template Reply<std::array<std::byte, 4>> Commands::ask(Query<std::array<std::byte, 4>>) noexcept;
template Reply<Vibration> Commands::ask(Query<Vibration>) noexcept;

Reply<bool> Commands::get(Setting setting) noexcept {
  return ask(Query<bool>{static_cast<char>(setting), 1});
}

Answer Commands::set(Setting setting, bool on) noexcept {
  const auto letter = static_cast<char>(setting);
  return send({&letter, 1}, on ? 1 : 0);
}

Answer Commands::set_software_mask(SensorMask mask) noexcept {
  return send(cyberglove::set_software_mask,
              std::array{static_cast<std::uint8_t>(mask.bits & 0xFFU),
                         static_cast<std::uint8_t>(mask.bits >> 8U & 0xFFU),
                         static_cast<std::uint8_t>(mask.bits >> 16U & 0xFFU)});
}

Reply<std::optional<WordOrder>> Commands::set_period(Period period) noexcept {
  std::array<char, 13> text{}; // " 65535 65535\r"
  char* end = text.begin();
  for (const unsigned word : {period.ticks, period.times}) {
    *end++ = ' ';
    end = std::to_chars(end, text.end(), word).ptr;
  }
  *end++ = '\r';
  std::array<std::uint8_t, text.size()> bytes{};
  std::copy(text.begin(), end, bytes.begin());
  const auto size = static_cast<std::size_t>(end - text.begin());
  const Answer done = send(set_period_text, std::span(bytes).first(size));
  // An unreadable confirmation is no confirmation, but the query shows what the unit did.
  if (done != Answer::good && done != Answer::nonsense) return {done, std::nullopt};
  const auto reply = ask(ask_period);
  if (reply.answer == Answer::unknown) return {done, std::nullopt};
  if (!reply) return {reply.answer, std::nullopt};
  const auto order = order_of(reply.value, period);
  return {order ? Answer::good : Answer::other_value, order};
}

Reply<HardwareCalibration> Commands::hardware_calibration(std::size_t sensors) noexcept {
  assert(sensors <= sensor_slots);
  std::array<std::byte, 2 * sensor_slots> data{};
  const auto used = std::span(data).first(2 * sensors);
  Reply<HardwareCalibration> reply;
  reply.answer = dialogue_.ask(ask_calibration, used, timeout_);
  reply.value.sensors = sensors;
  ByteReader reader(used);
  for (std::size_t k = 0; k < sensors; ++k)
    reply.value.offset[k] = reader.u8();
  for (std::size_t k = 0; k < sensors; ++k)
    reply.value.gain[k] = reader.u8();
  return reply;
}

Answer Commands::set_vibration(const Vibration& strength) noexcept {
  std::array<std::uint8_t, 1 + std::tuple_size_v<Vibration>> bytes{all_vibrators};
  std::copy(strength.begin(), strength.end(), bytes.begin() + 1);
  return send(cyberglove::set_vibration, bytes);
}

} // namespace nendo::driver::cyberglove
