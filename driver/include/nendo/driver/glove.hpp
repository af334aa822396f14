#pragma once
// The hardware abstraction: the interface of all gloves. open_glove() (open_glove.hpp) returns only
// working gloves, so there is no half-open state.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::driver {

/// Optional features of a glove.
struct Abilities {
  bool wrist_switch = false; ///< samples contain the switch's state
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

/// A property that a glove reports, e.g. {"firmware", "2.1"}. Names are stable, lower case with
/// underscores, and end with the unit, if any; values are one printable line.
struct GloveFact {
  std::string name;
  std::string value;
};

/// The source of a glove's samples.
enum class GloveKind : std::uint8_t {
  device,    ///< a glove on a hand, or an emulated one at a port
  simulated, ///< made by this program
  recorded,  ///< read from a recording
};

struct GloveInfo {
  std::string source; ///< the GLOVE specification that opened it, e.g. "serial:/dev/ttyUSB0"
  std::string model;  ///< the reported model, one line, e.g. "CyberGlove, 22 sensors"
  Side side = Side::right;
  SensorMask sensors;   ///< the slots that samples contain
  double rate_hz = 0.0; ///< nominal records per second; 0 if unknown
  CountScale counts;
  Abilities abilities;
  std::vector<GloveFact> facts; ///< all other reported properties
  GloveKind kind = GloveKind::device;
  std::string recording; ///< the recording's path, if kind is recorded
};

/// Monotonic counts of a stream of bytes. bytes = record_bytes + discarded_bytes + a remainder
/// shorter than the longest record.
struct StreamCounters {
  std::uint64_t bytes = 0;           ///< bytes received from the device
  std::uint64_t record_bytes = 0;    ///< bytes of delivered records
  std::uint64_t discarded_bytes = 0; ///< bytes of noise, damaged records, replies
  std::uint64_t records = 0;         ///< delivered records: complete and valid
  std::uint64_t bad_records = 0;     ///< framed, with wrong length, header, checksum or content
  std::uint64_t implausible = 0;     ///< bad records with contradictory time stamp or status
  std::uint64_t missed = 0;    ///< sent, by the glove's clock, not delivered; includes bad ones
  std::uint64_t too_fast = 0;  ///< delivered, but reported as off the sampling period (`es`)
  std::uint64_t unplugged = 0; ///< records that report no glove (`eg`); not delivered
  std::uint64_t clamped = 0;   ///< out-of-range values in delivered records, clamped to the range

  /// Adds bytes that other code read from the same stream and that were no records.
  void count_discarded(std::uint64_t count) noexcept {
    bytes += count;
    discarded_bytes += count;
  }
};

/// The counts since start(). If counts_missed, records sent = records + missed, once the next valid
/// record (with 12-bit records, the next two) has arrived.
struct GloveStats : StreamCounters {
  std::uint64_t ring_refused = 0; ///< samples refused by the full ring
  std::uint64_t silences = 0;     ///< times the stream stopped and was restarted
  std::uint64_t reopened = 0;     ///< times the device vanished and was reopened
  double rate_hz = 0.0;           ///< records per second over the last second or two; 0 at first
  bool counts_missed = false;     ///< its records allow counting `missed`
};

/// Asking thread, except for functions that are thread-safe.
class NENDO_API Glove {
public:
  Glove() = default;
  Glove(const Glove&) = delete;
  Glove& operator=(const Glove&) = delete;
  virtual ~Glove() = default; ///< stops the stream if it runs; may block for a second

  /// Returns the properties at opening. Constant, even if another glove is plugged in later; each
  /// sample has its own side and sensors. Thread-safe.
  virtual const GloveInfo& info() const noexcept = 0;
  /// Starts the reader thread, which is the only producer of `ring`; the ring must outlive stop().
  /// Allowed again after stop(). May block for two seconds. Errors: no_device (it no longer
  /// answers), failed (called twice).
  virtual Result<void> start(SampleRing& ring) = 0;
  /// Ends the stream and joins the reader thread. Idempotent; may block for a second.
  virtual void stop() noexcept = 0;
  /// Thread-safe, wait-free.
  virtual GloveStats stats() const noexcept = 0;
  /// Returns whether the last sample was sent, as at the end of a recording; all samples that fit
  /// are then in the ring. Devices never end, because they may be reconnected. Thread-safe,
  /// wait-free.
  virtual bool has_ended() const noexcept { return false; }
  /// Sets the feedback; the latest call is effective, also after a reconnect. The reader thread
  /// sends it within 0.2 s. Gloves that accept commands while streaming lose no record; a
  /// CyberGlove's stream pauses. Thread-safe, does not block.
  virtual void set_feedback(const Feedback& feedback) noexcept = 0;
};

} // namespace nendo::driver
