#pragma once
// The life of a stream of bytes, which is the same for gloves and trackers: the reader thread, its
// counts, silence, loss and return of the device. A protocol decodes the bytes.

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <utility>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/reader_thread.hpp>
#include <nendo/driver/stream_stats.hpp>

#include "stream/stream_protocol.hpp"
#include "transport/transport.hpp"

namespace nendo::driver {

/// Opens the device. The reader thread calls it again whenever the device has vanished.
using OpenPort = std::function<Result<std::unique_ptr<Transport>>()>;

/// Max time to open a device.
inline constexpr std::chrono::milliseconds open_budget{4000};

/// StreamStats, written by the reader thread and read by any.
struct SharedStats {
  std::array<std::atomic<std::uint64_t>, 10> counted{};
  std::atomic<std::uint64_t> ring_refused{0}, silences{0}, reopened{0};
  std::atomic<double> rate_hz{0.0};
  std::atomic<bool> counts_missed{false};

  /// `now` and `then` are the protocol's counters, which outlive a stop() and another start().
  void store(const StreamCounters& now, const StreamCounters& then) noexcept;
  StreamStats load() const noexcept;
};

/// The base of a streaming device, whose destructor must call end(). Asking thread, except the
/// members for the reader thread.
class DeviceStream {
protected:
  /// `source` begins the messages; 0 is an unknown rate.
  DeviceStream(std::string source, double rate_hz, OpenPort open_port,
               std::unique_ptr<Transport> transport, StreamProtocol& protocol);
  ~DeviceStream() = default;

  /// Starts the stream and its reader thread. Errors: failed (called twice), no_device.
  Result<void> begin();
  void end() noexcept { reader_.stop(); }
  bool is_running() const noexcept { return reader_.is_running(); }
  StreamStats stream_stats() const noexcept { return stats_.load(); }

  // Reader thread:

  /// Passes the next bytes to the protocol.
  virtual void push(std::span<const std::byte> chunk, HostTime arrival) noexcept = 0;
  /// Asks again who is there, and sets it up as before.
  virtual Result<void> identify(Transport& transport, IdentifyReason reason,
                                const ReplyDeadline& limit) = 0;
  /// Called after each read.
  virtual void after_read(Transport& transport, const std::stop_token& token) noexcept {
    (void)transport, (void)token;
  }
  /// Sets the number of a sample that push() brought, and the times that the protocol did not set.
  template <class Sample>
  void stamp(Sample& sample) noexcept {
    if (sample.arrival == HostTime{}) sample.arrival = arrival_;
    if (!sample.has_device_time && sample.measured == HostTime{}) sample.measured = sample.arrival;
    sample.sequence = sequence_++;
  }
  /// Counts a good sample, which the ring took or refused.
  void count_sample(bool taken) noexcept;
  void count_bad() noexcept { ++bad_since_record_; }

private:
  enum class StreamEnd { stopped, silent, doubtful, gone };

  void run(const std::stop_token& token);
  StreamEnd stream(const std::stop_token& token);
  void revive(const std::stop_token& token);
  void reopen(const std::stop_token& token);
  bool restart(const std::stop_token& token, IdentifyReason reason);
  HostClock::duration max_silence() const noexcept;
  void skip_backlog(HostClock::duration waited) noexcept;
  void measure_rate(HostTime now);
  void store_counts() noexcept;

  const std::string source_;
  const double rate_hz_;
  const OpenPort open_port_;
  SharedStats stats_;

  // Used by the reader thread only, while it runs.
  std::unique_ptr<Transport> transport_; ///< null while the device is away
  StreamProtocol& protocol_;
  std::string complaint_; ///< the last reported reason why it does not come back
  StreamCounters at_start_;
  HostTime arrival_{};
  HostTime last_record_{};
  HostTime window_begin_{};
  std::uint64_t window_begins_with_ = 0; ///< the first sample of the window
  std::uint64_t sequence_ = 0;
  std::uint64_t bad_since_record_ = 0; ///< bad ones since the last good one
  double rate_reported_hz_ = 0.0;
  bool caught_up_ = false;  ///< what had waited for begin() has been read
  bool outage_ = false;     ///< no record since the stream broke off
  bool unanswered_ = false; ///< the last question who is there had no good answer

  ReaderThread reader_; // last: joined before what it uses is gone
};

/// Opens the port, identifies the device by `deadline`, and makes a Stream of it. Errors: those of
/// `open_port` and of DeviceProtocol::identify.
template <class Device, class Stream, class Protocol>
Result<std::unique_ptr<Device>> open_stream(const std::string& source, OpenPort open_port,
                                            std::unique_ptr<Protocol> protocol, HostTime deadline) {
  auto transport = open_port();
  if (!transport) return transport.error();
  (*transport)->discard_input();
  auto info = protocol->identify(**transport, source, IdentifyReason::opening, {deadline, {}});
  if (!info) return info.error();
  info->source = source;
  return std::unique_ptr<Device>(std::make_unique<Stream>(
      *std::move(info), std::move(open_port), *std::move(transport), std::move(protocol)));
}

} // namespace nendo::driver
