#include "cyberglove/record_check.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace record_check_test {

using namespace nendo::driver::cyberglove;

namespace {

constexpr std::uint32_t period = 1152; ///< 100 records per second

std::uint32_t below(std::mt19937& random, std::uint32_t bound) {
  return static_cast<std::uint32_t>(random() % bound);
}

/// A stream of records before a check; what was sent, delivered and missed.
struct Stream {
  explicit Stream(std::uint64_t period_ticks) : check(period_ticks) {}

  /// A record that reaches the check; is it plausible?
  bool send(std::uint32_t ticks, bool late = false, std::uint8_t status = 0x87) {
    ++sent;
    Record record;
    record.ticks = ticks;
    record.status = status;
    record.stamp = Stamp::continues;
    record.sampled_too_fast = late;
    const Verdict verdict = check(record);
    stamp = record.stamp;
    missed += verdict.missed;
    if (verdict.plausible) ++delivered;
    return verdict.plausible;
  }
  /// A record that gets lost on the way.
  void lose(std::uint64_t count = 1) { sent += count; }
  bool adds_up() const { return sent == delivered + missed; }

  RecordCheck check;
  std::uint64_t sent = 0, delivered = 0, missed = 0;
  Stamp stamp = Stamp::none; ///< the last record's stamp
};

/// A device whose stamps err evenly, by at most `part` of a period to either side.
class Wandering {
public:
  Wandering(double part, unsigned seed)
      : max_(static_cast<std::uint32_t>(part * period)), random_(seed),
        start_(0U - below(random_, 100 * period)) {}

  /// The stamp of record k; it wraps before long.
  std::uint32_t operator()(std::uint32_t k) {
    return punctual(k) + below(random_, 2 * max_ + 1) - max_;
  }
  std::uint32_t punctual(std::uint32_t k) const { return start_ + k * period; }

private:
  std::uint32_t max_;
  std::mt19937 random_;
  std::uint32_t start_;
};

/// What a device's jitter costs: of ten thousand records so many are refused, and of the 32 bits of
/// a stamp so many, on average, can turn over unnoticed.
struct Cost {
  double refused = 0.0;
  double unnoticed = 0.0;
};

Cost cost_of(double part) {
  constexpr int streams = 50;
  constexpr std::uint32_t records = 1000;
  std::uint32_t refused = 0;
  std::uint32_t unnoticed = 0;
  std::uint32_t tried = 0;
  for (int n = 0; n < streams; ++n) {
    Wandering device(part, 1 + static_cast<unsigned>(n));
    Stream stream(period);
    for (std::uint32_t k = 0; k < records; ++k) {
      const std::uint32_t ticks = device(k);
      for (unsigned bit = 0; bit < 32 && k % 50 == 49; ++bit, ++tried)
        unnoticed += Stream(stream).send(ticks ^ 1U << bit) ? 1U : 0U;
      refused += stream.send(ticks) ? 0U : 1U;
    }
  }
  return {1e4 * refused / (streams * records), 32.0 * unnoticed / tried};
}

/// Header, 22 values, flags, ticks, status, NUL, as published; no byte is 0 or a power of two.
std::array<std::byte, 30> record_bytes(std::uint32_t ticks) {
  std::array<std::byte, 30> bytes{std::byte{'S'}};
  for (std::size_t k = 0; k < 22; ++k)
    bytes[1 + k] = static_cast<std::byte>(131 + k);
  bytes[23] = std::byte{0x80};
  for (std::size_t k = 0; k < 4; ++k) {
    bytes[24 + k] = static_cast<std::byte>(ticks >> 8 * k);
    REQUIRE(std::popcount(std::to_integer<unsigned>(bytes[24 + k])) > 1);
  }
  bytes[28] = std::byte{0x87};
  return bytes;
}

} // namespace

