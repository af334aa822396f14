#pragma once
// Questions to the glove's interface unit and its answers, while it does not stream. Replies may
// contain NUL and are therefore read by length; whatever stands before a reply is skipped, since a
// unit that other programs have talked to may still be answering them.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

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
  nonsense,      ///< something came that is no answer
};

class Dialogue {
public:
  /// No call lasts beyond `deadline`, nor more than 0.3 s after `cancelled` is requested.
  /// `transport` must outlive it.
  Dialogue(Transport& transport, HostTime deadline, std::stop_token cancelled = {}) noexcept
      : transport_(transport), deadline_(deadline), cancelled_(std::move(cancelled)) {}

  /// Ends a stream and reads until the line has been quiet for 50 ms; after 500 ms of babble it
  /// gives up (nonsense).
  Answer stop_stream() noexcept;
  /// Lets the unit read the memory of a glove that was swapped, whatever it answers.
  Answer reread_glove() noexcept;
  /// `data` has the size that the query states; it is filled if the answer is good.
  Answer ask(const Query& query, std::span<std::byte> data,
             std::chrono::milliseconds timeout) noexcept;
  /// Asks for text; cut at 2048 characters.
  Answer ask_text(char letter, std::string& text, std::chrono::milliseconds timeout);
  Answer set(char letter, bool on, std::chrono::milliseconds timeout) noexcept;
  /// Starts the stream; whatever arrives from now on is records.
  Answer start_stream() noexcept;

  /// Bytes read from the transport so far.
  std::uint64_t bytes_received() const noexcept { return bytes_received_; }

private:
  Answer send(std::span<const std::byte> command) noexcept;
  Answer drain() noexcept;
  Answer next(std::byte& byte, HostTime until) noexcept;
  Answer find_reply(std::optional<char> mark, char letter, HostTime until) noexcept;
  HostTime at_most(std::chrono::milliseconds timeout) const noexcept;

  Transport& transport_;
  const HostTime deadline_;
  const std::stop_token cancelled_;
  std::array<std::byte, 256> buffer_{};
  std::span<const std::byte> unread_;
  std::uint64_t bytes_received_ = 0;
};

} // namespace nendo::driver::cyberglove
