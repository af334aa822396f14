#pragma once
// Facts about a glove that are not needed to understand its records.

#include <string_view>

#include "cyberglove/cyberglove_commands.hpp"
#include "cyberglove/cyberglove_identity.hpp"

namespace nendo::driver::cyberglove {

/// Fills model, abilities and facts of an identity whose other members are set. A unit may know
/// none of it: after two queries without an answer it is asked no more, so that this takes little
/// more than a second. It never fails.
void ask_facts(Dialogue& dialogue, const Request& request, Identity& identity);

/// Returns the first line that is not empty, without characters that could disturb a terminal.
std::string model_line(std::string_view text);

} // namespace nendo::driver::cyberglove
