#pragma once
// Finds the line rate of a glove's interface unit, and identifies the glove: asks it for everything
// that is needed to understand its records, and sets it up as the user wants it. Records are as
// redundant as the line allows (time stamp, status byte).

#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/sample.hpp>

#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_options.hpp"
#include "cyberglove/cyberglove_parser.hpp"

namespace nendo::driver::cyberglove {

struct Identity {
  std::string model = "CyberGlove"; ///< printable ASCII, one line
  Side side = Side::right;
  std::size_t sensors = 0; ///< built-in sensors
  ChannelMap channels;     ///< the sensors that records carry
  RecordShape shape;
  double rate_hz = 0.0; ///< 0: as fast as the glove can, or unknown
  bool hires = false;   ///< records of 12-bit values
  bool sync = false;    ///< records at external pulses
  bool switch_drives_light = false;
  std::optional<WordOrder> word_order; ///< byte order of the reply to ?T, once known
  Abilities abilities;
  std::vector<DeviceFact> facts;
  std::vector<std::string> notes; ///< decisions that the user should know, one line each
};

/// The wanted settings, and facts about the unit that are known already.
struct Request {
  Options options;
  int baud = 0;                        ///< the rate at which the unit answered
  std::optional<WordOrder> word_order; ///< from an earlier identity
};

/// Asks the unit and sets it up; greet() must have been called. Blocks until done or until the
/// dialogue's deadline. The message of an error begins with `source`. Errors: no_device; usage, if
/// the unit or its line cannot do what an option asks for.
Result<Identity> identify(Dialogue& dialogue, const std::string& source, const Request& request);

/// Checks the reply to ?G. Error: no_device, with the reason why there is no working glove; its
/// message names `query`.
Result<void> check_state(const std::string& source, const Reply<GloveState>& reply,
                         const std::string& query);

struct Greeting {
  int baud = 0; ///< the rate at which the unit answered
  Reply<GloveState> reply;
  std::string query; ///< the query and the rates tried, for messages
};

/// Asks ?G at each of `bauds`, the likeliest first, or only at the first if the transport has no
/// rates. A unit that answers at the first rate is asked just once. Blocks for less than 4 s, and
/// until the dialogue's deadline at most.
Greeting greet(Transport& transport, Dialogue& dialogue, const std::vector<int>& bauds);

/// Returns `known` and then, if `known` is a guess, the other usual rates.
std::vector<int> bauds_to_try(int known, bool guess);

/// Fills model, abilities and facts of an identity whose other members are set. A unit may know
/// none of it: after two queries without an answer the other queries are left out, so that this
/// takes little more than a second.
void ask_facts(Dialogue& dialogue, const Request& request, Identity& identity);

} // namespace nendo::driver::cyberglove
