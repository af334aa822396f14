#pragma once
// The name by which messages call the program.

#include <string_view>

namespace nendo::cli {

/// Sets the name, which is "nendo" before. `name` must live as long as the program. Call it before
/// any other thread exists.
void set_program_name(std::string_view name) noexcept;
std::string_view program_name() noexcept;

} // namespace nendo::cli
