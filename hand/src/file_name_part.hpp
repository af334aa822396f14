#pragma once

#include <string>

namespace nendo::hand {

/// Returns the string as one part of a file name: at most 80 characters of [A-Za-z0-9_%.-], and
/// different for different strings. calibration_store.cpp defines it.
std::string file_name_part(const std::string& text);

} // namespace nendo::hand
