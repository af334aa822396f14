#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "stress/stress_options.hpp"
#include "stress/tick_tally.hpp"

namespace nendo::stress {
namespace {

constexpr std::array<std::string_view, 7> figures{"min",   "p50",    "p90", "p99",
                                                  "p99.9", "p99.99", "max"};

struct Count {
  std::string_view name;
  std::string_view key;
};
constexpr std::array<Count, 5> counts{{{"ticks", "ticks"},
                                       {"missed", "missed"},
                                       {"overruns", "overruns"},
                                       {"faults", "page_faults"},
                                       {"switches", "involuntary_switches"}}};

struct Unit {
  std::string_view name;
  double in_us;
};
constexpr std::array<Unit, 5> units{
    {{"", 1.0}, {"us", 1.0}, {"ns", 1e-3}, {"ms", 1e3}, {"s", 1e6}}};

/// Removes `prefix` and the dot after it from the front. Returns false if they are not there.
bool take(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix) || text.substr(prefix.size(), 1) != ".") return false;
  text.remove_prefix(prefix.size() + 1);
  return true;
}

/// Returns the path of a figure in the report, or an empty one if there is no such figure. Sets
/// `is_count` if the figure is a count, which has no unit.
std::vector<std::string> path_of(std::string_view name, bool& is_count) {
  for (const Count& count : counts) {
    if (count.name != name) continue;
    is_count = true;
    return {std::string(count.key)};
  }
  if (name == "longest_outage") return {"longest_outage_us"};
  std::vector<std::string> path;
  if (take(name, "corrected")) path.emplace_back("corrected");
  std::string measure = "lateness";
  for (const auto known : measure_names) {
    if (take(name, known)) measure = known;
  }
  if (std::find(figures.begin(), figures.end(), name) == figures.end()) return {};
  std::string key(name);
  std::replace(key.begin(), key.end(), '.', '_');
  path.push_back(measure + "_us");
  path.push_back(key);
  return path;
}

std::optional<Condition> parse_one(std::string_view text) {
  Condition condition;
  condition.text = text;
  const std::size_t at = text.find_first_of("<>");
  if (at == std::string_view::npos) return std::nullopt;
  bool is_count = false;
  condition.path = path_of(text.substr(0, at), is_count);
  condition.relation = text[at];
  std::string_view rest = text.substr(at + 1);
  condition.or_equal = rest.starts_with('=');
  if (condition.or_equal) rest.remove_prefix(1);
  const char* const end = rest.data() + rest.size();
  const auto [stopped, error] = std::from_chars(rest.data(), end, condition.threshold);
  if (condition.path.empty() || error != std::errc{} || !std::isfinite(condition.threshold) ||
      condition.threshold < 0.0)
    return std::nullopt;
  const std::string_view suffix(stopped, static_cast<std::size_t>(end - stopped));
  const auto unit = std::find_if(units.begin(), units.end(),
                                 [&](const Unit& known) { return known.name == suffix; });
  if (unit == units.end() || (is_count && !suffix.empty())) return std::nullopt;
  condition.threshold *= unit->in_us;
  return condition;
}

} // namespace

Result<std::vector<Condition>> parse_conditions(const std::string& text) {
  std::vector<Condition> conditions;
  for (std::string_view rest = text; !text.empty();) {
    const std::size_t comma = rest.find(',');
    auto condition = parse_one(rest.substr(0, comma));
    if (!condition) {
      return Error{Errc::usage, "--fail-if " + std::string(rest.substr(0, comma)) +
                                    ": use a figure, > or <, and a number, like p99.9>200us, "
                                    "work.p99>300us, corrected.max>5ms or missed>0"};
    }
    conditions.push_back(*std::move(condition));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  return conditions;
}

std::vector<std::string> fulfilled(const std::vector<Condition>& conditions,
                                   const nlohmann::ordered_json& report) {
  std::vector<std::string> lines;
  for (const Condition& condition : conditions) {
    const nlohmann::ordered_json* at = &report;
    for (const std::string& key : condition.path)
      at = at != nullptr && at->contains(key) ? &at->at(key) : nullptr;
    if (at == nullptr || !at->is_number()) {
      lines.push_back(condition.text + " (not measured)");
      continue;
    }
    const double value = at->get<double>();
    const bool beyond =
        condition.relation == '>' ? value > condition.threshold : value < condition.threshold;
    if (!beyond && !(condition.or_equal && value == condition.threshold)) continue;
    const bool is_time = condition.path.back().ends_with("_us") || condition.path.size() > 1;
    lines.push_back(fmt::format("{} ({:.10g}{})", condition.text, value, is_time ? " us" : ""));
  }
  return lines;
}

} // namespace nendo::stress
