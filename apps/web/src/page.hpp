#pragma once
// The page, made of apps/web/page at build time (embed.cmake).

#include <string_view>

namespace nendo::web {

/// Stands in the page where each answer's nonce goes.
inline constexpr std::string_view nonce_mark = "NENDO-NONCE";

std::string_view page() noexcept;

} // namespace nendo::web
