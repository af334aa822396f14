#include <nendo/driver/record_counts.hpp>

namespace nendo::driver {

RecordCounts counts_of(const GloveStats& stats) noexcept {
  return {stats.records, stats.missed, stats.ring_refused, stats.bad_records};
}

RecordCounts since(const RecordCounts& earlier, const RecordCounts& now) noexcept {
  return {now.delivered - earlier.delivered, now.missed - earlier.missed,
          now.refused - earlier.refused, now.bad - earlier.bad};
}

std::array<std::pair<std::string_view, std::uint64_t>, 5>
by_name(const RecordCounts& counts) noexcept {
  return {{{"sent", counts.sent()},
           {"delivered", counts.delivered},
           {"missed", counts.missed},
           {"refused", counts.refused},
           {"bad_records", counts.bad}}};
}

std::string in_words(const RecordCounts& counts) {
  std::string text;
  for (const auto& [name, count] : by_name(counts)) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " ";
    text += name == "bad_records" ? "bad records" : name;
  }
  return text;
}

} // namespace nendo::driver
