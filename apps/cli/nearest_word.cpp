#include "cli/nearest_word.hpp"

#include <algorithm>
#include <cstddef>

namespace nendo::cli {
namespace {

/// Returns how many letters must be changed, added, removed or swapped with the next one (optimal
/// string alignment).
std::size_t distance_between(std::string_view one, std::string_view other) {
  const std::size_t width = other.size() + 1;
  std::vector<std::size_t> rows((one.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return rows[i * width + j]; };
  for (std::size_t i = 0; i <= one.size(); ++i)
    at(i, 0) = i;
  for (std::size_t j = 0; j <= other.size(); ++j)
    at(0, j) = j;
  for (std::size_t i = 1; i <= one.size(); ++i) {
    for (std::size_t j = 1; j <= other.size(); ++j) {
      const std::size_t changed = one[i - 1] == other[j - 1] ? 0 : 1;
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + changed});
      if (i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1])
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return rows.back();
}

} // namespace

std::string nearest_word(std::string_view text, const std::vector<std::string>& known) {
  constexpr std::size_t max_length = 64; // no name is as long
  if (text.empty() || text.size() > max_length) return {};
  std::string nearest;
  const std::size_t letters = text.size() - std::min(text.find_first_not_of('-'), text.size());
  std::size_t least = std::max<std::size_t>(1, letters / 3) + 1;
  for (const std::string& word : known) {
    const std::size_t distance = distance_between(text, word);
    if (distance >= least) continue;
    least = distance;
    nearest = word;
  }
  if (!nearest.empty()) return nearest;
  const auto begun = std::find_if(known.begin(), known.end(),
                                  [&](const std::string& word) { return word.starts_with(text); });
  return begun == known.end() ? "" : *begun;
}

} // namespace nendo::cli
