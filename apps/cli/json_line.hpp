#pragma once
// Writes JSON for other programs on standard output.

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace nendo::cli {

/// Returns the object in one line. Bytes that are no UTF-8, as names of files and devices may have,
/// become U+FFFD.
std::string json_text(const nlohmann::ordered_json& object);
/// Prints that line and flushes it, so that a program at a pipe gets it at once.
void print_line(const nlohmann::ordered_json& object);

} // namespace nendo::cli
