#include "commands/commands.hpp"

#include <algorithm>
#include <variant>

#include "commands/rows.hpp"

namespace nendo::commands {
namespace {

// Whether one row makes both.
bool is_alike(flow::Request one, flow::Request other) {
  return one == other;
}
bool is_alike(const flow::DrawWire& one, const flow::DrawWire& other) {
  return one.blade == other.blade;
}
bool is_alike(const flow::SetClutch& one, const flow::SetClutch& other) {
  return one.side == other.side;
}
bool is_alike(const flow::SetMask& one, const flow::SetMask& other) {
  return one.edit == other.edit;
}
bool is_alike(const flow::EditPart& one, const flow::EditPart& other) {
  return one.removes == other.removes;
}
template <class T>
bool is_alike(const T&, const T&) {
  return true;
}

constexpr auto rows = [] {
  std::array<Row, edit_rows.size() + run_rows.size()> all;
  std::copy(run_rows.begin(), run_rows.end(),
            std::copy(edit_rows.begin(), edit_rows.end(), all.begin()));
  return all;
}();

constexpr std::string_view verb_of(const Row& row) {
  return row.name.substr(0, row.name.find(' '));
}
constexpr bool share_key(const Row& row, const Row& other) {
  for (const std::string_view key : row.keys)
    if (!key.empty() && other.has_key(key)) return true;
  return false;
}
constexpr bool mean_the_same(const Row& row, const Row& other) {
  return (row.places & other.places) == 0 && row.keys == other.keys &&
         verb_of(row) == verb_of(other);
}
consteval bool are_distinct() {
  for (std::size_t at = 0; at < rows.size(); ++at)
    for (std::size_t before = 0; before < at; ++before) {
      const Row &row = rows[at], &other = rows[before];
      if (row.name == other.name) return false;
      if (row.edit && other.edit && row.edit->command == other.edit->command) return false;
      if (share_key(row, other) && !mean_the_same(row, other)) return false;
    }
  return true;
}
static_assert(are_distinct(), "two rows have one name or command, or a key means two things");
static_assert(std::count_if(rows.begin(), rows.end(),
                            [](const Row& row) { return row.edit.has_value(); }) ==
                  static_cast<int>(EditCommand::export_glb) + 1,
              "a command of the editor has no row");

} // namespace

std::span<const Row> table() noexcept {
  return rows;
}

const Row* named(std::string_view name) noexcept {
  const auto* const found =
      std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.name == name; });
  return found == rows.end() ? nullptr : found;
}

const Row* with_key(std::string_view key, std::uint8_t places) noexcept {
  const auto* const found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
    return (row.places & places) != 0 && row.has_key(key);
  });
  return found == rows.end() ? nullptr : found;
}

std::string_view name_of(const flow::Command& command) noexcept {
  if (std::holds_alternative<flow::SetLayer>(command)) return name_of(flow::Punch{});
  const auto* const found = std::find_if(run_rows.begin(), run_rows.end(), [&](const Row& row) {
    if (row.make == nullptr) return false;
    const flow::Command made = row.make(false);
    return std::visit(
        [&made]<class T>(const T& one) {
          const T* const other = std::get_if<T>(&made);
          return other != nullptr && is_alike(one, *other);
        },
        command);
  });
  if (found != run_rows.end()) return found->name;
  return std::holds_alternative<flow::SetRole>(command) ? "role" : "a command";
}

const Row& row_of(EditCommand command) noexcept {
  return *std::find_if(rows.begin(), rows.end(),
                       [&](const Row& row) { return row.edit && row.edit->command == command; });
}

Answer press(const Row& row, const Situation& now, flow::PendingSettings& pending) {
  Answer answer{std::nullopt, row.refusal_in(now)};
  if (row.choose != nullptr) {
    row.choose(pending, now.frame);
    answer.command = pending.ask();
  } else if (row.make != nullptr) {
    answer.command = row.make(row.is_on_in(now));
    if (answer.refusal != nullptr && !std::holds_alternative<flow::Request>(*answer.command))
      answer.command.reset();
  }
  return answer;
}

std::string keys_of(const Row& row) {
  std::string text;
  for (const std::string_view key : row.keys)
    if (!key.empty()) text += (text.empty() ? "" : ", ") + std::string(key);
  return text;
}

std::string help_of(const Row& row, const State& now) {
  std::string text(row.help);
  if (const char* const refusal = row.refusal_in(now)) text.append("\n").append(refusal);
  return text + " (" + keys_of(row) + ")";
}

std::string key_list(std::uint8_t places, std::string_view before, std::string_view between) {
  std::string text;
  for (const Row& row : rows) {
    if ((row.places & places) == 0) continue;
    const std::string keys = places == in_terminal ? std::string(row.keys.front()) : keys_of(row);
    text.append(before).append(keys).append(between).append(row.help);
  }
  return text;
}

} // namespace nendo::commands
