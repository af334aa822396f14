#include <nendo/driver/record_counts.hpp>

#include <algorithm>
#include <map>
#include <sstream>

#include <doctest/doctest.h>

namespace record_counts_test {

using namespace nendo::driver;

namespace {

/// Takes the sentence apart again: each number by the words behind it.
std::map<std::string, std::uint64_t> numbers_in(const std::string& words) {
  std::map<std::string, std::uint64_t> numbers;
  std::istringstream parts(words);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto digit = part.find_first_of("0123456789");
    const auto name = part.find(' ', digit);
    numbers[part.substr(name + 1)] = std::stoull(part.substr(digit, name - digit));
  }
  return numbers;
}

} // namespace

TEST_SUITE("record_counts") {
  TEST_CASE("each loss has a name of its own, and what was sent is what came and what did not") {
    StreamStats stats;
    stats.records = 359;
    stats.missed = 98;
    stats.bad_records = 12;
    stats.ring_refused = 7;
    stats.too_fast = 1000; // delivered, and nothing that was lost
    stats.unplugged = 2000;
    stats.clamped = 31;
    stats.counts_missed = true;
    const RecordCounts counts = counts_of(stats);
    const std::map<std::string, std::uint64_t> expected{
        {"sent", 457},  {"delivered", 359},  {"missed", 98},
        {"refused", 7}, {"bad_records", 12}, {"clamped_values", 31}};
    const auto named = by_name(counts);
    REQUIRE(named.size() == expected.size());
    for (const auto& [name, count] : named)
      CHECK(expected.at(std::string(name)) == count);
    auto in_text = numbers_in(in_words(counts));
    CHECK(in_text.at("bad records") == 12);
    CHECK(in_text.at("values out of range") == 31);
    for (const char* name : {"sent", "delivered", "missed", "refused"})
      CHECK(in_text.at(name) == expected.at(name));
    CHECK(in_text.size() == expected.size());
    stats.clamped = 0;
    CHECK(in_words(counts_of(stats)).find("range") == std::string::npos);
  }

  TEST_CASE("unknown counts are left out: neither sent nor missed") {
    StreamStats stats;
    stats.records = 357;
    const RecordCounts counts = counts_of(stats);
    for (const auto& [name, count] : by_name(counts))
      CHECK(count.has_value() == (name != "sent" && name != "missed"));
    const std::string words = in_words(counts);
    CAPTURE(words);
    CHECK(words.starts_with("357 delivered, 0 refused, 0 bad records"));
    CHECK(words.find(" sent") == std::string::npos);
    CHECK(words.find("missed") == std::string::npos);
  }

  TEST_CASE("a rate below the requested one is reported if losses cannot be counted") {
    StreamStats stats;
    stats.rate_hz = 72.0;
    CHECK(rate_shortfall(90.0, stats) == "72.0 records per second of the 90.0 that were asked for");
    stats.counts_missed = true; // the counts show it already
    CHECK(rate_shortfall(90.0, stats).empty());
    stats.counts_missed = false;
    stats.rate_hz = 89.0;
    CHECK(rate_shortfall(90.0, stats).empty());
    stats.rate_hz = 0.0; // nothing was measured yet
    CHECK(rate_shortfall(90.0, stats).empty());
    stats.rate_hz = 1.0;
    CHECK(rate_shortfall(0.0, stats).empty()); // no rate was requested
  }

  TEST_CASE("what was counted since some moment is the difference of each count") {
    const RecordCounts earlier{100, 10, 1, 2};
    const RecordCounts now{150, 30, 4, 8};
    CHECK(since(earlier, now) == RecordCounts{50, 20, 3, 6});
    CHECK(since({}, now) == now);
    CHECK(since(now, now).sent() == 0);
    CHECK(since(earlier, now).sent() == now.sent() - earlier.sent());
  }
}

} // namespace record_counts_test
