#include "cyberglove/cyberglove_dialogue.hpp"

#include <algorithm>
#include <optional>

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

constexpr auto quiet_line = 50ms;
constexpr auto quiet_end = 30ms;       ///< after what may be the end of a reply, or not quite
constexpr auto rest_of_answer = 100ms; ///< after a beginning that came late; 90 bytes at 9600 baud
constexpr auto write_timeout = 200ms;
constexpr auto longest_wait = 100ms; ///< between two looks at the stop token
constexpr std::size_t max_junk_bytes = 4096;
constexpr std::size_t max_text_bytes = 2048;

/// The error that came last, if any; its NUL may not have come yet.
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

/// What a frame, of which `tail` is the end without NUL, says to a command.
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
    // What has arrived counts, also where this thread was kept from looking until it was too late.
    const auto left = std::max(std::chrono::ceil<milliseconds>(until - HostClock::now()), 0ms);
    const auto [status, count] =
        transport_.read_some(buffer_, std::min<milliseconds>(left, longest_wait));
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

Answer Dialogue::drain(std::chrono::milliseconds longest) noexcept {
  unread_ = {};
  const HostTime until = at_most(longest);
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

Answer Dialogue::stop_stream(std::chrono::milliseconds longest) noexcept {
  const Answer sent = send(std::span(&interrupt, 1));
  return sent == Answer::good ? drain(longest) : sent;
}

Answer Dialogue::pause_stream(std::chrono::milliseconds timeout) noexcept {
  HostTime until = at_most(timeout);
  if (const Answer sent = send(std::span(&interrupt, 1)); sent != Answer::good) return sent;
  // 03 00 on its own is the answer. At the end of something longer it is the answer behind a record
  // that was broken off, or a record whose last value is 3: then more follows, or it gets quiet. A
  // 03 of its own, behind a record of 12 bits, is the answer if nothing follows.
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

Answer Dialogue::ask(const Query& query, std::span<std::byte> data,
                     std::chrono::milliseconds timeout) noexcept {
  HostTime until = answered_by(timeout);
  const std::array head{'?', query.letter};
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

Answer Dialogue::ask_record(std::size_t least, std::span<std::byte> record, std::size_t& size,
                            std::chrono::milliseconds timeout) noexcept {
  HostTime until = answered_by(timeout);
  const std::array command{record_command};
  if (const Answer sent = send(std::as_bytes(std::span(command))); sent != Answer::good) {
    return sent;
  }
  Tail tail;
  size = 0;
  return read_until(until, [&](std::byte byte) -> std::optional<Answer> {
    if (size < record.size()) record[size] = byte;
    ++size; // beyond the record's room if the frame is too long to be one
    if (byte != terminator) {
      tail.push(byte);
      return std::nullopt;
    }
    const bool fits = size >= least && size <= record.size();
    if (fits && std::to_integer<char>(record[0]) == record_command) return Answer::good;
    if (const auto error = error_at_end(tail)) return error;
    size = 0;
    return std::nullopt;
  });
}

Answer Dialogue::restart(std::chrono::milliseconds timeout) noexcept {
  HostTime until = at_most(timeout);
  const auto slowest = slowest_answer_; // a restart takes its time, and is no answer
  if (const Answer sent = send(std::span(&restart_firmware, 1)); sent != Answer::good) return sent;
  Tail tail;
  const Answer answer = read_until(until, [&](std::byte byte) -> std::optional<Answer> {
    if (byte == terminator) {
      if (const auto error = error_at_end(tail)) return error;
    }
    tail.push(byte);
    // One driver expects the command as it would be printed.
    if (tail.ends_with("\x12\r\n") || tail.ends_with("^R\r\n")) return Answer::good;
    return std::nullopt;
  });
  slowest_answer_ = slowest;
  if (answer != Answer::good) return answer;
  // A left glove's answer may lack its NUL.
  std::byte end{};
  return next(end, at_most(quiet_end)) == Answer::gone ? Answer::gone : Answer::good;
}

Answer Dialogue::start_stream(std::string_view command) noexcept {
  return send(std::as_bytes(std::span(command)));
}

} // namespace nendo::driver::cyberglove
