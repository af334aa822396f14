#include "web/page_commands.hpp"

#include <string_view>

#include "commands/commands.hpp"

namespace nendo::web {
namespace {

// A test sees that no text of the table has a quotation mark, a backslash or a "<".
std::string quoted(std::string_view text) {
  return '"' + std::string(text) + '"';
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

} // namespace nendo::web
