#pragma once
// The interface of all trackers, which measure where wrists are. One tracker has one or more
// stations, and each station can move one hand. open_trackers() (open_tracker.hpp) returns only
// working trackers.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/pose_sample.hpp>
#include <nendo/driver/stream_stats.hpp>

namespace nendo::driver {

/// The turn from the axes of a transmitter (x to the front, y to the right, z down), as FASTRAK and
/// Flock of Birds have them, to those of the stage (x to the operator's right, y up, z towards the
/// operator). The transmitter's x points away from the operator.
inline constexpr std::array<double, 4> stage_from_z_down_xyzw{0.5, 0.5, -0.5, 0.5};

struct TrackerInfo {
  /// The first TRACKER specification that opened it, e.g. "fastrak:/dev/ttyUSB2". Messages about
  /// one station say TrackerStation::source.
  std::string source;
  std::string model;                   ///< the reported model, one line
  std::vector<std::uint16_t> stations; ///< that deliver poses, in the order of the request
  /// Nominal poses per second of all stations together; 0 if unknown.
  double rate_hz = 0.0;
  /// The usual turn from the tracker's axes to the stage's; a calibration can replace it.
  std::array<double, 4> stage_from_tracker_xyzw{0, 0, 0, 1};
  bool is_filtered = false;      ///< the device or its server filters the poses already
  std::vector<DeviceFact> facts; ///< all other reported properties
  SourceKind kind = SourceKind::device;
  /// The specification and the station by which another program has opened the tracker, if that
  /// program shares it (`serve:`); else empty.
  std::string shared_source;
  std::uint16_t shared_station = 0;
};

/// The ring of a station's poses.
struct StationRing {
  std::uint16_t station = 0;
  PoseRing* ring = nullptr;
};

/// Asking thread, except for functions that are thread-safe.
class NENDO_API Tracker {
public:
  Tracker() = default;
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;
  virtual ~Tracker() = default; ///< stops the stream if it runs; may block for a second

  /// Returns the properties at opening. Constant. Thread-safe.
  virtual const TrackerInfo& info() const noexcept = 0;
  /// Starts the reader thread, which is the only producer of the rings. They must outlive stop().
  /// A station may have several rings. Poses of a station without a ring are dropped. Allowed again
  /// after stop(). May block for two seconds. Errors: no_device (it no longer answers), failed
  /// (called twice).
  virtual Result<void> start(std::span<const StationRing> rings) = 0;
  /// Ends the stream and joins the reader thread. Idempotent; may block for a second.
  virtual void stop() noexcept = 0;
  /// The counts of all stations together. Thread-safe, wait-free.
  virtual StreamStats stats() const noexcept = 0;
  /// As Glove::has_ended(). Thread-safe, wait-free.
  virtual bool has_ended() const noexcept { return false; }
};

} // namespace nendo::driver