TEST_SUITE("record_check") {
  TEST_CASE("a steady stream passes, across the wrap of its stamps too") {
    Stream stream(period);
    std::uint32_t ticks = 0xFFFFFFFF - 50 * period;
    for (int k = 0; k < 100; ++k, ticks += period) {
      CHECK(stream.send(ticks));
      CHECK(stream.stamp == (k == 0 ? Stamp::begins : Stamp::continues));
    }
    CHECK(stream.missed == 0);
    CHECK(stream.check.period_ticks() == period);
  }

  TEST_CASE("records sent are delivered or missed, exactly, whatever is lost and damaged") {
    std::mt19937 random(3);
    for (const std::uint32_t given : {1152U, 768U, 57'600U, 0U}) {
      CAPTURE(given);
      Stream stream(given);
      const std::uint32_t step = given == 0 ? period : given;
      std::uint32_t ticks = 12'345;
      std::uint32_t unseen = 0; // since the last delivered one; 15 are bridged at once
      bool damaged = false;     // three in a row would agree with each other
      for (int k = 0; k < 20'000; ++k, ticks += step) {
        const std::uint32_t chance = k < 3 || unseen > 5 ? 99 : below(random, 10);
        if (chance == 0) {
          const std::uint32_t lost = 1 + below(random, 9);
          stream.lose(lost);
          unseen += lost;
          ticks += (lost - 1) * step;
        } else if (chance == 1 && given != 0 && !damaged) {
          CHECK_FALSE(stream.send(ticks + step / 2));
          damaged = true;
          ++unseen;
        } else {
          CHECK(stream.send(ticks + below(random, step / 32)));
          CHECK(stream.adds_up());
          damaged = false;
          unseen = 0;
        }
      }
      CHECK(stream.missed > 5000);
    }
  }

  TEST_CASE("of all single-bit flips in a record, 186 of 240 slip through and 4 do no harm") {
    constexpr std::uint32_t start = 0x67A9B3D5;
    int caught = 0;
    int harmless = 0;
    int slipped = 0;
    int sensor_bits = 0;
    for (std::size_t bit = 0; bit < 240; ++bit) {
      CAPTURE(bit);
      Parser parser({22, true, true});
      RecordCheck check(period);
      std::vector<Record> records;
      const auto sink = [&](const Record& record) { records.push_back(record); };
      for (std::uint32_t k = 23; k > 3; --k) { // it knows then that the stamps are punctual
        Record punctual;
        punctual.ticks = start - k * period;
        punctual.status = 0x87;
        punctual.stamp = Stamp::continues;
        REQUIRE(check(punctual).plausible);
      }
      for (std::uint32_t k = 0; k < 3; ++k)
        parser.push(record_bytes(start - (3 - k) * period), check, sink);
      auto flipped = record_bytes(start);
      flipped[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
      parser.push(flipped, check, sink);
      REQUIRE(records.size() >= 3);
      if (records.size() == 3) {
        ++caught;
      } else {
        const auto truth = decode_record(record_bytes(start), {22, true, true});
        REQUIRE(truth);
        const bool same = records[3].values == truth->values && records[3].ticks == truth->ticks &&
                          records[3].status == truth->status;
        ++(same ? harmless : slipped);
        if (records[3].values != truth->values) ++sensor_bits;
      }
      // Whatever happened, the stream continues: at most the next record is lost with it.
      for (std::uint32_t k = 1; k < 5; ++k)
        parser.push(record_bytes(start + k * period), check, sink);
      CHECK(records.back().ticks == start + 4 * period);
      CHECK(parser.counters().records + parser.counters().missed == 8);
      CHECK(parser.counters().missed <= 2);
    }
    CHECK(sensor_bits == 22 * 8);
    CHECK(slipped == 22 * 8 + 8 + 2);
    CHECK(harmless == 4);
    CHECK(caught == 50);
  }

  TEST_CASE("stamps that wander by up to a sixteenth of a period are never refused") {
    std::mt19937 random(11);
    for (const double part : {1.0 / 64, 1.0 / 25, 1.0 / 20, 1.0 / 16}) {
      CAPTURE(part);
      for (const std::uint32_t punctual : {0U, 1U, 100U}) { // records, until they begin to
        Wandering device(part, punctual);
        Stream stream(period);
        for (std::uint32_t k = 0; k < 5000; ++k) {
          REQUIRE(stream.send(k < punctual ? device.punctual(k) : device(k)));
          CHECK(stream.adds_up());
          if (k < punctual + 100 || below(random, 20) != 0) continue;
          const std::uint32_t lost = 1 + below(random, 5);
          stream.lose(lost);
          k += lost;
        }
        CHECK(stream.missed > 100);
      }
    }
  }

  TEST_CASE("stamps that begin to wander by more are refused a few times at most") {
    for (const double part : {0.08, 0.1, 0.15, 0.2, 0.25}) {
      CAPTURE(part);
      std::uint32_t refused = 0;
      for (unsigned n = 0; n < 100; ++n) {
        Wandering device(part, n);
        Stream stream(period);
        for (std::uint32_t k = 0; k < 100; ++k)
          stream.send(device.punctual(k));
        for (std::uint32_t k = 100; k < 300; ++k)
          refused += stream.send(device(k)) ? 0U : 1U;
      }
      CHECK(refused < 500); // in a hundred streams
    }
  }

  TEST_CASE("what jitter costs is as FAULTS.md says") {
    struct Row {
      double part, refused, unnoticed;
    };
    for (const Row& row : {Row{0.0, 0.0, 8.0}, Row{1.0 / 64, 0.0, 7.9}, Row{1.0 / 32, 0.0, 8.6},
                           Row{0.04, 0.0, 9.2}, Row{0.06, 0.0, 10.5}, Row{1.0 / 16, 0.0, 10.6},
                           Row{0.09, 0.0, 11.1}, Row{1.0 / 8, 0.0, 11.3}, Row{0.15, 0.0, 12.2},
                           Row{0.2, 0.8, 12.3}, Row{0.25, 14.6, 12.2}, Row{0.3, 220.0, 12.0}}) {
      CAPTURE(row.part);
      const Cost cost = cost_of(row.part);
      CHECK(std::abs(cost.refused - row.refused) < 0.05);
      CHECK(std::abs(cost.unnoticed - row.unnoticed) < 0.051);
    }
  }

  TEST_CASE("a wrong stamp costs its own record and no other") {
    for (const std::uint32_t wrong : {0U, 1U << 31U, 1U << 20U, period / 2, 0U - period}) {
      CAPTURE(wrong);
      Stream stream(period);
      CHECK(stream.send(1'000'000));
      CHECK_FALSE(stream.send(1'000'000 + wrong));
      CHECK(stream.send(1'000'000 + 2 * period));
      CHECK(stream.missed == 1);
      CHECK(stream.adds_up());
    }
  }

  TEST_CASE("a clock that restarted, or another period, is believed at the third record") {
    for (const std::uint32_t next : {period, 768U, 11'520U}) {
      CAPTURE(next);
      Stream stream(period);
      for (std::uint32_t k = 0; k < 20; ++k)
        CHECK(stream.send(50'000'000 + k * period));
      CHECK_FALSE(stream.send(77));
      CHECK_FALSE(stream.send(77 + next));
      CHECK(stream.send(77 + 2 * next));
      CHECK(stream.stamp == Stamp::begins);
      CHECK(stream.missed == 2);
      CHECK(stream.check.period_ticks() == next);
      for (std::uint32_t k = 3; k < 20; ++k) {
        CHECK(stream.send(77 + k * next));
        CHECK(stream.stamp == Stamp::continues);
      }
      CHECK(stream.adds_up());
    }
  }

  TEST_CASE("after a silence of seconds the third record is delivered and the lost ones counted") {
    Stream stream(period);
    CHECK(stream.send(500));
    CHECK(stream.send(500 + period));
    stream.lose(700);
    const std::uint32_t ticks = 500 + 702 * period;
    CHECK_FALSE(stream.send(ticks));
    CHECK_FALSE(stream.send(ticks + period));
    CHECK(stream.send(ticks + 2 * period));
    CHECK(stream.stamp == Stamp::continues);
    CHECK(stream.missed == 702);
    CHECK(stream.adds_up());
  }

  TEST_CASE("a period that is not given is learnt, also while records are lost") {
    Stream stream(0);
    CHECK(stream.send(1000));
    stream.lose();
    CHECK(stream.send(1000 + 2 * period));
    stream.lose(2);
    CHECK(stream.send(1000 + 5 * period));
    CHECK(stream.send(1000 + 6 * period));
    CHECK(stream.adds_up());
    CHECK(stream.check.period_ticks() == period);
  }

  TEST_CASE("a stream as fast as possible may take a fifth more or less of its usual time") {
    std::mt19937 random(4);
    Stream stream(0);
    std::uint32_t ticks = 9;
    for (int k = 0; k < 10'000; ++k) {
      ticks += 800 + below(random, 400);
      CHECK(stream.send(ticks));
    }
    CHECK(stream.missed == 0);
    CHECK(stream.check.period_ticks() > 850);
    CHECK(stream.check.period_ticks() < 1150);
  }

  TEST_CASE("a glove that does not keep the period it was given is believed before long") {
    std::mt19937 random(6);
    Stream stream(period);
    std::uint32_t ticks = 9;
    int refused = 0;
    for (int k = 0; k < 2000; ++k) {
      ticks += period - 400 + below(random, 800);
      if (!stream.send(ticks)) ++refused;
    }
    CHECK(refused < 100);
    for (int k = 0; k < 1000; ++k) {
      ticks += period - 400 + below(random, 800);
      CHECK(stream.send(ticks));
    }
  }

  TEST_CASE("stamps that stop or make no sense are not believed, and the records pass") {
    std::mt19937 random(8);
    for (const bool still : {true, false}) {
      Stream stream(period);
      for (int k = 0; k < 30; ++k)
        stream.send(still ? 65'538 : static_cast<std::uint32_t>(random()));
      for (int k = 0; k < 100; ++k) {
        CHECK(stream.send(still ? 65'538 : static_cast<std::uint32_t>(random())));
        CHECK(stream.stamp == Stamp::none);
      }
      CHECK(stream.adds_up());
      for (std::uint32_t k = 1; k < 10; ++k)
        CHECK(stream.send(1'000'000 + k * period));
      CHECK(stream.stamp == Stamp::continues);
    }
  }

  TEST_CASE("records sampled late, as the glove says, are neither refused nor taken for a loss") {
    std::mt19937 random(9);
    Stream stream(period);
    bool late = false;
    for (std::uint32_t k = 1; k < 5000; ++k) {
      const bool was_late = std::exchange(late, random() % 5 == 0);
      if (!(was_late && late) && random() % 5 == 0) { // between two late ones it could not be seen
        stream.lose();
        ++k;
      }
      const std::uint32_t delay = late ? below(random, period * 7 / 10) : 0;
      CHECK(stream.send(k * period + delay - below(random, period / 32), late));
      CHECK(stream.adds_up());
    }
    CHECK(stream.missed > 500);
  }

  TEST_CASE("a glove that is too slow for its period throughout misses nothing but what is lost") {
    for (const std::uint32_t pace : {1400U, 3000U, 10'000U}) {
      CAPTURE(pace);
      Stream stream(period);
      std::uint32_t ticks = 5;
      for (int k = 0; k < 100; ++k)
        CHECK(stream.send(ticks += pace, true));
      stream.lose();
      CHECK(stream.send(ticks += 2 * pace, true));
      CHECK(stream.missed == 1);
      CHECK(stream.adds_up());
    }
  }

  TEST_CASE("of the status byte, switch and light may change and the rest may not") {
    for (unsigned bit = 0; bit < 8; ++bit) {
      CAPTURE(bit);
      Stream stream(period);
      CHECK(stream.send(100));
      const bool may = bit == 1 || bit == 2;
      CHECK(stream.send(100 + period, false, static_cast<std::uint8_t>(0x87U ^ (1U << bit))) ==
            may);
      CHECK(stream.send(100 + 2 * period));
      CHECK(stream.missed == (may ? 0 : 1));
    }
  }

  TEST_CASE("reserved bits that change for good are believed at the third record, no glove never") {
    Stream stream(period);
    CHECK(stream.send(0));
    CHECK_FALSE(stream.send(period, false, 0x8F));
    CHECK_FALSE(stream.send(2 * period, false, 0x8F));
    for (std::uint32_t k = 3; k < 20; ++k)
      CHECK(stream.send(k * period, false, 0x8F));
    CHECK(stream.adds_up());
    for (std::uint32_t k = 20; k < 40; ++k)
      CHECK_FALSE(stream.send(k * period, false, 0x8E));
  }

  TEST_CASE("without a time stamp the status alone is checked, without either nothing is") {
    RecordCheck check(period);
    Record record;
    for (int k = 0; k < 10; ++k)
      CHECK(check(record).plausible);
    record.status = 0x81;
    CHECK(check(record).plausible);
    record.status = 0xC1;
    CHECK_FALSE(check(record).plausible);
    record.status = 0x83;
    CHECK(check(record).plausible);
    CHECK(record.stamp == Stamp::none);
  }

  TEST_CASE("no past makes it refuse a good stream for long") {
    std::mt19937 random(10);
    for (int round = 0; round < 2000; ++round) {
      const std::array<std::uint64_t, 5> givens{0, 1, period, 1ULL << 25U, ~0ULL};
      Stream stream(givens[random() % givens.size()]);
      std::uint32_t ticks = 0;
      for (auto k = random() % 60; k > 0; --k) {
        ticks += static_cast<std::uint32_t>(random()) >> random() % 32;
        stream.send(ticks, random() % 4 == 0,
                    static_cast<std::uint8_t>(0x81U | (random() & 0x7FU)));
      }
      ticks = static_cast<std::uint32_t>(random());
      for (int k = 0; k < 40; ++k)
        stream.send(ticks += period);
      for (int k = 0; k < 20; ++k)
        CHECK(stream.send(ticks += period));
    }
  }
}

} // namespace record_check_test
