#pragma once
// Asks the glove's interface unit, and reads its answers, while it does not stream. Replies may
// contain NUL and are therefore read by length. Bytes before a reply are skipped, since the unit
// may still be answering another program.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/units.hpp>

#include "cyberglove/cyberglove_protocol.hpp"
#include "transport/transport.hpp"

namespace nendo::driver::cyberglove {

enum class Answer : std::uint8_t {
  good,
  silent,        ///< nothing came in time, or the dialogue was cancelled
  gone,          ///< the device went away
  unknown,       ///< e? : the unit does not know the command
  bad_number,    ///< en
  bad_sync_rate, ///< ey
  no_glove,      ///< eg : no glove is plugged into the unit
  bad_rate,      ///< es : it cannot sample as fast
  other_value,   ///< it says that it did not do what it was told
  nonsense,      ///< something came that is no answer
};

/// The last bytes that came, in which short patterns are recognised.
class Tail {
public:
  void push(std::byte byte) noexcept {
    bytes_ = bytes_ << 8U | std::to_integer<std::uint64_t>(byte);
  }
  /// Returns true if `pattern`, at most 8 bytes, is what came last, or stands just before the last
  /// `back` bytes.
  bool ends_with(std::string_view pattern, unsigned back = 0) const noexcept;

private:
  std::uint64_t bytes_ = 0;
};

class Dialogue {
public:
  /// No call lasts beyond `deadline`, or more than 0.3 s after `cancelled` is requested. Each call
  /// may last longer than its timeout: as long as answers of this unit took so far, and half as
  /// long again. `transport` must outlive the dialogue.
  Dialogue(Transport& transport, HostTime deadline, std::stop_token cancelled = {}) noexcept
      : transport_(transport), deadline_(deadline), cancelled_(std::move(cancelled)) {}

  /// From now on waits so long for an answer to begin, if that is longer, while nothing at all
  /// comes: a unit that is slow now and then is quiet before it answers, and what is no unit may
  /// babble.
  void wait_on_quiet_line(std::chrono::milliseconds time) noexcept { quiet_wait_ = time; }
  /// Lets calls last until `deadline`, if that is later.
  void prolong(HostTime deadline) noexcept { deadline_ = std::max(deadline_, deadline); }
  /// Expects answers to take so long, e.g. as in an earlier dialogue with the same unit.
  void expect_late_answers(std::chrono::milliseconds time) noexcept {
    slowest_answer_ = std::max(slowest_answer_, time);
  }
  /// Returns how long the slowest good answer took to arrive.
  std::chrono::milliseconds slowest_answer() const noexcept { return slowest_answer_; }

  /// Ends a stream and reads until the line has been quiet for 50 ms. Gives up with `nonsense` if
  /// bytes still come after `longest`.
  Answer stop_stream(std::chrono::milliseconds longest = longest_drain) noexcept;
  /// Ends a stream and reads up to the answer. It is quicker, but needs a line without noise.
  Answer pause_stream(std::chrono::milliseconds timeout) noexcept;
  /// Asks for data. `data` must have the size that the query states; it is filled if the answer is
  /// good.
  Answer ask(const Query& query, std::span<std::byte> data,
             std::chrono::milliseconds timeout) noexcept;
  /// Asks for text, which is cut at 2048 characters.
  Answer ask_text(char letter, std::string& text, std::chrono::milliseconds timeout);
  /// Sends a command that is confirmed by `echo` and NUL, perhaps with a byte between them. `echo`
  /// has 1 to 4 characters.
  Answer command(std::span<const std::byte> bytes, std::string_view echo,
                 std::chrono::milliseconds timeout) noexcept;
  /// Asks for one record, which has at least `least` bytes. `size` becomes its length with header
  /// and NUL.
  Answer ask_record(std::size_t least, std::span<std::byte> record, std::size_t& size,
                    std::chrono::milliseconds timeout) noexcept;
  /// Restarts the firmware. All settings are then as after power-up.
  Answer restart(std::chrono::milliseconds timeout) noexcept;
  /// Sends a command that begins a stream. All bytes that arrive from now on are records.
  Answer start_stream(std::string_view command) noexcept;

  /// Returns how many bytes were read from the transport so far.
  std::uint64_t bytes_received() const noexcept { return bytes_received_; }

  static constexpr std::chrono::milliseconds longest_drain{500};

private:
  Answer send(std::span<const std::byte> command) noexcept;
  Answer drain(std::chrono::milliseconds longest) noexcept;
  Answer next(std::byte& byte, HostTime until) noexcept;
  template <class Judge>
  Answer read_until(HostTime& until, Judge&& judge) noexcept; ///< `judge(byte)` ends it
  Answer find_reply(std::string_view head, HostTime& until) noexcept;
  HostTime at_most(std::chrono::milliseconds timeout) const noexcept;
  HostTime answered_by(std::chrono::milliseconds timeout) const noexcept;

  Transport& transport_;
  HostTime deadline_;
  const std::stop_token cancelled_;
  std::array<std::byte, 256> buffer_{};
  std::span<const std::byte> unread_;
  std::uint64_t bytes_received_ = 0;
  HostTime sent_at_{}; ///< the last command or question
  std::chrono::milliseconds quiet_wait_{0};
  std::chrono::milliseconds slowest_answer_{0};
};

} // namespace nendo::driver::cyberglove
