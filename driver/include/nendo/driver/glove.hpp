#pragma once
// The hardware abstraction: the interface of all gloves. open_glove() (open_glove.hpp) returns only
// working gloves, so there is no half-open state.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/driver/stream_stats.hpp>

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

struct GloveInfo {
  std::string source; ///< the GLOVE specification that opened it, e.g. "serial:/dev/ttyUSB0"
  std::string model;  ///< the reported model, one line, e.g. "CyberGlove, 22 sensors"
  Side side = Side::right;
  SensorMask sensors;   ///< the slots that samples contain
  double rate_hz = 0.0; ///< nominal records per second; 0 if unknown
  CountScale counts;
  Abilities abilities;
  std::vector<DeviceFact> facts; ///< all other reported properties
  SourceKind kind = SourceKind::device;
  std::string recording; ///< the recording's path, if kind is recorded
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
  virtual StreamStats stats() const noexcept = 0;
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
