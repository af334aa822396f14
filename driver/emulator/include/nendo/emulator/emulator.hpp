#pragma once
// Emulates the electronics of a data glove or a tracker on a pseudo-terminal. It was written from
// the published facts of each protocol and not from the driver's parser, so that each can test the
// other. Users test their own software against it, with the faults of real lines and real people.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::emulator {

enum class DeviceType : std::uint8_t { glove, tracker };

/// A name that EmulatorOptions::device may have.
struct EmulatedDevice {
  std::string_view name;
  DeviceType type = DeviceType::glove;
};
std::vector<EmulatedDevice> emulated_devices();

/// Returns the names that EmulatorOptions::motion may have.
std::vector<std::string_view> emulated_motions(DeviceType type);

/// A value that EmulatorOptions::firmware or ::connection may have, for which glove, and what a
/// glove like that does. The first one of each glove and option is the default.
struct EmulatedVariant {
  std::string_view glove;
  std::string_view option; ///< firmware or connection
  std::string_view name;
  std::string_view effect;
};
std::vector<EmulatedVariant> emulated_variants();

/// How a fault is written, e.g. drop=RATE%, and what it does.
struct FaultForm {
  std::string_view form;
  std::string_view effect;
};
std::vector<FaultForm> fault_forms();

enum class EmulatorPace : std::uint8_t {
  clock, ///< as a device: one record per period, lost if no host reads it
  host,  ///< a record whenever the host can take it; each advances the device's clock by a period
};

/// Options for CyberGloves only.
struct EmulatedCyberGlove {
  unsigned model = 1;              ///< CyberGlove I, II or III
  std::uint32_t hardware_mask = 0; ///< the sensors that the glove has; 0: the usual ones
  bool touch = false;              ///< it has the vibrators of a CyberTouch
  unsigned reply_bytes = 2; ///< length of a set command's reply: 2, or 3 as one library expects
  bool period_low_first = false; ///< the order of the bytes in the words of T and ?T
  bool stamp_bit7 =
      true; ///< bit 7 of a time stamp's first byte is always set; false: only if it must
  /// 12-bit streams of a CyberGlove III: 1S is echoed with a NUL, so is the 0x03 that ends them,
  /// and sub-frames count from 1. False: without NUL and from 0, as programs for the hardware read
  /// them.
  bool hires_terminated = false;
  /// Until it answers 0x12, or hears again after a power cut: 0 to 60. The maker's own library
  /// reads the answer after 0.25 s; the manual says 1.75 s.
  double restart_s = 0.2;
  /// When it is switched on its period is half its shortest one, so that the records of a stream
  /// end in es until the host sets another.
  bool overrun = false;
  bool streaming = false; ///< it streams from the start, as after a host that died
  /// If set, there is no motion: in record n the sensor of slot k has the count 1 + (n + 29 k) mod
  /// 255, or 16 times that with 12 bits. So every record can be judged by itself.
  bool pattern = false;
  std::string replay = {}; ///< a file of bytes that a host received: its records are sent
  /// If set, what the hand does in place of EmulatorOptions::motion: the angle of each sensor's
  /// joint, radians, at a time in seconds since the first record. Called by the thread that serves.
  std::function<std::array<double, sensor_slots>(double time_s)> played = {};
};

/// Options for trackers only.
struct EmulatedTracker {
  std::vector<unsigned> stations{1, 2}; ///< into which receivers are plugged, from 1
  bool noise = false;                   ///< the device's own noise, instead of exact poses
  /// The rate of its serial line. A host at another one receives garbage and is not heard.
  unsigned baud = 115200;
  double restart_s = 10.0; ///< until it hears again after a restart: 0 to 60
};

struct EmulatorOptions {
  std::string device = "cyberglove"; ///< one of emulated_devices()
  std::string firmware = {};         ///< one of emulated_variants(); empty: the default
  std::string connection = {};       ///< one of emulated_variants(); empty: the default
  std::string link = {}; ///< path of the symbolic link to make to the terminal; empty: none
  Side side = Side::right;
  unsigned sensors = 0; ///< 0: as many as this kind of glove usually has
  /// One of emulated_motions(); empty: sculpt, or of a tracker orbit.
  std::string motion = {};
  double rate_hz = 90.0; ///< records of a glove per second until the host sets a period
  std::uint32_t seed = 1;
  EmulatorPace pace = EmulatorPace::clock;
  std::vector<std::string> faults = {}; ///< each in one of the forms of fault_forms()
  std::string log = {};                 ///< a file to write all traffic to; empty: none
  EmulatedCyberGlove cyberglove = {};
  EmulatedTracker tracker = {};
};

struct FaultCount {
  std::string name; ///< as in fault_forms(), e.g. drop
  std::uint64_t done = 0;
};

struct EmulatorStats {
  std::uint64_t bytes_received = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t records_sent = 0;      ///< whole ones that the unit gave, before any fault
  std::uint64_t records_faulted = 0;   ///< records that a fault touched, or joined to junk
  std::uint64_t bytes_refused = 0;     ///< not sent because no host read them
  std::vector<FaultCount> faults = {}; ///< one for each kind in EmulatorOptions::faults
};

class DeviceEmulator {
public:
  /// Makes the pseudo-terminal and the link. Errors: usage (an option), bad_input (the file to
  /// replay), failed (the link's place is taken by something that is not a link, or link or log
  /// cannot be written).
  static Result<std::unique_ptr<DeviceEmulator>> open(const EmulatorOptions& options);

  DeviceEmulator() = default;
  DeviceEmulator(const DeviceEmulator&) = delete;
  DeviceEmulator& operator=(const DeviceEmulator&) = delete;
  virtual ~DeviceEmulator() = default; ///< removes the link

  /// Returns the terminal that a host opens at first, e.g. /dev/pts/4. After the fault `unplug`
  /// there is another one, which the link leads to.
  virtual const std::string& tty_path() const noexcept = 0;
  /// Serves hosts, one after another, until `stop` becomes true and all sent bytes have gone out.
  /// Checks `stop` at least every 20 ms, and waits 300 ms for a host that takes nothing. Blocks.
  /// Error: failed.
  virtual Result<void> serve(const std::atomic<bool>& stop) = 0;
  /// Returns the counts so far. May be called from any thread.
  virtual EmulatorStats stats() const = 0;
};

} // namespace nendo::emulator
