// The second simulator and its file: what is written is read back, and bad files are refused.

#include "bench/judged_wearer.hpp"

#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "bench/calibration_judge.hpp"
#include "bench/stranger.hpp"
#include "support/temporary_folder.hpp"

namespace judged_wearer_test {

using namespace nendo;
using namespace nendo::bench;
using nendo::test::TemporaryFolder;

TEST_SUITE("judged_wearer") {
  TEST_CASE("a wearer that is written is read back, and the same seed makes the same line") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "wearers.jsonl";
    const JudgedWearer made = make_stranger(1, sensors_18, {});
    std::ofstream(path) << line_of(made);
    CHECK(line_of(made) == line_of(make_stranger(1, sensors_18, {})));
    CHECK(line_of(made) != line_of(make_stranger(2, sensors_18, {})));
    auto wearers = JudgedWearers::open(path);
    REQUIRE(wearers);
    const auto read = wearers->next();
    REQUIRE(read);
    REQUIRE(read->has_value());
    CHECK(line_of(**read) == line_of(made));
    CHECK((*read)->sensors == sensors_18);
    const auto end = wearers->next();
    REQUIRE(end);
    CHECK_FALSE(end->has_value());
  }

  TEST_CASE("what is no wearer is refused with its line") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "wearers.jsonl";
    CHECK_FALSE(JudgedWearers::open(path));
    CHECK_FALSE(JudgedWearers::open(folder.path()));
    const std::string good = line_of(make_stranger(1, sensors_22, {}));
    const auto with = [&](const std::string& from, const std::string& to) {
      std::string text = good;
      text.replace(text.find(from), from.size(), to);
      return text;
    };
    for (const std::string& bad :
         {std::string("\n"), std::string("[]\n"), std::string("{}\n"), good.substr(0, 5000),
          with("\"thumb_roll\"", "\"thumb_rolls\""), with("\"flat\"", "\"flatt\""),
          with("\"angles_deg\":[", "\"angles_deg\":[1e9,"), with("\"right\"", "\"middle\""),
          with("\"mean_counts\":[", "\"mean_counts\":[300,")}) {
      CAPTURE(bad.substr(0, 200));
      std::ofstream(path) << good << bad;
      auto wearers = JudgedWearers::open(path);
      REQUIRE(wearers);
      REQUIRE(wearers->next());
      const auto second = wearers->next();
      REQUIRE_FALSE(second);
      CHECK(second.error().message.find(":2: ") != std::string::npos);
    }
  }

  TEST_CASE("strangers pinch, none is refused, and every group of joints is judged") {
    Verdict verdict;
    for (std::uint64_t seed = 9001; seed < 9004; ++seed) {
      const JudgedWearer wearer = make_stranger(seed, sensors_22, {});
      int touching = 0;
      for (const JudgedMoment& moment : wearer.fresh.motion)
        touching += moment.touching != 0 ? 1 : 0;
      CHECK(touching > 10);
      judge(wearer, verdict);
    }
    CHECK(verdict.wearers == 3);
    CHECK(verdict.refused.empty());
    for (const auto& errors : verdict.errors[0])
      CHECK_FALSE(errors.empty());
  }
}

} // namespace judged_wearer_test
