#pragma once
// What fuzz targets have in common.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

/// Ends the process if a law is broken.
inline void require(bool law) {
  if (!law) std::abort();
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// An error is one line, which begins with the name of the input.
inline void require_one_line(const nendo::Error& error, std::string_view name = "fuzz:") {
  require(error.message.starts_with(name) && !error.message.empty());
  require(error.message.find('\n') == std::string::npos);
}
