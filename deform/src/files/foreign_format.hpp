#pragma once
// Names what a file is that is no model that Nendo reads.

#include <optional>
#include <string>
#include <string_view>

namespace nendo::deform {

/// Returns what the file is and what to do with it, as words behind the file's name; nothing if its
/// first bytes tell of no other format.
std::optional<std::string> foreign_format(std::string_view bytes);

/// Returns why a text is no model, for one in which no vertex was found: what it seems to be, or
/// what its first line is. The words go behind the file's name.
std::string why_no_model(std::string_view text);

} // namespace nendo::deform
