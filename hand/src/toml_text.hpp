#pragma once

#include <string>
#include <string_view>

namespace nendo::hand {

/// Returns a TOML string of text that complaint_about_text() accepts. calibration_file.cpp defines
/// it.
std::string toml_string(std::string_view text);

} // namespace nendo::hand
