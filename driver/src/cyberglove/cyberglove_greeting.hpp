#pragma once
// The first words with an interface unit: ends what it streams, and finds the line rate at which it
// answers.

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

/// Asks ?G at each of `bauds`, which are in the order of their likelihood; only the first, if the
/// transport has no rates. A unit that answers at the first is asked just once. Takes less than
/// 4 s; blocks until then or until the dialogue's deadline.
Greeting greet(Transport& transport, Dialogue& dialogue, const std::vector<int>& bauds);

/// `known` and then, if `known` is a guess, the other usual rates.
std::vector<int> bauds_to_try(int known, bool guess);

} // namespace nendo::driver::cyberglove
