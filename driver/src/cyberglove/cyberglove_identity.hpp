#pragma once
// Who is there: asks an interface unit everything that is needed to understand its records, and
// makes them as redundant as it can (time stamp, status byte).

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>

#include "cyberglove/channel_map.hpp"
#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_parser.hpp"

namespace nendo::driver::cyberglove {

struct Identity {
  std::string model; ///< printable ASCII, one line
  Side side = Side::right;
  ChannelMap channels;
  RecordShape shape;
  double rate_hz = 0.0; ///< 0: as fast as the glove can, or unknown
};

/// Ends a stream that runs, asks and sets. Blocks until done or until the dialogue's deadline.
/// Error: no_device; its message begins with `source`.
Result<Identity> identify(Dialogue& dialogue, const std::string& source);

/// Is a working glove plugged in and answering? Error: no_device, as above.
Result<void> check_state(Dialogue& dialogue, const std::string& source);

/// Records a second from the two words that ?T tells. Sources disagree on their byte order; the
/// wrong one yields an absurdly slow rate, so the faster plausible reading is taken. 0: unknown or
/// unlimited.
double rate_of_period(std::span<const std::byte, 4> words) noexcept;

} // namespace nendo::driver::cyberglove
