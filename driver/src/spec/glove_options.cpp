#include <nendo/driver/glove_options.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace nendo::driver {
namespace {

Error none_of(const GloveSpec& spec, const std::pair<const std::string, std::string>& option,
              const std::string& list) {
  return {Errc::usage,
          spec.text + ": " + option.first + "=" + option.second + " is none of " + list};
}

} // namespace

Result<void> allow_options(const GloveSpec& spec, std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : spec.options) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const std::string_view name : known)
      list.append(list.empty() ? "; known: " : ", ").append(name);
    return Error{Errc::usage, "glove \"" + spec.text + "\": unknown option " + key +
                                  (list.empty() ? "; it has none" : list)};
  }
  return {};
}

Result<int> number_option(const GloveSpec& spec, std::string_view key,
                          std::initializer_list<int> known) {
  const auto option = spec.options.find(std::string(key));
  if (option == spec.options.end()) return *known.begin();
  std::string list;
  for (const int number : known) {
    if (option->second == std::to_string(number)) return number;
    list += (list.empty() ? "" : ", ") + std::to_string(number);
  }
  return none_of(spec, *option, list);
}

Result<std::string_view> word_option(const GloveSpec& spec, std::string_view key,
                                     std::initializer_list<std::string_view> known) {
  const auto option = spec.options.find(std::string(key));
  if (option == spec.options.end()) return *known.begin();
  std::string list;
  for (const std::string_view word : known) {
    if (option->second == word) return word;
    list.append(list.empty() ? "" : ", ").append(word);
  }
  return none_of(spec, *option, list);
}

Result<std::optional<Side>> hand_option(const GloveSpec& spec) {
  if (spec.options.find("hand") == spec.options.end()) return std::optional<Side>{};
  const auto hand = word_option(spec, "hand", {"left", "right"});
  if (!hand) return hand.error();
  return std::optional(*hand == "left" ? Side::left : Side::right);
}

ChosenHand choose_hand(std::optional<Side> glove, const SideOptions& wishes) noexcept {
  if (wishes.option) return {*wishes.option, "option"};
  if (glove) return {*glove, "glove"};
  if (wishes.wanted) return {*wishes.wanted, "caller"};
  return {Side::right, "assumed"};
}

std::string hand_override(std::optional<Side> glove, const SideOptions& wishes) {
  if (!glove || !wishes.option || *glove == *wishes.option) return {};
  return "the glove says that it is a " + std::string(name_of(*glove)) +
         "-hand one; it is used as a " + std::string(name_of(*wishes.option)) +
         "-hand one, as hand= asks";
}

Result<void> require_port(const GloveSpec& spec, std::string_view example) {
  if (!spec.target.empty()) return {};
  return Error{Errc::usage, spec.text + ": name the port, e.g. " + std::string(example)};
}

} // namespace nendo::driver
