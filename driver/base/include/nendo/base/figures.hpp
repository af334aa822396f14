#pragma once
// Numbers and lists in messages.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo {

/// Returns a whole number with a comma after each three digits: "5,000". Allocates.
NENDO_API std::string thousands(std::int64_t number);
/// Returns names as a list: "off, mild or strong". Allocates.
NENDO_API std::string alternatives(std::span<const std::string_view> names);

} // namespace nendo
