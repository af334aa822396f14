#pragma once
// The hardware abstraction: whatever the glove, it is one of these. An open glove is a working
// glove; opening is open_glove()'s task (open_glove.hpp), so a half-open one does not exist.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::driver {

/// What a glove can do besides measuring.
struct Abilities {
  bool wrist_switch = false; ///< its samples have the switch's position
  bool light = false;        ///< a light at the wrist
  bool vibration = false;    ///< six vibrators: thumb to little finger, palm (CyberTouch)
  bool resistance = false;   ///< brakes on the five fingers (LucidGloves)
};

/// Light and forces for the wearer. Fields that the glove does not support are ignored.
struct Feedback {
  bool light = false;
  std::array<std::uint8_t, 6> vibration{};   ///< 0 to 255
  std::array<std::uint16_t, 5> resistance{}; ///< 0 (free) to 1000, thumb to little finger
  friend bool operator==(const Feedback&, const Feedback&) = default;
};

/// One thing that a glove says of itself, e.g. {"firmware", "2.1"}. Names are stable, lower case
/// with underscores, a unit at the end where there is one; values are one printable line.
struct GloveFact {
  std::string name;
  std::string value;
};

/// Where a glove's samples come from.
enum class GloveKind : std::uint8_t {
  device,    ///< a glove on a hand, or an emulated one at a port
  simulated, ///< made by this program
  recorded,  ///< read from a recording
};

struct GloveInfo {
  std::string source; ///< the GLOVE specification that opened it, e.g. "serial:/dev/ttyUSB0"
  std::string model;  ///< what the glove says it is, one line, e.g. "CyberGlove, 22 sensors"
  Side side = Side::right;
  SensorMask sensors;   ///< slots that its samples carry
  double rate_hz = 0.0; ///< nominal records per second; 0 if unknown
  CountScale counts;
  Abilities abilities;
  std::vector<GloveFact> facts; ///< everything else that it says of itself
  GloveKind kind = GloveKind::device;
  std::string recording; ///< the recording's path, if it is `recorded`
};

/// Monotonic counts of a stream of bytes. bytes = record_bytes + discarded_bytes + a remainder
/// shorter than the longest record.
struct StreamCounters {
  std::uint64_t bytes = 0;           ///< received from the device
  std::uint64_t record_bytes = 0;    ///< that were part of a delivered record
  std::uint64_t discarded_bytes = 0; ///< that were not: noise, damaged records, replies
  std::uint64_t records = 0;         ///< delivered: whole, valid records
  std::uint64_t bad_records = 0;     ///< framed, but of wrong length, header, checksum or content
  std::uint64_t implausible =
      0; ///< the bad ones that are well formed, but whose time stamp or status contradicts
  std::uint64_t missed = 0;    ///< sent, by the glove's own clock, and not delivered; the bad
                               ///< ones among them
  std::uint64_t too_fast = 0;  ///< delivered, but sampled off the period, as the glove says (`es`)
  std::uint64_t unplugged = 0; ///< records without a glove (`eg`), not delivered
  std::uint64_t clamped = 0;   ///< values in delivered records that were out of range, and count as
                               ///< the nearer end of it

  /// Counts bytes that were read from the same stream elsewhere and that were no records.
  void count_discarded(std::uint64_t count) noexcept {
    bytes += count;
    discarded_bytes += count;
  }
};

/// The counts since start(). For a glove that counts_missed: records sent = records + missed, as
/// soon as the next good record has arrived (with 12-bit records: the next two).
struct GloveStats : StreamCounters {
  std::uint64_t ring_refused = 0; ///< samples that found the ring full
  std::uint64_t silences = 0;     ///< times the stream stopped and was started again
  std::uint64_t reopened = 0;     ///< times the device vanished and was opened again
  double rate_hz = 0.0;           ///< records per second over the last second or two; 0 at first
  bool counts_missed = false;     ///< its records let `missed` be counted
};

/// Asking thread, but for the functions that are thread-safe.
class NENDO_API Glove {
public:
  Glove() = default;
  Glove(const Glove&) = delete;
  Glove& operator=(const Glove&) = delete;
  virtual ~Glove() = default; ///< stops the stream if it runs; may block for a second

  /// The glove's properties when it was opened. Constant, even if another glove is plugged in
  /// later: each sample has its hand and sensors. Thread-safe.
  virtual const GloveInfo& info() const noexcept = 0;
  /// Starts the reader thread, which is the only producer of `ring`; the ring must outlive stop().
  /// After stop() it may be started again. May block for two seconds. Errors: no_device (it no
  /// longer answers), failed (called twice).
  virtual Result<void> start(SampleRing& ring) = 0;
  /// Ends the stream and joins the reader thread. Idempotent; may block for a second.
  virtual void stop() noexcept = 0;
  /// Thread-safe, wait-free.
  virtual GloveStats stats() const noexcept = 0;
  /// Returns whether the glove has sent its last sample since start(), as a recording at its end;
  /// all that fit is in the ring then. A device may always come back, and so never ends.
  /// Thread-safe, wait-free.
  virtual bool has_ended() const noexcept { return false; }
  /// Sets the feedback to show. The latest call wins, also after a reconnect. The reader thread
  /// sends it: within 0.2 s, without losing a record of gloves that take commands while they
  /// stream; a CyberGlove's stream pauses for it. Thread-safe, does not block.
  virtual void set_feedback(const Feedback& feedback) noexcept = 0;
};

} // namespace nendo::driver
