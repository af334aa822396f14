#pragma once
// The first exchange with an interface unit: it ends a stream and finds the line rate at which the
// unit answers.

#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "cyberglove/cyberglove_commands.hpp"
#include "transport/transport.hpp"

namespace nendo::driver::cyberglove {

struct Greeting {
  int baud = 0; ///< at which it answered
  Reply<GloveState> reply;
  std::string asked; ///< what was asked how, for messages
};

/// Asks ?G at each of `bauds`, the likeliest first, or only at the first if the transport has no
/// rates. A unit that answers at the first rate is asked just once. Blocks for less than 4 s, and
/// until the dialogue's deadline at most.
Greeting greet(Transport& transport, Dialogue& dialogue, const std::vector<int>& bauds);

/// Returns `known` and then, if `known` is a guess, the other usual rates.
std::vector<int> bauds_to_try(int known, bool guess);

} // namespace nendo::driver::cyberglove
