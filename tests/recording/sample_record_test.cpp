#include <nendo/recording/sample_record.hpp>

#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <nendo/recording/take_reader.hpp>

namespace sample_record_test {

using namespace nendo;
using namespace nendo::recording;

namespace {

GloveSample random_sample(std::mt19937_64& random) {
  const auto time = [&] { return std::chrono::nanoseconds(random() >> 4U); };
  GloveSample sample;
  sample.arrival = HostTime(time());
  sample.measured = HostTime(time());
  sample.device_time = -time();
  sample.sequence = random();
  sample.present.bits = static_cast<std::uint32_t>(random() >> 40U);
  for (auto& count : sample.raw)
    count.value = static_cast<std::uint16_t>(random());
  sample.has_device_time = (random() & 1U) != 0;
  sample.sampled_too_fast = (random() & 1U) != 0;
  sample.wrist_switch = static_cast<WristSwitch>(random() % 3);
  sample.side = (random() & 1U) != 0 ? Side::left : Side::right;
  return sample;
}

bool same(const GloveSample& a, const GloveSample& b) {
  return a.arrival == b.arrival && a.measured == b.measured && a.device_time == b.device_time &&
         a.sequence == b.sequence && a.raw == b.raw && a.present == b.present &&
         a.has_device_time == b.has_device_time && a.sampled_too_fast == b.sampled_too_fast &&
         a.wrist_switch == b.wrist_switch && a.side == b.side;
}

} // namespace

TEST_SUITE("sample_record") {
  TEST_CASE(
      "an input log gives samples back as they were, and passes over kinds it does not know") {
    std::mt19937_64 random(7);
    std::vector<std::byte> payload;
    ByteWriter writer(payload);
    std::vector<RecordedSample> samples;
    for (int turn = 0; turn < 500; ++turn) {
      samples.push_back({static_cast<std::uint8_t>(turn % 2), random_sample(random)});
      put_entry(writer, samples.back());
      writer.u8(200); // a kind of the future, of three bytes
      writer.u8(3);
      writer.bytes(std::array<std::byte, 3>{});
    }
    LogEntries records(payload);
    std::size_t at = 0;
    while (const auto record = records.next()) {
      if (!record->is(EntryKind::sample)) continue;
      const auto read = sample_of(*record);
      REQUIRE(read);
      CHECK(read->glove == samples[at].glove);
      CHECK(same(read->sample, samples[at++].sample));
    }
    CHECK(at == samples.size());
    CHECK(records.ended_well());
  }

  TEST_CASE("an input log that ends in the middle of an entry says so") {
    std::vector<std::byte> payload;
    ByteWriter writer(payload);
    put_entry(writer, RecordedSample{});
    for (std::size_t size = 1; size < payload.size(); ++size) {
      LogEntries records{std::span(payload).first(size)};
      CHECK_FALSE(records.next().has_value());
      CHECK_FALSE(records.ended_well());
    }
  }

  TEST_CASE("samples that no glove sends are refused: times a century off, slots, switches") {
    const auto accepted = [](const GloveSample& sample) {
      std::vector<std::byte> payload;
      ByteWriter writer(payload);
      put_entry(writer, RecordedSample{0, sample});
      return sample_of(*LogEntries(payload).next()).has_value();
    };
    GloveSample sample;
    CHECK(accepted(sample));
    for (const auto far : {std::numeric_limits<std::int64_t>::max(),
                           std::numeric_limits<std::int64_t>::min(), std::int64_t{1} << 61}) {
      sample = {};
      sample.arrival = HostTime(std::chrono::nanoseconds(far));
      CHECK_FALSE(accepted(sample));
      sample = {};
      sample.device_time = std::chrono::nanoseconds(far);
      CHECK_FALSE(accepted(sample));
    }
    sample = {};
    sample.present.bits = 1U << 24U;
    CHECK_FALSE(accepted(sample));
    sample = {};
    sample.wrist_switch = static_cast<WristSwitch>(3);
    CHECK_FALSE(accepted(sample));
  }

  TEST_CASE("who a glove is comes back, printable whatever it was") {
    RecordedGlove glove;
    glove.number = 1;
    glove.info.source = "serial:/dev/ttyS0";
    glove.info.model = "CyberGlove\x1b[2J";
    glove.info.side = Side::left;
    glove.info.sensors = sensors_18;
    glove.info.rate_hz = 90.5;
    glove.info.counts = {1023, true};
    glove.info.abilities = {true, false, true, false};
    glove.info.facts = {{"serial", "7\xff"}};
    std::vector<std::byte> payload;
    ByteWriter writer(payload);
    put_glove(writer, glove);
    const auto read = glove_of(payload);
    REQUIRE(read);
    CHECK(read->number == 1);
    CHECK(read->info.source == glove.info.source);
    CHECK(read->info.model == "CyberGlove?[2J");
    CHECK(read->info.side == Side::left);
    CHECK(read->info.sensors == sensors_18);
    CHECK(read->info.rate_hz == 90.5);
    CHECK(read->info.counts == glove.info.counts);
    CHECK(read->info.abilities.wrist_switch);
    CHECK_FALSE(read->info.abilities.light);
    CHECK(read->info.abilities.vibration);
    REQUIRE(read->info.facts.size() == 1);
    CHECK(read->info.facts[0].name == "serial");
    CHECK(read->info.facts[0].value == "7?");
    for (std::size_t size = 0; size < payload.size(); ++size)
      CHECK_FALSE(glove_of(std::span(payload).first(size)).has_value());
  }
}

} // namespace sample_record_test
