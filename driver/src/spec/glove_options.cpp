#include "spec/glove_options.hpp"

#include <string>

namespace nendo::driver {

Result<int> number_option(const GloveSpec& spec, std::string_view key,
                          std::initializer_list<int> known) {
  const auto option = spec.options.find(std::string(key));
  if (option == spec.options.end()) return *known.begin();
  std::string list;
  for (const int number : known) {
    if (option->second == std::to_string(number)) return number;
    list += (list.empty() ? "" : ", ") + std::to_string(number);
  }
  return Error{Errc::usage,
               spec.text + ": " + option->first + "=" + option->second + " is none of " + list};
}

Result<std::optional<Side>> hand_option(const GloveSpec& spec) {
  const auto option = spec.options.find("hand");
  if (option == spec.options.end()) return std::optional<Side>{};
  for (const Side side : {Side::left, Side::right}) {
    if (option->second == name_of(side)) return std::optional(side);
  }
  return Error{Errc::usage, spec.text + ": hand=" + option->second + " is none of left, right"};
}

ChosenHand choose_hand(std::optional<Side> glove, const SideOptions& wishes) noexcept {
  if (glove) return {*glove, "glove"};
  if (wishes.option) return {*wishes.option, "option"};
  if (wishes.wanted) return {*wishes.wanted, "caller"};
  return {Side::right, "assumed"};
}

Result<void> require_port(const GloveSpec& spec, std::string_view example) {
  if (!spec.target.empty()) return {};
  return Error{Errc::usage, spec.text + ": name the port, e.g. " + std::string(example)};
}

} // namespace nendo::driver
