#pragma once
// nendo calibration import and export, which convert from and to other programs' formats.

#include "cli/command.hpp"

namespace nendo::app::calibration_exchange {

/// Adds both commands to `nendo calibration`.
void add(cli::Command& calibration);

} // namespace nendo::app::calibration_exchange
