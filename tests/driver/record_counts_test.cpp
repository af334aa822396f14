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
    GloveStats stats;
    stats.records = 359;
    stats.missed = 98;
    stats.bad_records = 12;
    stats.ring_refused = 7;
    stats.too_fast = 1000; // delivered, and nothing that was lost
    stats.unplugged = 2000;
    const RecordCounts counts = counts_of(stats);
    const std::map<std::string, std::uint64_t> expected{
        {"sent", 457}, {"delivered", 359}, {"missed", 98}, {"refused", 7}, {"bad_records", 12}};
    const auto named = by_name(counts);
    REQUIRE(named.size() == expected.size());
    for (const auto& [name, count] : named)
      CHECK(expected.at(std::string(name)) == count);
    auto in_text = numbers_in(in_words(counts));
    CHECK(in_text.at("bad records") == 12);
    in_text["bad_records"] = in_text.at("bad records");
    in_text.erase("bad records");
    CHECK(in_text == expected);
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
