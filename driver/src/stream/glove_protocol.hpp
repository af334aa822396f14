#pragma once
// What one kind of glove knows and others do not: how to ask it who it is, and what its bytes mean.
// The rest of a glove's life is the same for all of them: StreamGlove.

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>

#include "stream/stream_counters.hpp"
#include "transport/transport.hpp"

namespace nendo::driver {

/// How long a dialogue may take: it ends at `deadline`, and within 0.3 s after `cancelled` is
/// requested.
struct ReplyDeadline {
  HostTime deadline;
  std::stop_token cancelled;
};

/// no_device: the transport said so in the middle of something.
inline Error went_away(const std::string& source) {
  return {Errc::no_device, source + " went away; is the cable loose?"};
}

/// Why a glove is asked who it is.
enum class IdentifyReason : std::uint8_t {
  opening,  ///< for the first time
  reviving, ///< it fell silent, or its port was opened again
  damaged,  ///< its records became unreadable: another glove may have been plugged in
};

/// Takes what a protocol made of its bytes. `sequence`, and `arrival`, are set by the sink;
/// `measured` too where the glove has no clock.
class SampleSink {
public:
  virtual void deliver(GloveSample& sample) noexcept = 0;
  /// A record came that is damaged or cannot be believed.
  virtual void reject() noexcept = 0;

protected:
  ~SampleSink() = default;
};

/// Used by one thread at a time: first the one that opens, then the reader. No call waits longer
/// than 0.1 s without looking at its ReplyDeadline.
class GloveProtocol {
public:
  GloveProtocol() = default;
  GloveProtocol(const GloveProtocol&) = delete;
  GloveProtocol& operator=(const GloveProtocol&) = delete;
  virtual ~GloveProtocol() = default;

  /// Ends whatever streams, asks the device who it is and sets it up. `source` begins the messages.
  /// Error: no_device; usage, if the device cannot do what an option asks for.
  virtual Result<GloveInfo> identify(Transport& transport, const std::string& source,
                                     IdentifyReason occasion, const ReplyDeadline& patience) = 0;
  /// Starts the stream; whatever comes from now on is for push(). Error: no_device.
  virtual Result<void> start_stream(Transport& transport, const std::string& source,
                                    const ReplyDeadline& patience) = 0;
  virtual void end_stream(Transport& transport, const ReplyDeadline& patience) noexcept = 0;
  /// Takes the next bytes of the stream, cut anywhere; the last of them arrived at `arrival`.
  virtual void push(std::span<const std::byte> chunk, HostTime arrival,
                    SampleSink& sink) noexcept = 0;
  /// True once the device may be another one than it was: identify() has to tell before more of its
  /// records can be believed.
  virtual bool is_doubtful() const noexcept { return false; }
  /// Shows `feedback`, while it streams. A device that went away shows itself at the next read.
  virtual void set_feedback(Transport& transport, const Feedback& feedback,
                            const ReplyDeadline& patience) noexcept {
    (void)transport, (void)feedback, (void)patience;
  }
  virtual const StreamCounters& counters() const noexcept = 0;
};

} // namespace nendo::driver
