#pragma once
// nendo calibration import, export: to and from other programs' formats.

#include "command.hpp"

namespace nendo::app {

/// Describes both to `nendo calibration`.
void add_calibration_exchange(Command& calibration);

} // namespace nendo::app
