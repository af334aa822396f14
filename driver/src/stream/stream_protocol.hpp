#pragma once
// What differs between devices that send a stream of bytes: how to identify one, and what its bytes
// mean. Everything else is the same for all of them and is in DeviceStream.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/stream_stats.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// The time limit of a dialogue: it ends at `deadline`, and within 0.3 s after `cancelled` is
/// requested.
struct ReplyDeadline {
  HostTime deadline;
  std::stop_token cancelled;
};

/// Returns the no_device error for a device that went away while it was used.
inline Error went_away(const std::string& source) {
  return {Errc::no_device, source + " went away; is the cable loose?"};
}

/// Why a device is identified.
enum class IdentifyReason : std::uint8_t {
  opening,  ///< the first time
  reviving, ///< it fell silent, or its port was opened again
  damaged,  ///< its records became unreadable: another device may have been plugged in
};

/// Takes the samples that a protocol decodes. The sink sets `sequence`, and also `arrival` and
/// `measured` where the protocol does not know them, and has left them zero.
template <class Sample>
class SampleSink {
public:
  virtual void deliver(Sample& sample) noexcept = 0;
  /// Reports a record that is damaged or not plausible.
  virtual void reject() noexcept = 0;

protected:
  ~SampleSink() = default;
};

/// A protocol is used by one thread at a time: first by the one that opens the device, then by the
/// reader. No call waits longer than 0.1 s without checking its ReplyDeadline.
class StreamProtocol {
public:
  StreamProtocol() = default;
  StreamProtocol(const StreamProtocol&) = delete;
  StreamProtocol& operator=(const StreamProtocol&) = delete;
  virtual ~StreamProtocol() = default;

  /// Starts the stream. All bytes that come from now on go to push(). Error: no_device.
  virtual Result<void> start_stream(Transport& transport, const std::string& source,
                                    const ReplyDeadline& limit) {
    (void)transport, (void)source, (void)limit; // a device that streams whenever it is read
    return {};
  }
  virtual void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept {
    (void)transport, (void)limit;
  }
  /// Writes what the device waits for before it sends more, if it is of that kind. Called after
  /// each push(), also when nothing had come for 0.1 s. Must not wait for the device, or the reader
  /// falls behind. If the device went away, the next read reports it.
  virtual void answer(Transport& transport) noexcept { (void)transport; }
  /// Returns true once the device may have been exchanged. identify() must then be called before
  /// further records can be trusted.
  virtual bool is_doubtful() const noexcept { return false; }
  virtual const StreamCounters& counters() const noexcept = 0;
  /// Returns true while StreamCounters::missed is all that was lost of the stream.
  virtual bool counts_missed() const noexcept { return false; }
  /// Returns how long a read may wait before push() is called without bytes, if that must be soon,
  /// because the protocol delivers samples that no byte announces.
  virtual std::chrono::milliseconds max_wait() const noexcept {
    return std::chrono::milliseconds(100);
  }
  /// Returns how long a working device may send no record, if it is one that takes its time.
  virtual HostClock::duration max_pause() const noexcept { return {}; }
};

/// The part of a protocol that depends on what the device delivers.
template <class Sample, class Info>
class DeviceProtocol : public StreamProtocol {
public:
  using Sink = SampleSink<Sample>;

  /// Ends whatever streams, asks the device who it is and sets it up. `source` begins the messages.
  /// Error: no_device; usage, if the device cannot do what an option asks for.
  virtual Result<Info> identify(Transport& transport, const std::string& source,
                                IdentifyReason reason, const ReplyDeadline& limit) = 0;
  /// Takes the next bytes of the stream, cut anywhere. The last of them arrived at `arrival`.
  virtual void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept = 0;
};

} // namespace nendo::driver
