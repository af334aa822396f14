#include "export/chosen_frames.hpp"

#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "support/scripted_frames.hpp"

namespace chosen_frames_test {

using namespace nendo;
using namespace nendo::exporting;
using nendo::test::ScriptedFrames;

namespace {

std::vector<double> even(std::size_t count, double rate_hz) {
  std::vector<double> times_s;
  for (std::size_t at = 0; at < count; ++at)
    times_s.push_back(0.05 + static_cast<double>(at) / rate_hz);
  return times_s;
}

struct Taken {
  std::vector<std::uint64_t> frames;
  std::vector<double> times_s;
};

Taken take_all(ChosenFrames& chosen) {
  Taken taken;
  for (auto more = chosen.next(); more && *more; more = chosen.next()) {
    taken.frames.push_back(chosen.frame().tick);
    taken.times_s.push_back(chosen.time_s());
  }
  return taken;
}

} // namespace

TEST_SUITE("chosen_frames") {
  TEST_CASE("without a rate it is every frame between two times, at its own time") {
    const auto times_s = even(50, 90.0);
    ScriptedFrames all(times_s);
    auto chosen = ChosenFrames::make(all, {});
    REQUIRE(chosen);
    CHECK_FALSE(chosen->count());
    CHECK(take_all(*chosen).times_s == times_s);
    ScriptedFrames some(times_s);
    auto part = ChosenFrames::make(some, {.from_s = times_s[10], .to_s = times_s[20]});
    REQUIRE(part);
    const Taken taken = take_all(*part);
    CHECK(taken.frames.size() == 11);
    CHECK(taken.frames.front() == 10);
    CHECK(part->made() == 11);
  }

  TEST_CASE("at a rate it is the frame nearest to each moment, however late each came") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> late(0.0, 0.4 / 90.0);
    auto times_s = even(900, 90.0);
    for (std::size_t at = 1; at < times_s.size(); ++at)
      times_s[at] += late(random);
    for (const double rate_hz : {24.0, 30.0, 60.0, 90.0}) {
      ScriptedFrames source(times_s);
      auto chosen = ChosenFrames::make(source, {.rate_hz = rate_hz});
      REQUIRE(chosen);
      const Taken taken = take_all(*chosen);
      REQUIRE(taken.frames.size() == *chosen->count());
      CHECK(taken.frames.size() ==
            1 + static_cast<std::size_t>((times_s.back() - times_s.front()) * rate_hz + 1e-6));
      for (std::size_t at = 0; at < taken.frames.size(); ++at) {
        CHECK(taken.times_s[at] ==
              doctest::Approx(times_s.front() + static_cast<double>(at) / rate_hz));
        const double gap = std::abs(times_s[taken.frames[at]] - taken.times_s[at]);
        CHECK(gap <= 0.5 / 90.0 + late.max());
      }
    }
    ScriptedFrames source(times_s);
    auto third = ChosenFrames::make(source, {.rate_hz = 30.0});
    const Taken taken = take_all(*third);
    for (std::size_t at = 0; at < taken.frames.size(); ++at)
      CHECK(taken.frames[at] == 3 * at); // no stutter
  }

  TEST_CASE("whatever the two rates are, no other frame is nearer to its moment") {
    std::mt19937 random(4);
    for (const double latest : {0.0, 0.2, 0.4}) { // of a period
      for (const double source_hz : {20.0, 30.0, 90.0}) {
        std::uniform_real_distribution<double> late(0.0, latest / source_hz);
        auto times_s = even(200, source_hz);
        for (std::size_t at = 1; at < times_s.size() && latest > 0.0; ++at)
          times_s[at] += late(random);
        for (const double rate_hz : {7.0, 24.0, 30.0, 60.0, 77.7, 90.0, 240.0}) {
          CAPTURE(latest);
          CAPTURE(source_hz);
          CAPTURE(rate_hz);
          ScriptedFrames source(times_s, source_hz);
          auto chosen = ChosenFrames::make(source, {.rate_hz = rate_hz});
          REQUIRE(chosen);
          const Taken taken = take_all(*chosen);
          REQUIRE(taken.frames.size() == *chosen->count());
          double worst_s = 0.0;
          for (std::size_t at = 0; at < taken.frames.size(); ++at) {
            double nearest_s = 1e9;
            for (const double time_s : times_s)
              nearest_s = std::min(nearest_s, std::abs(time_s - taken.times_s[at]));
            const double off_s = std::abs(times_s[taken.frames[at]] - taken.times_s[at]);
            worst_s = std::max(worst_s, off_s - nearest_s);
          }
          CHECK(worst_s < 1e-12);
        }
      }
    }
  }

  TEST_CASE("where frames are missing the one before stays, and none comes early") {
    auto times_s = even(90, 90.0);
    times_s.erase(times_s.begin() + 30, times_s.begin() + 60);
    ScriptedFrames source(times_s);
    auto chosen = ChosenFrames::make(source, {.rate_hz = 90.0});
    REQUIRE(chosen);
    const Taken taken = take_all(*chosen);
    REQUIRE(taken.frames.size() == 90);
    for (std::size_t at = 0; at < 90; ++at)
      CHECK(taken.frames[at] == (at < 30 ? at : at < 60 ? 29 : at - 30));
  }

  TEST_CASE("a higher rate shows frames again") {
    ScriptedFrames source(even(10, 30.0), 30.0);
    auto chosen = ChosenFrames::make(source, {.rate_hz = 90.0});
    REQUIRE(chosen);
    CHECK(take_all(*chosen).frames.size() == 28);
  }

  TEST_CASE("what cannot be is refused, and so is more than anybody can use") {
    const double nan = std::nan("");
    for (const Choice& choice :
         {Choice{.from_s = nan}, Choice{.from_s = -1.0}, Choice{.from_s = 2.0, .to_s = 1.0},
          Choice{.to_s = nan}, Choice{.rate_hz = 0.0}, Choice{.rate_hz = nan},
          Choice{.rate_hz = 1e6}, Choice{.to_s = 1e300}}) {
      ScriptedFrames source(even(10, 90.0));
      const auto chosen = ChosenFrames::make(source, choice);
      REQUIRE_FALSE(chosen);
      CHECK(chosen.error().code == Errc::usage);
    }
    ScriptedFrames early(even(10, 90.0));
    const auto none = ChosenFrames::make(early, {.from_s = 5.0});
    REQUIRE_FALSE(none);
    CHECK(none.error().code == Errc::bad_input);
    ScriptedFrames between({0.1, 0.9});
    CHECK_FALSE(ChosenFrames::make(between, {.from_s = 0.2, .to_s = 0.8}));
    ScriptedFrames centuries({0.0, 9e6});
    const auto too_many = ChosenFrames::make(centuries, {.rate_hz = 30.0});
    REQUIRE_FALSE(too_many);
    CHECK(too_many.error().code == Errc::usage);
  }
}

} // namespace chosen_frames_test
