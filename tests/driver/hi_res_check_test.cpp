#include "cyberglove/record_check.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include <doctest/doctest.h>

namespace hi_res_check_test {

using namespace nendo;
using namespace nendo::driver::cyberglove;
using namespace std::chrono_literals;

namespace {

/// A glove that numbers its records, and a line that loses some of them.
struct Line {
  std::int64_t sub_frames = 3;
  unsigned first_sub_frame = 0;
  std::int64_t stride = 1;
  double loss = 0.2;
  std::int64_t number = 7; ///< number of the next record, since midnight
  bool seconds_stop = false;
  std::mt19937 random{5};
  HostTime now{1000s};

  double rate_hz() const { return 30.0 * static_cast<double>(sub_frames); }
  Record record() const {
    Record record;
    const std::int64_t frame = number / sub_frames;
    record.second = seconds_stop ? 7 : static_cast<std::uint32_t>(frame / 30 % 86'400);
    record.frame = static_cast<std::uint8_t>(frame % 30 + 1);
    record.sub_frame = static_cast<std::uint8_t>(number % sub_frames + first_sub_frame);
    return record;
  }
  void step() {
    number += stride;
    now += from_seconds(static_cast<double>(stride) / rate_hz());
  }
  bool loses() { return std::uniform_real_distribution<>(0.0, 1.0)(random) < loss; }
};

/// What came, and what the check knows of.
struct Tally {
  std::uint64_t lost = 0; ///< between the first and the last but one that came
  std::uint64_t missed = 0;
  bool counts = false;
};

/// `spoil(k, record)` may change the record k that comes.
template <class Spoil>
Tally run(Line line, HiResCheck check, int records, Spoil&& spoil) {
  Tally tally;
  std::uint64_t waiting = 0;
  std::uint64_t before_last = 0;
  int came = 0;
  for (int k = 0; k < records; ++k, line.step()) {
    if (k > 0 && line.loses()) {
      ++waiting;
      continue;
    }
    Record record = line.record();
    spoil(came++, record);
    const Verdict verdict = check(record, line.now + std::chrono::milliseconds(line.random() % 16));
    CHECK(verdict.plausible);
    tally.missed += verdict.missed;
    tally.lost += before_last;
    before_last = std::exchange(waiting, 0);
  }
  tally.counts = check.counts_missed();
  return tally;
}

Tally run(const Line& line, const HiResCheck& check, int records = 2000) {
  return run(line, check, records, [](int, Record&) {});
}

} // namespace

TEST_SUITE("hi_res_check") {
  TEST_CASE("what was lost is counted to the record, for each rate, from 0 or from 1") {
    for (const int sub_frames : {1, 2, 3, 4}) {
      for (const unsigned first : {0U, 1U}) {
        for (const double loss : {0.0, 0.01, 0.2, 0.6}) {
          CAPTURE(sub_frames);
          CAPTURE(first);
          CAPTURE(loss);
          Line line;
          line.sub_frames = sub_frames;
          line.first_sub_frame = first;
          line.loss = loss;
          const Tally set = run(line, HiResCheck(line.rate_hz()));
          CHECK(set.counts);
          CHECK(set.missed == set.lost);
          // The rate is not set: the sub-frames show it.
          const Tally learnt = run(line, HiResCheck());
          CHECK(learnt.counts);
          CHECK(learnt.missed == learnt.lost);
        }
      }
    }
  }

  TEST_CASE("before the numbering is known nothing is said") {
    Line line;
    const Tally few = run(line, HiResCheck(), 20);
    CHECK_FALSE(few.counts);
    CHECK(few.missed == 0);
  }

  TEST_CASE("midnight loses nothing") {
    Line line;
    line.number = 86'400 * 30 * line.sub_frames - 500;
    const Tally tally = run(line, HiResCheck(90.0));
    CHECK(tally.missed == tally.lost);
  }

  TEST_CASE("a clock whose seconds stop is no harm: arrivals show them") {
    Line line;
    line.seconds_stop = true;
    const Tally tally = run(line, HiResCheck(90.0), 5000);
    CHECK(tally.counts);
    CHECK(tally.missed == tally.lost);
  }

  TEST_CASE("a gap of many seconds is counted, whole seconds included") {
    for (const int gap : {1, 89, 90, 91, 900, 4500}) {
      CAPTURE(gap);
      for (const bool seconds_stop : {false, true}) {
        Line line;
        line.loss = 0.0;
        line.seconds_stop = seconds_stop;
        HiResCheck check(90.0);
        std::uint64_t missed = 0;
        const auto take = [&](int records) {
          for (int k = 0; k < records; ++k, line.step())
            missed += check(line.record(), line.now).missed;
        };
        take(200);
        for (int k = 0; k < gap; ++k)
          line.step();
        take(200);
        CHECK(missed == static_cast<std::uint64_t>(gap));
      }
    }
  }

  TEST_CASE("wrong digits in the time cost no count, whatever they say") {
    for (const int every : {50, 11}) {
      CAPTURE(every);
      std::mt19937 random(3);
      Line line;
      line.loss = 0.1;
      const Tally tally = run(line, HiResCheck(90.0), 20'000, [&](int k, Record& record) {
        if (k < HiResCheck::learning_records || k % every != 0) return;
        const auto draw = [&](unsigned below) { return static_cast<unsigned>(random() % below); };
        switch (draw(4)) {
        case 0:
          record.sub_frame = static_cast<std::uint8_t>(draw(10));
          break;
        case 1:
          record.frame = static_cast<std::uint8_t>((record.frame + 1U + draw(9)) % 31U);
          break;
        case 2:
          record.frame = static_cast<std::uint8_t>((record.frame + 31U - draw(7)) % 31U);
          break;
        default:
          record.second += 1U + draw(40);
        }
      });
      CHECK(tally.counts);
      // A wrong number beside a gap may look like a right one.
      const auto error = static_cast<double>(tally.missed) - static_cast<double>(tally.lost);
      CHECK(std::abs(error) <= 0.02 * static_cast<double>(tally.lost));
    }
  }

  TEST_CASE("a glove that is set to leave out every second record loses none by that") {
    Line line;
    line.sub_frames = 4;
    line.stride = 2;
    for (const double loss : {0.0, 0.2}) {
      line.loss = loss;
      const Tally tally = run(line, HiResCheck(120.0));
      CHECK(tally.missed == tally.lost);
    }
  }

  TEST_CASE("a clock that is set counts on from there, without the unknown") {
    Line line;
    line.loss = 0.0;
    HiResCheck check(90.0);
    std::uint64_t missed = 0;
    for (int k = 0; k < 1000; ++k, line.step()) {
      if (k == 400) line.number += 3600 * 90 + 1234;
      if (k == 700) line.number -= 1800 * 90 + 777;
      missed += check(line.record(), line.now).missed;
    }
    CHECK(missed <= 2 * 45); // half a second each
    CHECK(check.counts_missed());
  }

  TEST_CASE("numbers that make no sense are given up, and then losses are unknown") {
    HiResCheck check(90.0);
    std::mt19937 random(1);
    Line line;
    for (int k = 0; k < 3000; ++k, line.step()) {
      Record record;
      record.second = static_cast<std::uint32_t>(random() % 86'400);
      record.frame = static_cast<std::uint8_t>(random() % 31);
      record.sub_frame = static_cast<std::uint8_t>(random() % 10);
      check(record, line.now);
    }
    CHECK_FALSE(check.counts_missed());
  }
}

} // namespace hi_res_check_test
