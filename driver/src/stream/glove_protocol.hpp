#pragma once
// What differs between kinds of gloves: how to identify one, and what its bytes mean. Everything
// else is the same for all of them and is in StreamGlove.

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>

#include "stream/stream_parser.hpp"
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

/// Why a glove is identified.
enum class IdentifyReason : std::uint8_t {
  opening,  ///< the first time
  reviving, ///< it fell silent, or its port was opened again
  damaged,  ///< its records became unreadable: another glove may have been plugged in
};

/// Takes the samples that a protocol decodes. The sink sets `sequence` and `arrival`, and also
/// `measured` if the glove has no clock.
class SampleSink {
public:
  virtual void deliver(GloveSample& sample) noexcept = 0;
  /// Reports a record that is damaged or not plausible.
  virtual void reject() noexcept = 0;

protected:
  ~SampleSink() = default;
};

/// A protocol is used by one thread at a time: first by the one that opens the glove, then by the
/// reader. No call waits longer than 0.1 s without checking its ReplyDeadline.
class GloveProtocol {
public:
  GloveProtocol() = default;
  GloveProtocol(const GloveProtocol&) = delete;
  GloveProtocol& operator=(const GloveProtocol&) = delete;
  virtual ~GloveProtocol() = default;

  /// Ends whatever streams, asks the device who it is and sets it up. `source` begins the messages.
  /// Error: no_device; usage, if the device cannot do what an option asks for.
  virtual Result<GloveInfo> identify(Transport& transport, const std::string& source,
                                     IdentifyReason reason, const ReplyDeadline& limit) = 0;
  /// Starts the stream. All bytes that come from now on go to push(). Error: no_device.
  virtual Result<void> start_stream(Transport& transport, const std::string& source,
                                    const ReplyDeadline& limit) {
    (void)transport, (void)source, (void)limit; // a glove that streams whenever it is read
    return {};
  }
  virtual void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept {
    (void)transport, (void)limit;
  }
  /// Takes the next bytes of the stream, cut anywhere. The last of them arrived at `arrival`.
  virtual void push(std::span<const std::byte> chunk, HostTime arrival,
                    SampleSink& sink) noexcept = 0;
  /// Writes what the device waits for before it sends more, if it is of that kind. Called after
  /// each push(), also when nothing had come for 0.1 s. Must not wait for the device, or the reader
  /// falls behind. If the device went away, the next read reports it.
  virtual void answer(Transport& transport) noexcept { (void)transport; }
  /// Returns true once the device may have been exchanged. identify() must then be called before
  /// further records can be trusted.
  virtual bool is_doubtful() const noexcept { return false; }
  /// Shows `feedback` while the glove streams. If the device went away, the next read reports it.
  virtual void set_feedback(Transport& transport, const Feedback& feedback,
                            const ReplyDeadline& limit) noexcept {
    (void)transport, (void)feedback, (void)limit;
  }
  virtual const StreamCounters& counters() const noexcept = 0;
  /// Returns true while StreamCounters::missed is all that was lost of the stream.
  virtual bool counts_missed() const noexcept { return false; }
  /// Returns how long a working device may send no record, if it is one that takes its time.
  virtual HostClock::duration max_pause() const noexcept { return {}; }
};

} // namespace nendo::driver
