#include "cli/figures.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

namespace nendo::cli {

std::string fixed(double number, int decimals) {
  return fmt::format("{:.{}f}", number, decimals);
}

std::string count_text(std::size_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string joined(std::span<const std::string> words, std::string_view separator) {
  return fmt::format("{}", fmt::join(words, separator));
}

} // namespace nendo::cli
