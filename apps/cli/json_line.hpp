#pragma once
// JSON for other programs, on standard output.

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace nendo::cli {

/// In one line, whatever it holds: bytes that are no UTF-8, as the names of files and devices may
/// have, become U+FFFD.
std::string json_text(const nlohmann::ordered_json& object);
/// That line, at once, for who reads a pipe.
void print_line(const nlohmann::ordered_json& object);

} // namespace nendo::cli
