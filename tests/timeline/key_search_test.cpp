#include <doctest/doctest.h>

#include "support/timelines.hpp"
#include "timeline/timeline.hpp"

namespace key_search_test {

using namespace nendo;
using namespace nendo::timeline;

TEST_SUITE("key_search") {
  TEST_CASE("the key after and the key before are the nearest of all that are later, or earlier") {
    std::mt19937 random(1);
    const Timeline made = test::random_timeline(random, 12);
    std::vector<double> times{-1.0, 0.0, 1e9};
    for (const auto& hand : made.hands)
      for (const Key& key : hand.keys)
        for (const double off : {-1e-9, 0.0, 1e-9})
          times.push_back(key.time_s + off);
    for (const std::optional<Side> side :
         {std::optional<Side>(), std::optional(Side::left), std::optional(Side::right)})
      for (const double time_s : times) {
        double later_s = 1e300;
        double earlier_s = -1e300;
        for (const auto& hand : made.hands)
          for (const Key& key : hand.keys) {
            if (side && hand.side != *side) continue;
            if (key.time_s > time_s) later_s = std::min(later_s, key.time_s);
            if (key.time_s < time_s) earlier_s = std::max(earlier_s, key.time_s);
          }
        const auto after = key_after(made, time_s, side);
        const auto before = key_before(made, time_s, side);
        CHECK((after ? find_key(made, *after)->time_s : 1e300) == later_s);
        CHECK((before ? find_key(made, *before)->time_s : -1e300) == earlier_s);
      }
  }

  TEST_CASE("a key is found at its very time, and what does not exist is not") {
    std::mt19937 random(2);
    Timeline made = test::random_timeline(random);
    const double time_s = made.hands[1].keys[3].time_s;
    CHECK(key_at(made, Side::right, time_s) == KeyRef{Side::right, 3});
    CHECK_FALSE(key_at(made, Side::right, time_s + 1e-9));
    CHECK(find_key(made, {Side::right, 99}) == nullptr);
    made.hands.erase(made.hands.begin());
    CHECK(find_key(made, {Side::left, 0}) == nullptr);
    CHECK_FALSE(key_at(made, Side::left, 0.0));
    CHECK_FALSE(key_after(made, 0.0, Side::left));
  }
}

} // namespace key_search_test
