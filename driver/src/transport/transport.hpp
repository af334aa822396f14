#pragma once
// A Transport moves bytes to and from one device, with a time limit on every call. A driver owns
// exactly one and never sees a port's name or handle. No call throws, allocates or logs.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace nendo::driver {

enum class IoStatus : std::uint8_t {
  done,    ///< bytes were moved
  timeout, ///< the time is up
  gone,    ///< the device went away: close the transport, nothing more will come
};

struct ReadResult {
  IoStatus status = IoStatus::timeout;
  std::size_t count = 0; ///< bytes read; above 0 exactly when `status` is done
};

class Transport {
public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Waits for the first bytes and returns those that are there. `buffer` must not be empty.
  virtual ReadResult read_some(std::span<std::byte> buffer,
                               std::chrono::milliseconds timeout) noexcept = 0;
  /// Hands all bytes to the device's output buffer. After a timeout some of them may have been
  /// sent.
  virtual IoStatus write_all(std::span<const std::byte> bytes,
                             std::chrono::milliseconds timeout) noexcept = 0;
  /// Throws away what has arrived and was not read.
  virtual void discard_input() noexcept = 0;
  /// Sets the modem line RTS, which is high after opening. Returns false if the line has none.
  virtual bool set_rts(bool /*high*/) noexcept { return false; }
  /// Changes the line's rate. Returns false if the line has no rate, or not this one.
  virtual bool set_baud(int /*baud*/) noexcept { return false; }
  /// Gives a connection up: from now on every call says `gone`, so that the reader connects again.
  /// Does nothing at a port.
  virtual void hang_up() noexcept {}
};

} // namespace nendo::driver
