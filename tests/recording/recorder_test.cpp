#include <nendo/recording/recorder.hpp>

#include <atomic>

#include <doctest/doctest.h>

#include "support/eventually.hpp"
#include "support/small_disk.hpp"
#include "support/takes.hpp"

namespace recorder_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::recording;
using flow::Mode;
using test::RecordedLoop;

namespace {

struct Counts {
  std::uint64_t samples = 0, requests = 0, ticks = 0, gaps = 0, damages = 0;
  bool has_ending = false;
};

Counts counts_of(const std::filesystem::path& path) {
  auto reader = TakeReader::open(path);
  REQUIRE(reader);
  Counts counts;
  while (const auto entry = reader->next()) {
    counts.samples += std::holds_alternative<RecordedSample>(*entry);
    counts.requests += std::holds_alternative<flow::Request>(*entry);
    counts.ticks += std::holds_alternative<flow::LoggedTick>(*entry);
    counts.gaps += std::holds_alternative<Gap>(*entry);
  }
  counts.damages = reader->chunks().damage_count();
  counts.has_ending = reader->ending().has_value();
  CHECK(reader->unknown_entries() == 0);
  return counts;
}

std::vector<driver::RecordCounts> sent_in(const std::filesystem::path& path) {
  auto reader = TakeReader::open(path);
  REQUIRE(reader);
  while (reader->next()) {
  }
  CHECK(reader->unknown_entries() == 0);
  return reader->sent();
}

} // namespace

