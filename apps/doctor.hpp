#pragma once
// What `nendo doctor` looks for. A check is a function from the machine's facts to findings; its
// place is one of the tables of checks, by subject. A new subject is a file and a line in
// doctor_command.cpp.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/driver/devices.hpp>

namespace nendo::app {

enum class Weight : std::uint8_t {
  warning, ///< works, but worse than it could, or only if something else does not interfere
  failure, ///< will not work
};

struct Finding {
  Weight weight = Weight::warning;
  std::string_view check; ///< a stable name, e.g. "permission"
  std::string subject;    ///< what it is about, e.g. /dev/ttyUSB0; empty: the machine
  std::string what;
  std::string remedy; ///< the command or deed that mends it
};

/// What the checks of ports judge.
struct PortFacts {
  std::vector<driver::GloveCandidate> candidates;
  std::vector<std::string> grabbers; ///< as running_port_grabbers() names them
};

/// All findings about ports and USB devices. Pure.
std::vector<Finding> judge_ports(const PortFacts& facts);
/// The same for this machine, now. Blocks for less than a second.
std::vector<Finding> check_ports();

} // namespace nendo::app
