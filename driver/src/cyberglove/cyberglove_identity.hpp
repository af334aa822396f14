#pragma once
// Identifies a glove: asks an interface unit for everything that is needed to understand its
// records, and sets it up as the user wants it. Records are as redundant as the line allows (time
// stamp, status byte).

#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/sample.hpp>

#include "cyberglove/channel_map.hpp"
#include "cyberglove/cyberglove_commands.hpp"
#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_options.hpp"
#include "cyberglove/cyberglove_parser.hpp"

namespace nendo::driver::cyberglove {

struct Identity {
  std::string model = "CyberGlove"; ///< printable ASCII, one line
  Side side = Side::right;
  std::size_t sensors = 0; ///< built in
  ChannelMap channels;     ///< of those, the ones that records carry
  RecordShape shape;
  double rate_hz = 0.0; ///< 0: as fast as the glove can, or unknown
  bool hires = false;   ///< records of 12-bit values
  bool sync = false;    ///< records at external pulses
  bool switch_drives_light = false;
  std::optional<WordOrder> word_order; ///< of ?T, once it showed
  Abilities abilities;
  std::vector<GloveFact> facts;
  std::vector<std::string> notes; ///< what was decided for the user, a line each
};

/// The settings that the user wants, and what is already known of the unit.
struct Request {
  Options options;
  int baud = 0;                        ///< at which the unit answered
  std::optional<WordOrder> word_order; ///< of ?T, as an earlier identity had it
};

/// Asks the unit and sets it up; greet() must have been called. Blocks until done or until the
/// dialogue's deadline. The message of an error begins with `source`. Errors: no_device; usage, if
/// the unit or its line cannot do what an option asks for.
Result<Identity> identify(Dialogue& dialogue, const std::string& source, const Request& request);

/// Judges the reply to ?G. `asked` says how it was asked. Error: no_device, with the reason why
/// there is no working glove.
Result<void> check_state(const std::string& source, const Reply<GloveState>& reply,
                         const std::string& asked);

} // namespace nendo::driver::cyberglove
