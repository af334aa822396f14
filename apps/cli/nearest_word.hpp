#pragma once
// Finds the word that was meant by a mistyped one.

#include <string>
#include <string_view>
#include <vector>

namespace nendo::cli {

/// Returns the known word that is nearest to the text: by letters that are wrong, missing, too many
/// or swapped, at most a third of them, or because the text begins it. Empty if there is none.
std::string nearest_word(std::string_view text, const std::vector<std::string>& known);

} // namespace nendo::cli
