#include <nendo/recording/replay_driver.hpp>

#include <fstream>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/recording/take_reader.hpp>

#include "support/eventually.hpp"
#include "support/required.hpp"
#include "support/temporary_folder.hpp"

namespace replay_driver_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::driver;
using namespace nendo::recording;

namespace {

/// A recording of two gloves that sent `samples` each, 10 ms apart; the right one lost number 3.
struct Take {
  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "take.nendo";
  std::vector<GloveSample> right;

  explicit Take(int samples, HostClock::duration step = 10ms) {
    std::vector<std::byte> bytes;
    ByteWriter(bytes).bytes(file_header());
    std::uint32_t chunk = 0;
    std::vector<std::byte> payload;
    for (const Side side : {Side::left, Side::right}) {
      payload.clear();
      ByteWriter writer(payload);
      GloveInfo info;
      info.source = "sim";
      info.side = side;
      info.sensors = sensors_22;
      info.rate_hz = 100.0;
      put_glove(writer, {static_cast<std::uint8_t>(side), info});
      append_chunk(bytes, glove_chunk, chunk++, payload);
    }
    for (int at = 0; at < samples; ++at) {
      payload.clear();
      ByteWriter writer(payload);
      GloveSample sample;
      sample.arrival = HostTime(1h + at * step);
      sample.measured = sample.arrival - 2ms;
      sample.device_time = at * 10ms;
      sample.has_device_time = true;
      sample.sequence = static_cast<std::uint64_t>(1000 + at + (at >= 3 ? 1 : 0));
      sample.set(Sensor::index_mcp, RawCount{static_cast<std::uint16_t>(50 + at)});
      right.push_back(sample);
      put_entry(writer, RecordedSample{1, sample});
      sample.side = Side::left;
      put_entry(writer, RecordedSample{0, sample});
      append_chunk(bytes, log_chunk, chunk++, payload);
    }
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  std::string spec(const std::string& options) const { return "replay:" + path.string() + options; }
};

std::vector<GloveSample> samples_of(Glove& glove, std::size_t wanted) {
  std::vector<GloveSample> samples;
  SampleRing ring(1024);
  test::require_ok(glove.start(ring));
  test::eventually([&] {
    ring.drain([&](const GloveSample& sample) noexcept { samples.push_back(sample); });
    return samples.size() >= wanted;
  });
  glove.stop();
  return samples;
}

Result<std::unique_ptr<Glove>> open_replay(const std::string& spec, std::optional<Side> side = {}) {
  return open_glove(spec, side, {.drivers = {replay_driver()}});
}

Errc code_of(const std::string& spec, std::optional<Side> side = {}) {
  const auto glove = open_replay(spec, side);
  REQUIRE_FALSE(glove);
  CHECK(glove.error().message.find('\n') == std::string::npos);
  return glove.error().code;
}

} // namespace

TEST_SUITE("replay_driver") {
  TEST_CASE("the samples come again: counts, device times, sequence and its gaps, as far apart") {
    const Take take(12);
    const auto glove = open_replay(take.spec("?speed=2"), Side::right);
    REQUIRE(glove);
    CHECK((*glove)->info().side == Side::right);
    CHECK((*glove)->info().rate_hz == 200.0);
    CHECK((*glove)->info().source == take.spec("?speed=2"));
    const HostTime begin = HostClock::now();
    const auto samples = samples_of(**glove, take.right.size());
    REQUIRE(samples.size() == take.right.size());
    for (std::size_t at = 0; at < samples.size(); ++at) {
      CHECK(samples[at].raw == take.right[at].raw);
      CHECK(samples[at].device_time == take.right[at].device_time);
      CHECK(samples[at].sequence == take.right[at].sequence - 1000);
      CHECK(samples[at].side == Side::right);
      CHECK(samples[at].is_replayed);
      CHECK(samples[at].recorded_arrival == take.right[at].arrival);
      CHECK(samples[at].recorded_measured == take.right[at].measured);
      // Never early: half of 10 ms each. How late is the machine's affair.
      CHECK(samples[at].arrival - begin >= at * 5ms);
      CHECK(samples[at].measured <= samples[at].arrival);
      if (at > 0) CHECK(samples[at].measured - samples[at - 1].measured >= 0ms);
    }
    CHECK((*glove)->stats().records == samples.size());
    CHECK((*glove)->stats().missed == 1);
    const auto again = samples_of(**glove, take.right.size());
    REQUIRE(again.size() == take.right.size());
    CHECK(again.back().raw == take.right.back().raw);
    CHECK(again.front().sequence == samples.back().sequence + 1);
  }

  TEST_CASE("with loop=yes it begins again, and its sequence continues") {
    const Take take(3);
    const auto glove = open_replay(take.spec("?hand=left&loop=yes&speed=10"));
    REQUIRE(glove);
    const auto samples = samples_of(**glove, 8);
    REQUIRE(samples.size() >= 8);
    for (std::size_t at = 0; at < 8; ++at) {
      CHECK(samples[at].sequence == at);
      CHECK(samples[at].raw == take.right[at % 3].raw);
      CHECK(samples[at].side == Side::left);
    }
  }

  TEST_CASE("a recording whose time goes backwards does not hurry from pass to pass") {
    const Take take(2, -std::chrono::years(20));
    const auto glove = open_replay(take.spec("?hand=right&loop=yes"));
    REQUIRE(glove);
    const HostTime begin = HostClock::now();
    const auto samples = samples_of(**glove, 20);
    REQUIRE(samples.size() >= 20);
    for (std::size_t at = 0; at < 20; ++at) {
      CHECK(samples[at].raw == take.right[at % 2].raw);
      CHECK(samples[at].arrival - begin >= at / 2 * 10ms); // a period from pass to pass
      if (at % 2 == 0) CHECK(samples[at].measured - begin >= -2ms);
    }
  }

  TEST_CASE("a replay has ended when its last sample is in the ring, and not before") {
    const Take take(6);
    const auto glove = open_replay(take.spec("?hand=right"));
    REQUIRE(glove);
    CHECK_FALSE((*glove)->has_ended());
    SampleRing ring(64);
    for (int turn = 0; turn < 2; ++turn) { // when it is started again, it has not ended yet
      const HostTime begin = HostClock::now();
      test::require_ok((*glove)->start(ring));
      std::size_t there = 0; // in the ring when it was seen to have ended
      CHECK(test::eventually([&] {
        if (!(*glove)->has_ended()) return false;
        there = ring.size();
        return true;
      }));
      CHECK(there == 6);
      CHECK(HostClock::now() - begin >= 50ms);
      ring.drain([](const GloveSample&) noexcept {});
      (*glove)->stop();
      CHECK((*glove)->has_ended());
    }
  }

  TEST_CASE("with end=hold, with loop=yes or when it was stopped before, a replay has not ended") {
    const Take take(6);
    for (const std::string options : {"&end=hold", "&loop=yes", "&end=hold&loop=no"}) {
      CAPTURE(options);
      const auto glove = open_replay(take.spec("?hand=right&speed=10" + options));
      REQUIRE(glove);
      SampleRing ring(1024);
      test::require_ok((*glove)->start(ring));
      CHECK(test::eventually([&] { return ring.size() >= 6; }));
      std::this_thread::sleep_for(200ms);
      CHECK_FALSE((*glove)->has_ended());
      (*glove)->stop();
      CHECK_FALSE((*glove)->has_ended());
    }
    const auto slow = open_replay(take.spec("?hand=right&speed=0.01"));
    REQUIRE(slow);
    CHECK(samples_of(**slow, 1).size() < 6);
    CHECK_FALSE((*slow)->has_ended());
    const auto never = open_glove("sim:wave?rate=1000");
    REQUIRE(never);
    samples_of(**never, 3);
    CHECK_FALSE((*never)->has_ended());
  }

  TEST_CASE("what cannot be replayed is reported in a line with the right code") {
    const Take take(2);
    CHECK(code_of(take.spec("")) == Errc::usage); // which of the two?
    CHECK(code_of(take.spec("?speed=0")) == Errc::usage);
    CHECK(code_of(take.spec("?speed=nan")) == Errc::usage);
    CHECK(code_of(take.spec("?loop=maybe")) == Errc::usage);
    CHECK(code_of(take.spec("?end=maybe")) == Errc::usage);
    CHECK(code_of(take.spec("?loop=yes&end=hold")) == Errc::usage); // which of the two?
    CHECK(code_of(take.spec("?hand=middle")) == Errc::usage);
    CHECK(code_of(take.spec("?rate=3")) == Errc::usage);
    CHECK(code_of("replay:") == Errc::usage);
    CHECK(code_of("replay:/dev/zero") == Errc::bad_input);
    CHECK(code_of("replay:/nowhere") == Errc::bad_input);
    CHECK(code_of(Take(0).spec(""), Side::right) == Errc::bad_input);
  }
}

} // namespace replay_driver_test
