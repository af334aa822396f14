#include "cyberglove/cyberglove_dialogue.hpp"

#include <algorithm>

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

constexpr auto quiet_line = 50ms;
constexpr auto longest_drain = 500ms;
constexpr auto write_timeout = 200ms;
constexpr auto longest_wait = 100ms; ///< between two looks at the stop token
constexpr std::size_t most_junk_bytes = 4096;
constexpr std::size_t most_text_bytes = 2048;

constexpr std::byte byte_of(char letter) noexcept {
  return static_cast<std::byte>(letter);
}

/// The error that `e` and `letter` stand for, if any.
std::optional<Answer> error_answer(std::byte letter) noexcept {
  switch (std::to_integer<char>(letter)) {
  case error_unknown_command:
    return Answer::unknown;
  case error_number:
    return Answer::bad_number;
  case error_sync_rate:
    return Answer::bad_sync_rate;
  case error_no_glove:
    return Answer::no_glove;
  case error_sampling_rate:
    return Answer::bad_rate;
  default:
    return std::nullopt;
  }
}

} // namespace

HostTime Dialogue::at_most(std::chrono::milliseconds timeout) const noexcept {
  return std::min(deadline_, HostClock::now() + timeout);
}

Answer Dialogue::send(std::span<const std::byte> command) noexcept {
  unread_ = {};
  if (cancelled_.stop_requested()) return Answer::silent;
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
    const auto left = std::chrono::ceil<milliseconds>(until - HostClock::now());
    if (left <= 0ms || cancelled_.stop_requested()) return Answer::silent;
    const auto [status, count] =
        transport_.read_some(buffer_, std::min<milliseconds>(left, longest_wait));
    if (status == IoStatus::gone) return Answer::gone;
    bytes_received_ += count;
    unread_ = std::span(buffer_).first(count);
  }
  byte = unread_.front();
  unread_ = unread_.subspan(1);
  return Answer::good;
}

/// Reads up to and including the head of a reply: `mark`, if there is one, and `letter`.
Answer Dialogue::find_reply(std::optional<char> mark, char letter, HostTime until) noexcept {
  std::byte before_last{};
  std::byte last{};
  for (std::size_t skipped = 0; skipped < most_junk_bytes; ++skipped) {
    std::byte byte{};
    const Answer answer = next(byte, until);
    if (answer == Answer::silent && skipped > 0) return Answer::nonsense;
    if (answer != Answer::good) return answer;
    if (byte == byte_of(letter) && (!mark || last == byte_of(*mark))) return Answer::good;
    if (byte == terminator && before_last == byte_of(error_mark)) {
      if (const auto error = error_answer(last)) return *error;
    }
    before_last = last;
    last = byte;
  }
  return Answer::nonsense;
}

Answer Dialogue::drain() noexcept {
  unread_ = {};
  const HostTime until = at_most(longest_drain);
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

Answer Dialogue::stop_stream() noexcept {
  const Answer sent = send(std::span(&interrupt, 1));
  return sent == Answer::good ? drain() : sent;
}

Answer Dialogue::reread_glove() noexcept {
  const Answer sent = send(std::span(&cyberglove::reread_glove, 1));
  return sent == Answer::good ? drain() : sent;
}

Answer Dialogue::ask(const Query& query, std::span<std::byte> data,
                     std::chrono::milliseconds timeout) noexcept {
  const HostTime until = at_most(timeout);
  const std::array command{byte_of('?'), byte_of(query.letter)};
  if (const Answer sent = send(command); sent != Answer::good) return sent;
  Answer answer = find_reply('?', query.letter, until);
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
  const HostTime until = at_most(timeout);
  const std::array command{byte_of('?'), byte_of(letter)};
  if (const Answer sent = send(command); sent != Answer::good) return sent;
  Answer answer = find_reply('?', letter, until);
  text.clear();
  for (std::byte byte{}; answer == Answer::good;) {
    answer = next(byte, until);
    if (answer != Answer::good) break;
    if (byte == terminator || text.size() == most_text_bytes) return Answer::good;
    text.push_back(std::to_integer<char>(byte));
  }
  return answer;
}

Answer Dialogue::set(char letter, bool on, std::chrono::milliseconds timeout) noexcept {
  const HostTime until = at_most(timeout);
  const std::array command{byte_of(letter), std::byte{on}};
  if (const Answer sent = send(command); sent != Answer::good) return sent;
  Answer answer = find_reply(std::nullopt, letter, until);
  if (answer != Answer::good) return answer;
  // Two bytes in most sources, three in the vendor's library: read to NUL, but not far.
  std::byte byte{};
  for (int k = 0; k < 2; ++k) {
    answer = next(byte, until);
    if (answer == Answer::gone) return answer;
    if (answer == Answer::good && byte == terminator) return Answer::good;
  }
  return Answer::nonsense;
}

Answer Dialogue::start_stream() noexcept {
  const std::array command{byte_of(stream_command)};
  return send(command);
}

} // namespace nendo::driver::cyberglove
