#include "web/page_commands.hpp"

#include <cstdint>
#include <string_view>
#include <type_traits>

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

std::string brush_list() {
  std::string list = "[";
  for (std::uint8_t number = 0; number < deform::brush_count; ++number)
    list += quoted(name_of(static_cast<deform::Brush>(number))) + ',';
  return list + "]";
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
    if constexpr (std::is_same_v<decltype(setting), const flow::BrushesSetting&>)
      list += ", choices: " + brush_list();
    list += " },";
  });
  return list + "\n}";
}

std::string command_states(const commands::Situation& now) {
  std::string lines;
  for (const commands::Row& row : commands::table()) {
    if (!row.is_for_run() || (row.places & commands::on_page) == 0) continue;
    const bool on = row.is_on_in(now);
    const char* const refusal = row.refusal_in(now);
    if (!on && refusal == nullptr) continue;
    lines += std::string(row.name) + (on ? "\ton\t" : "\toff\t") +
             (refusal != nullptr ? refusal : "") + '\n';
  }
  return lines;
}

} // namespace nendo::web
