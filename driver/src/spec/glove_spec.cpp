#include <nendo/driver/open_glove.hpp>

#include <algorithm>

namespace nendo::driver {
namespace {

Error usage(std::string_view text, const std::string& what) {
  return {Errc::usage, "glove \"" + std::string(text) + "\": " + what};
}

Result<void> parse_options(std::string_view options, GloveSpec& spec) {
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

} // namespace

Result<GloveSpec> parse_glove_spec(std::string_view text) {
  constexpr std::size_t max_characters = 4096; // the longest path that the system takes
  if (text.size() > max_characters) return Error{Errc::usage, "the glove's name is too long"};
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  if (std::any_of(text.begin(), text.end(), is_control)) {
    return Error{Errc::usage, "the glove's name contains control characters"};
  }
  if (!text.empty() && (text.front() == '/' || text.front() == '.')) {
    return usage(text, "a port is written serial:" + std::string(text));
  }
  GloveSpec spec;
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

} // namespace nendo::driver
