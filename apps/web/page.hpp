#pragma once
// The page, which embed.cmake makes from the files in apps/web/page at build time.

#include <string_view>

namespace nendo::web {

/// The text in the page that an answer replaces by its nonce.
inline constexpr std::string_view nonce_mark = "NENDO-NONCE";
/// The text that it replaces by page_commands().
inline constexpr std::string_view commands_mark = "NENDO-COMMANDS";
/// And by page_settings().
inline constexpr std::string_view settings_mark = "NENDO-SETTINGS";

std::string_view page() noexcept;

} // namespace nendo::web
