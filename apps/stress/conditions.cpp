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

/// Sets the path of a figure in the report, and whether it is a count, which has no unit. Returns
/// false if there is no such figure.
bool find_figure(std::string_view name, Condition& condition) {
  const auto count = std::find_if(counts.begin(), counts.end(),
                                  [&](const Count& known) { return known.name == name; });
  condition.is_count = count != counts.end();
  if (condition.is_count) condition.path = "/" + std::string(count->key);
  if (name == "longest_outage") condition.path = "/longest_outage_us";
  if (!condition.path.empty()) return true;
  if (take(name, "corrected")) condition.path = "/corrected";
  std::string_view measure = "lateness";
  for (const auto known : measure_names)
    if (take(name, known)) measure = known;
  std::string key(name);
  std::replace(key.begin(), key.end(), '.', '_');
  condition.path += "/" + std::string(measure) + "_us/" + key;
  return name.find('_') == std::string_view::npos &&
         std::find(figure_names.begin(), figure_names.end(), key) != figure_names.end();
}

std::optional<Condition> parse_one(std::string_view text) {
  Condition condition;
  condition.text = text;
  const std::size_t at = text.find_first_of("<>");
  if (at == std::string_view::npos) return std::nullopt;
  if (!find_figure(text.substr(0, at), condition)) return std::nullopt;
  condition.relation = text[at];
  std::string_view rest = text.substr(at + 1);
  condition.or_equal = rest.starts_with('=');
  if (condition.or_equal) rest.remove_prefix(1);
  const char* const end = rest.data() + rest.size();
  const auto [stopped, error] = std::from_chars(rest.data(), end, condition.threshold);
  if (error != std::errc{} || !std::isfinite(condition.threshold) || condition.threshold < 0.0)
    return std::nullopt;
  const std::string_view suffix(stopped, static_cast<std::size_t>(end - stopped));
  const auto unit = std::find_if(units.begin(), units.end(),
                                 [&](const Unit& known) { return known.name == suffix; });
  if (unit == units.end() || (condition.is_count && !suffix.empty())) return std::nullopt;
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
    const nlohmann::ordered_json::json_pointer path(condition.path);
    if (!report.contains(path) || !report.at(path).is_number()) {
      lines.push_back(condition.text + " (not measured)");
      continue;
    }
    const double value = report.at(path).get<double>();
    const bool beyond =
        condition.relation == '>' ? value > condition.threshold : value < condition.threshold;
    if (!beyond && !(condition.or_equal && value == condition.threshold)) continue;
    lines.push_back(
        fmt::format("{} ({:.10g}{})", condition.text, value, condition.is_count ? "" : " us"));
  }
  return lines;
}

} // namespace nendo::stress
