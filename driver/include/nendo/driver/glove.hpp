#pragma once
// The hardware abstraction: whatever the glove, it is one of these. An open glove is a working
// glove; opening is open_glove()'s task (open_glove.hpp), so a half-open one does not exist.

#include <cstdint>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::driver {

struct GloveInfo {
  std::string source; ///< the GLOVE specification that opened it, e.g. "serial:/dev/ttyUSB0"
  std::string model;  ///< what the glove says it is, one line, e.g. "CyberGlove, 22 sensors"
  Side side = Side::right;
  SensorMask sensors;   ///< slots that its samples carry
  double rate_hz = 0.0; ///< nominal records a second; 0 if unknown
};

/// Monotonic counts since start(). bytes = record_bytes + discarded_bytes + a remainder shorter
/// than one record.
struct GloveStats {
  std::uint64_t bytes = 0;           ///< received from the device
  std::uint64_t record_bytes = 0;    ///< that were part of a delivered record
  std::uint64_t discarded_bytes = 0; ///< that were not: noise, damaged records, replies
  std::uint64_t records = 0;         ///< whole, valid records
  std::uint64_t bad_records = 0;     ///< framed by NUL, but of wrong length, header or content
  std::uint64_t ring_refused = 0;    ///< samples that found the ring full
  std::uint64_t silences = 0;        ///< times the stream stopped and was started again
  std::uint64_t reopened = 0;        ///< times the device vanished and was opened again
};

class Glove {
public:
  Glove() = default;
  Glove(const Glove&) = delete;
  Glove& operator=(const Glove&) = delete;
  virtual ~Glove() = default; ///< stops the stream if it runs; may block for a second

  /// What was learnt when it was opened. Constant; any thread.
  virtual const GloveInfo& info() const noexcept = 0;
  /// Starts the reader thread, which is the only producer of `ring`; the ring must outlive stop().
  /// May block for a second. Errors: no_device (it no longer answers), failed (called twice).
  virtual Result<void> start(SampleRing& ring) = 0;
  /// Ends the stream and joins the reader thread. Idempotent; may block for a second.
  virtual void stop() noexcept = 0;
  /// Any thread, wait-free.
  virtual GloveStats stats() const noexcept = 0;
};

} // namespace nendo::driver
