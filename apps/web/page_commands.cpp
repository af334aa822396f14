#include "web/page_commands.hpp"

#include <string_view>

#include <nendo/base/text.hpp>
#include <nendo/flow/setting.hpp>

#include "commands/commands.hpp"

namespace nendo::web {
namespace {

// A test sees that no text of the table has a quotation mark, a backslash or a "<".
std::string quoted(std::string_view text) {
  return '"' + std::string(text) + '"';
}

std::string limits(const flow::Range& range) {
  return ", min: " + decimal_text(range.min) + ", max: " + decimal_text(range.max);
}

} // namespace

std::string page_commands() {
  std::string list = "[";
  for (const commands::Row& row : commands::table()) {
    if ((row.places & commands::on_page) == 0) continue;
    list += "\n  { name: " + quoted(row.name) + ", keys: [";
    for (const std::string_view key : row.keys)
      if (!key.empty()) list += quoted(key) + ',';
    list += "], help: " + quoted(row.help) + ", button: " + quoted(row.button) +
            ", buttonOn: " + quoted(row.button_on.empty() ? row.button : row.button_on) +
            ", isForRun: " + (row.is_for_run() ? "true" : "false") +
            ", isSetting: " + (row.choose != nullptr ? "true" : "false") + " },";
  }
  return list + "\n]";
}

std::string page_settings() {
  std::string list = "{";
  flow::for_each_setting([&](const auto& setting) {
    list += "\n  " + std::string(setting.name) + ": { label: " + quoted(setting.label);
    if constexpr (requires { setting.handy; })
      list += limits(setting.handy);
    else if constexpr (requires { setting.range; })
      list += limits(setting.range);
    list += " },";
  });
  return list + "\n}";
}

} // namespace nendo::web
