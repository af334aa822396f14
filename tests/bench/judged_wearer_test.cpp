// The second simulator and its file: what is written is read back, and bad files are refused.

#include "bench/judged_wearer.hpp"

#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "bench/calibration_judge.hpp"
#include "bench/stranger.hpp"
#include "bench/stranger_floor.hpp"
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

  TEST_CASE("the free motion may be left out of what comes after the glove was put on again") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "wearers.jsonl";
    JudgedWearer made = make_stranger(1, sensors_22, {});
    CHECK(made.again.free_motion.size() >= 300);
    made.again.free_motion.clear();
    std::string line = line_of(made);
    const std::string empty = "\"free_motion\":[],";
    line.erase(line.find(empty), empty.size());
    std::ofstream(path) << line << line_of(made);
    auto wearers = JudgedWearers::open(path);
    REQUIRE(wearers);
    const auto without = wearers->next();
    REQUIRE_MESSAGE(without, without.error().message);
    CHECK(line_of(**without) == line_of(made));
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
          with("\"free_motion\"", "\"free_motions\""),
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
    for (const auto& errors : verdict.errors.back()) // nobody was told a true hand
      CHECK(errors.empty());
  }

  TEST_CASE("the floor closes pinches of the hand that it is told or finds, not of another one") {
    double own_mm = 0.0, found_mm = 0.0, other_mm = 0.0, touching = 0.0;
    for (std::uint64_t seed = 9004; seed < 9007; ++seed) {
      const JudgedWearer wearer = make_stranger(seed, sensors_22, {});
      const StrangerHand own_hand = hand_of_stranger(seed),
                         other_hand = hand_of_stranger(seed + 10);
      StrangerFloor own(wearer, &own_hand), found(wearer, nullptr), other(wearer, &other_hand);
      for (const JudgedMoment& moment : wearer.fresh.motion) {
        const auto own_angles = own.angles_rad(moment.counts);
        const auto found_angles = found.angles_rad(moment.counts);
        const auto other_angles = other.angles_rad(moment.counts);
        if (moment.touching == 0) continue;
        own_mm += 1e3 * own.pads_apart_m(own_angles, moment.touching);
        found_mm += 1e3 * found.pads_apart_m(found_angles, moment.touching);
        // The true hand at the angles that the other one led to.
        other_mm += 1e3 * own.pads_apart_m(other_angles, moment.touching);
        touching += 1.0;
      }
    }
    REQUIRE(touching > 30.0);
    CHECK(own_mm / touching < 6.0); // the true pads touch; slips and scatter leave some millimetres
    CHECK(own_mm < 0.7 * other_mm);
    CHECK(found_mm < 0.7 * other_mm);
    CHECK(found_mm != own_mm);
  }

  TEST_CASE("a hand is drawn part by part, from the means that the usual one has") {
    std::array<double, StrangerHand::parts> deviations{};
    const hand::SensorAngles flat{};
    const StrangerHand usual = StrangerHand::usual();
    CHECK(usual.pad(1, flat) == StrangerHand(deviations).pad(1, flat));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    constexpr int hands = 400;
    for (std::uint64_t seed = 0; seed < hands; ++seed)
      sum += hand_of_stranger(seed).pad(1, flat);
    CHECK((sum / hands - usual.pad(1, flat)).norm() < 0.002);
    for (double& deviation : deviations) { // each of them matters somewhere
      deviation = 1.0;
      const StrangerHand other(deviations);
      deviation = 0.0;
      hand::SensorAngles bent;
      bent.fill(0.4);
      double moved = (other.palm_at_little_finger(bent) - usual.palm_at_little_finger(bent)).norm();
      for (std::size_t digit = 0; digit < 5; ++digit)
        moved += (other.pad(digit, bent) - usual.pad(digit, bent)).norm();
      CHECK(moved > 1e-5);
    }
  }

  TEST_CASE("the floor is told of: a verdict with a true hand has its errors in every group") {
    Verdict verdict;
    const StrangerHand hand = hand_of_stranger(9010);
    judge(make_stranger(9010, sensors_18, {}), verdict, &hand);
    REQUIRE(verdict.refused.empty());
    for (std::size_t group = 0; group < judged_groups.size(); ++group)
      CHECK(verdict.errors.back()[group].size() == verdict.errors[0][group].size());
  }
}

} // namespace judged_wearer_test