TEST_SUITE("recorder") {
  TEST_CASE("what a reader would refuse is refused before anything is recorded, with the reason") {
    const auto refused = [](const char* reason, const auto& change) {
      RecordedLoop live(Mode::type1);
      Setup setup = live.setup;
      change(setup);
      std::uint32_t chunks = 0;
      const auto bytes = setup_bytes(setup, chunks);
      const auto fine = check_readable(setup, bytes);
      REQUIRE_FALSE(fine);
      CAPTURE(fine.error().message);
      CHECK(fine.error().message.starts_with("this run cannot be recorded: "));
      CHECK(fine.error().message.find(reason) != std::string::npos);
      RecorderOptions options;
      options.file = live.path;
      CHECK_FALSE(Recorder::begin(setup, live.input_log, std::move(options)));
      CHECK_FALSE(std::filesystem::exists(live.path));
      std::uint32_t as_many = 0;
      CHECK(check_readable(live.setup, setup_bytes(live.setup, as_many)));
    };
    refused("more than 1000 km",
            [](Setup& setup) { setup.loop->placement.T_stage_wrist[1].translation().x() = 2e6; });
    refused("the model's size", [](Setup& setup) { setup.loop->placement.units_per_metre = 0.0; });
    refused("--radius", [](Setup& setup) {
      setup.loop->options.sculptor.deformer.supports.shared.assign(1, {1e101, 1.0});
    });
    refused("--radius", [](Setup& setup) { setup.loop->options.sculptor.piece_length = 1e-120; });
    refused("names are too long", [](Setup& setup) { setup.loop->mesh.assign(70000, 'm'); });
    refused("calibrate again", [](Setup& setup) { setup.hands[0].filter.min_cutoff_hz = 1e7; });
    refused("1 MiB", [](Setup& setup) { setup.loop->puppet.text.assign(2 << 20, '#'); });
  }

  TEST_CASE("all that the loop took is in the file, and the ending says how much that is") {
    RecordedLoop live(Mode::type1);
    live.record();
    test::play(live, 300);
    const auto recorded = live.end();
    REQUIRE(recorded);
    const auto& stats = live.test.loop->stats();
    CHECK(recorded->samples == stats.samples[0] + stats.samples[1]);
    CHECK(recorded->ticks == 300);
    CHECK(recorded->bytes == std::filesystem::file_size(live.path));
    const Counts counts = counts_of(live.path);
    CHECK(counts.samples == recorded->samples);
    CHECK(counts.requests == recorded->requests);
    CHECK(counts.requests > 0);
    CHECK(counts.ticks == 300);
    CHECK(counts.gaps + counts.damages == 0);
    CHECK(counts.has_ending);
    CHECK(live.warnings.empty());
    auto reader = TakeReader::open(live.path);
    while (reader->next()) {
    }
    CHECK(reader->ending()->shape == sum_of(live.test.loop->final_shape()));
    CHECK(live.end()); // once more changes nothing
    CHECK(std::filesystem::file_size(live.path) == recorded->bytes);
  }

  TEST_CASE("what the loop took is in the file soon, without waiting for the end") {
    RecordedLoop live(Mode::type1);
    live.record({.chunk_time = 20ms});
    test::play(live, 100);
    CHECK(test::eventually([&] { return counts_of(live.path).ticks == 100; }));
    CHECK_FALSE(counts_of(live.path).has_ending);
    REQUIRE(live.end());
  }

  TEST_CASE("what the gloves sent is in the file, newest last, before the end and at the end") {
    RecordedLoop live(Mode::type1);
    std::atomic<std::uint64_t> turn{0};
    live.record({.chunk_time = 20ms,
                 .sent =
                     [&] {
                       const std::uint64_t n = ++turn;
                       return std::vector<driver::RecordCounts>{{10 * n, n, 2, 3},
                                                                {20 * n, 0, 0, n}};
                     },
                 .sent_time = 30ms});
    test::play(live, 100);
    std::vector<driver::RecordCounts> seen;
    // As after a crash: no ending, but the latest counts.
    CHECK(test::eventually([&] {
      seen = sent_in(live.path);
      return seen.size() == 2 && seen[0].missed > 1;
    }));
    CHECK_FALSE(counts_of(live.path).has_ending);
    CHECK(seen[0].delivered == 10 * seen[0].missed);
    const auto recorded = live.end();
    REQUIRE(recorded);
    const std::uint64_t n = turn;
    const std::vector<driver::RecordCounts> last{{10 * n, n, 2, 3}, {20 * n, 0, 0, n}};
    CHECK(recorded->sent == last);
    CHECK(sent_in(live.path) == last);
    CHECK(counts_of(live.path).has_ending);
    CHECK(counts_of(live.path).ticks == 100);
  }

  TEST_CASE("recordings are never overwritten, and a missing folder is reported at once") {
    RecordedLoop live(Mode::type1);
    test::write_bytes(live.path, "precious");
    CHECK_THROWS_WITH(live.record(), doctest::Contains("is there already"));
    CHECK(test::file_bytes(live.path) == "precious");
    live.path = live.folder.path() / "nowhere" / "take.nendo";
    CHECK_THROWS_WITH(live.record(), doctest::Contains("cannot be made"));
  }

  TEST_CASE("a disk that fills up: one warning, what is written stays whole, the loop continues") {
    RecordedLoop live(Mode::type1);
    live.record({.chunk_time = 1ms});
    const test::SmallDisk small(64 * 1024);
    test::play(live, 100); // a third of the space
    CHECK(test::eventually([&] { return counts_of(live.path).ticks > 0; }));
    for (unsigned seed = 1; seed < 12; ++seed)
      test::play(live, 100, seed);
    const auto recorded = live.end();
    REQUIRE_FALSE(recorded);
    CHECK(recorded.error().code == Errc::failed);
    CHECK(recorded.error().message.find("free some space") != std::string::npos);
    CHECK(live.warnings.size() == 1);
    CHECK(live.test.loop->stats().ticks == 1200);
    CHECK(std::filesystem::file_size(live.path) <= 64 * 1024);
    const Counts counts = counts_of(live.path);
    CHECK(counts.damages == 0);
    CHECK(counts.ticks > 0);
    CHECK_FALSE(counts.has_ending);
  }

  TEST_CASE("a disk that is full from the beginning is reported, and the name stays free") {
    RecordedLoop live(Mode::type1);
    std::string said;
    {
      const test::SmallDisk small(100);
      try {
        live.record();
      } catch (const std::exception& error) {
        said = error.what();
      }
    }
    CHECK(said.find("free some space") != std::string::npos);
    CHECK(said.find("recording has ended") == std::string::npos); // none had begun
    CHECK_FALSE(std::filesystem::exists(live.path));
    live.record();
    CHECK(live.end());
  }

  TEST_CASE("a last minute without space is reported, and leaves no half of a file") {
    RecordedLoop live(Mode::type1);
    const auto stem = live.folder.path() / "clay";
    live.record({.keep_last = 60s, .kept_stem = stem, .chunk_time = 1ms});
    test::play(live, 100);
    Result<Recorded> recorded = Recorded{};
    {
      const test::SmallDisk small(1000);
      live.recorder->save_last_minute();
      recorded = live.end();
    }
    REQUIRE_FALSE(recorded);
    CHECK(recorded.error().message.find("cannot be kept") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(stem.string() + ".kept-1.nendo"));
  }

  TEST_CASE("a folder that vanishes is reported while the loop runs") {
    RecordedLoop live(Mode::type1);
    live.path = live.folder.path() / "stick" / "take.nendo";
    std::filesystem::create_directory(live.path.parent_path());
    live.record({.chunk_time = 1ms});
    std::filesystem::remove_all(live.path.parent_path());
    test::play(live, 50);
    const auto recorded = live.end();
    REQUIRE_FALSE(recorded);
    CHECK(recorded.error().message.find("was removed") != std::string::npos);
    CHECK(live.warnings.size() == 1);
  }
}

} // namespace recorder_test
