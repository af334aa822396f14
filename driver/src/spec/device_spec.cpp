#include <nendo/driver/device_spec.hpp>
#include <nendo/driver/glove_options.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace nendo::driver {
namespace {

Error usage(std::string_view text, const std::string& what) {
  return {Errc::usage, "\"" + std::string(text) + "\": " + what};
}

Result<void> parse_options(std::string_view options, DeviceSpec& spec) {
  for (;;) {
    const std::size_t end = std::min(options.find('&'), options.size());
    const std::string_view option = options.substr(0, end);
    const std::size_t equals = option.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == option.size()) {
      return usage(spec.text, "\"" + std::string(option) + "\" is not of the form key=value");
    }
    const std::string key(option.substr(0, equals));
    if (!spec.options.emplace(key, option.substr(equals + 1)).second) {
      return usage(spec.text, "option " + key + " is given twice");
    }
    if (end == options.size()) return {};
    options.remove_prefix(end + 1);
  }
}

Error none_of(const DeviceSpec& spec, const std::pair<const std::string, std::string>& option,
              const std::string& list) {
  return {Errc::usage,
          spec.text + ": " + option.first + "=" + option.second + " is none of " + list};
}

} // namespace

Result<DeviceSpec> parse_device_spec(std::string_view text) {
  constexpr std::size_t max_characters = 4096; // the longest path that the system takes
  if (text.size() > max_characters) return Error{Errc::usage, "the name of a device is too long"};
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  if (std::any_of(text.begin(), text.end(), is_control)) {
    return Error{Errc::usage, "the name of a device contains control characters"};
  }
  if (!text.empty() && (text.front() == '/' || text.front() == '.')) {
    return usage(text, "a port is written serial:" + std::string(text));
  }
  DeviceSpec spec;
  spec.text = text;
  const std::size_t question = text.find('?');
  const std::string_view head = text.substr(0, question);
  const std::size_t colon = head.find(':');
  spec.kind = head.substr(0, colon);
  if (colon != std::string_view::npos) spec.target = head.substr(colon + 1);
  if (spec.kind.empty())
    return usage(text, "it must begin with a kind, e.g. auto or serial:/dev/ttyUSB0");
  if (question != std::string_view::npos) {
    if (auto parsed = parse_options(text.substr(question + 1), spec); !parsed)
      return parsed.error();
  }
  return spec;
}

std::string with_option(std::string_view spec, std::string_view option) {
  const char separator = spec.find('?') == std::string_view::npos ? '?' : '&';
  return std::string(spec) + separator + std::string(option);
}

Result<void> allow_options(const DeviceSpec& spec, std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : spec.options) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const std::string_view name : known)
      list.append(list.empty() ? "; known: " : ", ").append(name);
    return Error{Errc::usage, "\"" + spec.text + "\": unknown option " + key +
                                  (list.empty() ? "; it has none" : list)};
  }
  return {};
}

Result<int> number_option(const DeviceSpec& spec, std::string_view key,
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

Result<std::string_view> word_option(const DeviceSpec& spec, std::string_view key,
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

Result<std::optional<Side>> hand_option(const DeviceSpec& spec) {
  if (spec.options.find("hand") == spec.options.end()) return std::optional<Side>{};
  const auto hand = word_option(spec, "hand", {"left", "right"});
  if (!hand) return hand.error();
  return side_named(*hand);
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

Result<void> require_port(const DeviceSpec& spec, std::string_view example) {
  if (!spec.target.empty()) return {};
  return Error{Errc::usage, spec.text + ": name the port, e.g. " + std::string(example)};
}

} // namespace nendo::driver
