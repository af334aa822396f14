#pragma once
// Commands and queries to the glove's interface unit while it does not stream: Dialogue sends and
// receives bytes, and Commands makes the driver's commands of them and decodes the replies;
// cyberglove_protocol.hpp has the bytes. Replies may contain NUL and are therefore read by length.
// Bytes before a reply are skipped, since the unit may still be answering another program.

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

#include "cyberglove/cyberglove_options.hpp"
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
  other_value,   ///< the unit took another value
  nonsense,      ///< bytes came that are no answer
};

/// The last bytes received, in which short patterns are recognised.
class Tail {
public:
  void push(std::byte byte) noexcept {
    bytes_ = bytes_ << 8U | std::to_integer<std::uint64_t>(byte);
  }
  /// Returns true if the bytes received end with `pattern`, at most 8 bytes, and then `back` more.
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

  /// Sets the min time to wait for the first byte of an answer: a slow unit is quiet before it
  /// answers, while another device may send bytes without end.
  void wait_on_quiet_line(std::chrono::milliseconds time) noexcept { quiet_wait_ = time; }
  /// Lets calls last until `deadline`, if that is later.
  void prolong(HostTime deadline) noexcept { deadline_ = std::max(deadline_, deadline); }
  /// Expects answers to take this time, e.g. as in an earlier dialogue with the same unit.
  void expect_late_answers(std::chrono::milliseconds time) noexcept {
    slowest_answer_ = std::max(slowest_answer_, time);
  }
  /// Returns how long the slowest good answer took to arrive.
  std::chrono::milliseconds slowest_answer() const noexcept { return slowest_answer_; }

  /// Ends a stream and reads until the line has been quiet for 50 ms. Gives up with `nonsense` if
  /// bytes still come after `max_time`.
  Answer stop_stream(std::chrono::milliseconds max_time = max_drain) noexcept;
  /// Ends a stream and reads up to the answer. It is quicker, but needs a line without noise.
  Answer pause_stream(std::chrono::milliseconds timeout) noexcept;
  /// Asks for data as long as `data`, which are filled if the answer is good.
  Answer ask(char letter, std::span<std::byte> data, std::chrono::milliseconds timeout) noexcept;
  /// Asks for text, which is cut at 2048 characters.
  Answer ask_text(char letter, std::string& text, std::chrono::milliseconds timeout);
  /// Sends a command that is confirmed by `echo` and NUL, perhaps with a byte between them. `echo`
  /// has 1 to 4 characters.
  Answer command(std::span<const std::byte> bytes, std::string_view echo,
                 std::chrono::milliseconds timeout) noexcept;
  /// Sends a command that begins a stream. All bytes that arrive from now on are records.
  Answer start_stream(std::string_view command) noexcept;

  /// Returns how many bytes were read from the transport so far.
  std::uint64_t bytes_received() const noexcept { return bytes_received_; }

  static constexpr std::chrono::milliseconds max_drain{500};

private:
  Answer send(std::span<const std::byte> command) noexcept;
  Answer drain(std::chrono::milliseconds max_time) noexcept;
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
  HostTime sent_at_{}; ///< time of the last command or query
  std::chrono::milliseconds quiet_wait_{0};
  std::chrono::milliseconds slowest_answer_{0};
};

/// A reply. `value` is valid only if the answer is good.
template <class T>
struct Reply {
  Answer answer = Answer::silent;
  T value{};
  explicit operator bool() const noexcept { return answer == Answer::good; }
};

/// The offsets and gains by which the unit quantises values. The first `sensors` of each are valid.
struct HardwareCalibration {
  std::size_t sensors = 0;
  std::array<std::uint8_t, sensor_slots> offset{};
  std::array<std::uint8_t, sensor_slots> gain{};
};

/// Each call waits for its reply, at most `timeout` unless stated otherwise.
class Commands {
public:
  explicit Commands(Dialogue& dialogue, std::chrono::milliseconds timeout) noexcept
      : dialogue_(dialogue), timeout_(timeout) {}

  Reply<std::string> information(); ///< several lines; up to 1 s
  Reply<std::string> firmware_text();
  Reply<HardwareCalibration> hardware_calibration(std::size_t sensors) noexcept;
  template <class T>
  Reply<T> ask(Query<T> query) noexcept;

  /// Sends a command of raw bytes.
  Answer send(std::string_view head, std::span<const std::uint8_t> arguments = {}) noexcept;
  Answer send(std::string_view head, std::uint8_t argument) noexcept;

  // Settings, which the unit forgets when it is switched off.
  Reply<bool> get(Setting setting) noexcept;
  Answer set(Setting setting, bool on) noexcept;
  Answer set_software_mask(SensorMask mask) noexcept;
  /// Sets the period in text, which has no byte order, and then asks for it in bytes. The value is
  /// the byte order that the reply shows, if the unit knows the query. bad_rate and bad_number mean
  /// that the unit refuses, and other_value that it set another period.
  Reply<std::optional<WordOrder>> set_period(Period period) noexcept;
  Answer set_vibration(const Vibration& strength) noexcept;

private:
  Dialogue& dialogue_;
  const std::chrono::milliseconds timeout_;
};

} // namespace nendo::driver::cyberglove
