#pragma once
// nendo calibration import, export: to and from other programs' formats.

#include "cli/command.hpp"

namespace nendo::app::calibration_exchange {

/// Describes both to `nendo calibration`.
void add(cli::Command& calibration);

} // namespace nendo::app::calibration_exchange
