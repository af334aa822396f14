#include <nendo/base/figures.hpp>

namespace nendo {

std::string thousands(std::int64_t number) {
  std::string digits = std::to_string(number);
  const std::size_t first = number < 0 ? 1 : 0;
  for (std::size_t at = digits.size(); at > first + 3;)
    digits.insert(at -= 3, ",");
  return digits;
}

std::string alternatives(std::span<const std::string_view> names) {
  std::string text;
  for (std::size_t at = 0; at < names.size(); ++at)
    text.append(at == 0 ? "" : at + 1 < names.size() ? ", " : " or ").append(names[at]);
  return text;
}

} // namespace nendo
