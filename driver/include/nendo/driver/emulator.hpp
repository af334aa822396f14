#pragma once
// A CyberGlove interface unit on a pseudo-terminal: the protocol from the device's side, written
// from the published facts and not from the parser, so that it can be its test. Users test their
// own software against it.

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::driver {

/// Names that `motion` may have: rest, wave, pinch, grasp, sculpt.
std::vector<std::string_view> motion_names();

struct EmulatorOptions {
  std::string link; ///< path of the symbolic link to make to the pseudo-terminal; empty: none
  Side side = Side::right;
  unsigned sensors = 22; ///< 18 or 22
  std::string motion = "sculpt";
  double rate_hz = 90.0; ///< records a second until the host sets a period
  std::uint32_t seed = 1;
};

struct EmulatorStats {
  std::uint64_t bytes_received = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t records_sent = 0;
  std::uint64_t bytes_refused = 0; ///< not sent because the host did not read
};

class GloveEmulator {
public:
  /// Makes the pseudo-terminal and the link. Errors: usage (an option), failed (the link's place is
  /// taken by something that is not a link, or cannot be written).
  static Result<std::unique_ptr<GloveEmulator>> open(const EmulatorOptions& options);

  GloveEmulator() = default;
  GloveEmulator(const GloveEmulator&) = delete;
  GloveEmulator& operator=(const GloveEmulator&) = delete;
  virtual ~GloveEmulator() = default; ///< removes the link

  /// The terminal that a host opens, e.g. /dev/pts/4.
  virtual const std::string& tty_path() const noexcept = 0;
  /// Serves hosts, one after another, until `stop` becomes true; looks at it at least every 20 ms.
  /// Blocks.
  virtual Result<void> serve(const std::atomic<bool>& stop) = 0;
  /// Any thread.
  virtual EmulatorStats stats() const noexcept = 0;
};

} // namespace nendo::driver
