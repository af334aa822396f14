#pragma once
// The dialogue with a FASTRAK: which one it is, which stations it has, and its settings.

#include <optional>
#include <string>

#include <nendo/base/result.hpp>

#include "fastrak/fastrak_protocol.hpp"
#include "polhemus/polhemus_options.hpp"
#include "stream/text_dialogue.hpp"

namespace nendo::driver::fastrak {

using polhemus::Options;

struct Identity {
  int baud = 0;
  Status status;
  std::string plugged_in; ///< the stations that are, e.g. "1, 2"
  std::string refusals;   ///< commands that it does not have
};

/// Returns why a line of `baud` cannot carry the records, or nothing if it can.
std::optional<std::string> too_slow(int baud);

/// Ends any stream, asks the tracker who it is and sets it up, until the dialogue is over. `source`
/// begins the messages; `first_baud` is tried first if Options::baud is missing. Errors: no_device;
/// usage, for a station that it does not have.
Result<Identity> identify(Transport& transport, TextDialogue& dialogue, const std::string& source,
                          const Options& options, int first_baud);

} // namespace nendo::driver::fastrak
