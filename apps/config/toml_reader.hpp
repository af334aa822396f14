#pragma once
// Reads tables of a TOML file, with error messages that name the line. In each module only one
// source file includes this header, because toml++ is slow to compile.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <toml++/toml.h>

#include <nendo/base/plain_toml.hpp>
#include <nendo/base/result.hpp>
#include <nendo/base/text.hpp>

namespace nendo::config {

/// Reads values and keeps the first error. After an error, all values are empty or zero.
class TomlReader {
public:
  explicit TomlReader(std::string_view name) : name_(name) {}

  const std::optional<Error>& error() const noexcept { return error_; }
  void complain(const toml::node& where, std::string_view what) {
    complain(where.source().begin.line, what);
  }
  void complain(std::size_t line, std::string_view what) {
    if (!error_) error_ = bad_line(name_, line, printable(what.substr(0, 250)));
  }

  void allow_only(const toml::table& table, const std::vector<std::string_view>& keys) {
    for (const auto& [key, node] : table) {
      if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
      std::string message = "unknown key " + in_quotes(key.str()) + "; leave it out, or use one of";
      for (const std::string_view known : keys)
        message.append(known == keys.front() ? " " : ", ").append(known);
      complain(node, message);
    }
  }
  /// Returns null, with an error, if the key is missing.
  const toml::node* find(const toml::table& table, std::string_view key) {
    const toml::node* node = table.get(key);
    if (node == nullptr) complain(table, "has no " + std::string(key) + "; add it");
    return node;
  }
  const toml::table* table(const toml::table& table, std::string_view key) {
    const toml::node* node = find(table, key);
    if (node == nullptr) return nullptr;
    if (!node->is_table())
      complain(*node, std::string(key) + " must be a table, as [" + std::string(key) + "]");
    return node->as_table();
  }
  const toml::table* as_table(const toml::node& node, std::string_view what) {
    if (!node.is_table()) complain(node, std::string(what) + " must be a table");
    return node.as_table();
  }
  const toml::array* array(const toml::table& table, std::string_view key) {
    const toml::node* node = find(table, key);
    if (node == nullptr) return nullptr;
    if (!node->is_array()) complain(*node, std::string(key) + " must be a list in brackets");
    return node->as_array();
  }
  /// Calls read(table) for each table of a list, up to the first error. `what` names one of them.
  template <class Read>
  void each_table(const toml::array& list, std::string_view what, const Read& read) {
    for (const toml::node& node : list) {
      const toml::table* one = as_table(node, what);
      if (error_) return;
      read(*one);
    }
  }
  std::string text(const toml::table& table, std::string_view key) {
    return value<std::string>(table, key, " must be a text in quotes");
  }
  bool truth(const toml::table& table, std::string_view key) {
    return value<bool>(table, key, " must be true or false");
  }
  double number(const toml::node& node, std::string_view what) {
    const auto value = node.value<double>();
    if (node.is_number() && value && std::isfinite(*value)) return *value;
    complain(node, std::string(what) + " must be a finite number");
    return 0.0;
  }
  double number(const toml::table& table, std::string_view key) {
    const toml::node* node = find(table, key);
    return node == nullptr ? 0.0 : number(*node, key);
  }
  /// Reads a whole number from `min` to `max`. After an error it is 0.
  std::uint64_t count(const toml::table& table, std::string_view key, std::uint64_t max,
                      std::uint64_t min = 0) {
    const toml::node* node = find(table, key);
    if (node == nullptr) return 0;
    const auto value = node->value_exact<std::int64_t>();
    const auto number = value && *value >= 0 ? static_cast<std::uint64_t>(*value) : max + 1;
    if (number >= min && number <= max) return number;
    complain(*node, std::string(key) + " must be a whole number within " + std::to_string(min) +
                        " and " + std::to_string(max));
    return 0;
  }
  /// Reads a date and time with zone, of the years 1970 to 9999.
  std::chrono::sys_seconds time(const toml::table& table, std::string_view key) {
    using namespace std::chrono;
    const toml::node* node = find(table, key);
    if (node == nullptr) return {};
    const auto value = node->value_exact<toml::date_time>();
    if (!value || !value->offset) {
      complain(*node, std::string(key) + " must be a date and time with zone, "
                                         "as 2026-11-21T19:27:05Z, without quotes");
      return {};
    }
    const sys_days day = year{value->date.year} / int{value->date.month} / int{value->date.day};
    const sys_seconds moment = day + hours{value->time.hour} + minutes{value->time.minute} +
                               seconds{value->time.second} - minutes{value->offset->minutes};
    if (moment < sys_seconds{} || moment >= sys_days{year{10000} / 1 / 1})
      complain(*node, std::string(key) + " must lie within the years 1970 and 9999");
    return moment;
  }
  /// Reads a list of exactly `Size` numbers.
  template <std::size_t Size>
  std::array<double, Size> numbers(const toml::node& node, std::string_view what) {
    std::array<double, Size> values{};
    const toml::array* list = node.as_array();
    if (list == nullptr || list->size() != Size) {
      complain(node, std::string(what) + " must be a list of " + std::to_string(Size) + " numbers");
      return values;
    }
    for (std::size_t at = 0; at < Size; ++at)
      values[at] = number((*list)[at], what);
    return values;
  }
  /// Converts a text by `find_named`. If that finds nothing, returns a default value, with an
  /// error.
  template <class Named>
  auto named(const toml::table& table, std::string_view key, const Named& find_named) {
    const std::string name = text(table, key);
    const auto found = find_named(name);
    if (!found) complain(table, std::string(key) + ": there is no '" + name + "'");
    return found.value_or(std::decay_t<decltype(*found)>{});
  }

private:
  template <class Value>
  Value value(const toml::table& table, std::string_view key, const char* must) {
    const toml::node* node = find(table, key);
    if (node == nullptr) return {};
    const auto found = node->value_exact<Value>();
    if (!found) complain(*node, std::string(key) + must);
    return found.value_or(Value{});
  }

  std::string name_;
  std::optional<Error> error_;
};

/// Parses a text of version 1 and calls read(reader, root). Returns the first error, of the text or
/// of the reader, or nothing. `name` is what errors call the text, and `advice` ends the message
/// about a text that is not TOML.
template <class Read>
std::optional<Error> read_toml(std::string_view text, std::string_view name, const Read& read,
                               std::string_view advice = "fix it") {
  toml::table root;
  TomlReader reader(name);
  if (const auto fault = find_toml_fault(text)) {
    reader.complain(fault->line, fault->what);
    return reader.error();
  }
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    reader.complain(error.source().begin.line,
                    std::string(error.description().substr(0, 160)) + "; " + std::string(advice));
    return reader.error();
  }
  const toml::node* const version = reader.find(root, "version");
  if (version != nullptr && version->value_exact<std::int64_t>() != 1)
    reader.complain(*version, "is of a version that this program does not know; it reads 1");
  if (!reader.error()) read(reader, root);
  return reader.error();
}

} // namespace nendo::config
