#pragma once
// Suggests a known word for a mistyped one.

#include <string>
#include <string_view>
#include <vector>

namespace nendo::cli {

/// Returns the known word with the smallest edit distance to the text (substitutions, insertions,
/// deletions, swaps), at most a third of its letters, or a word that begins with the text. Empty if
/// there is none.
std::string nearest_word(std::string_view text, const std::vector<std::string>& known);

} // namespace nendo::cli
