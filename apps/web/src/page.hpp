#pragma once
// The page, which embed.cmake makes of the files in apps/web/page at build time.

#include <string_view>

namespace nendo::web {

/// Stands in the page wherever an answer puts its nonce.
inline constexpr std::string_view nonce_mark = "NENDO-NONCE";

std::string_view page() noexcept;

} // namespace nendo::web
