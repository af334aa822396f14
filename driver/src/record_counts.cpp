#include <nendo/driver/record_counts.hpp>

#include <cstdio>

namespace nendo::driver {

RecordCounts counts_of(const StreamStats& stats) noexcept {
  return {stats.records,     stats.missed,  stats.ring_refused,
          stats.bad_records, stats.clamped, stats.counts_missed};
}

RecordCounts since(const RecordCounts& earlier, const RecordCounts& now) noexcept {
  return {now.delivered - earlier.delivered, now.missed - earlier.missed,
          now.refused - earlier.refused,     now.bad - earlier.bad,
          now.clamped - earlier.clamped,     now.counts_missed};
}

std::array<std::pair<std::string_view, std::optional<std::uint64_t>>, 6>
by_name(const RecordCounts& counts) noexcept {
  const auto if_known = [&](std::uint64_t count) {
    return counts.counts_missed ? std::optional(count) : std::nullopt;
  };
  return {{{"sent", if_known(counts.sent())},
           {"delivered", counts.delivered},
           {"missed", if_known(counts.missed)},
           {"refused", counts.refused},
           {"bad_records", counts.bad},
           {"clamped_values", counts.clamped}}};
}

std::string in_words(const RecordCounts& counts) {
  std::string text;
  for (const auto& [name, count] : by_name(counts)) {
    const bool clamped = name == "clamped_values";
    if (!count || (clamped && *count == 0)) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(*count) + " ";
    text += name == "bad_records" ? "bad records" : clamped ? "values out of range" : name;
  }
  if (!counts.counts_missed)
    text += "; how many were lost on the line is not known with this device";
  return text;
}

std::string rate_shortfall(double asked_hz, const StreamStats& stats) {
  constexpr double tolerance = 0.05;
  const bool known = !stats.counts_missed && asked_hz > 0.0 && stats.rate_hz > 0.0;
  if (!known || stats.rate_hz > (1.0 - tolerance) * asked_hz) return {};
  char text[96];
  std::snprintf(text, sizeof text, "%.1f records per second of the %.1f that were asked for",
                stats.rate_hz, asked_hz);
  return text;
}

} // namespace nendo::driver
