#include <nendo/recording/take_tools.hpp>

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/recording/loop_replay.hpp>

#include "support/eventually.hpp"
#include "support/small_disk.hpp"
#include "support/takes.hpp"

namespace take_tools_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::recording;
using flow::Mode;
using test::RecordedLoop;

namespace {

/// A short recording in many chunks.
struct Take {
  RecordedLoop live{Mode::type1};
  std::string bytes;
  std::filesystem::path other = live.folder.path() / "other.nendo";
  std::filesystem::path made = live.folder.path() / "made.nendo";

  explicit Take(std::uint64_t ticks = 40) {
    live.record({.chunk_time = 1ms});
    for (std::uint64_t part = 0; part < ticks / 10; ++part) {
      const HostTime begin = HostClock::now();
      const auto written = std::filesystem::file_size(live.path);
      for (std::uint64_t at = 0; at < 10; ++at) {
        for (const Side side : {Side::left, Side::right}) {
          GloveSample sample =
              test::bent_sample(side, static_cast<int>(part + at), begin + at * 1ms);
          sample.sequence = 10 * part + at;
          live.test.rings[flow::Placement::index_of(side)]->try_push(sample);
        }
        live.test.loop->tick(10 * part + at, HostClock::now());
      }
      // A chunk of its own, or several.
      REQUIRE(test::eventually([&] { return std::filesystem::file_size(live.path) > written; }));
    }
    REQUIRE(live.end());
    bytes = test::file_bytes(live.path);
  }
  /// Of the recording with one byte changed, or cut off there.
  void damage(std::size_t at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    test::write_bytes(other, damaged);
  }
  void cut_off(std::size_t at) { test::write_bytes(other, bytes.substr(0, at)); }
};

std::vector<Entry> entries_of(const std::filesystem::path& path) {
  auto reader = TakeReader::open(path);
  REQUIRE(reader);
  std::vector<Entry> entries;
  while (auto entry = reader->next())
    entries.push_back(*entry);
  return entries;
}

std::uint64_t ticks_in(const std::vector<Entry>& entries) {
  return static_cast<std::uint64_t>(
      std::count_if(entries.begin(), entries.end(), [](const Entry& entry) {
        return std::holds_alternative<flow::LoggedTick>(entry);
      }));
}

/// A recording whose checksums fit, but which describes most of its gloves after the first sample.
std::vector<std::byte> with_late_gloves(std::uint8_t gloves) {
  Setup setup = begin_setup("test 1.0");
  setup.gloves.resize(1);
  std::uint32_t chunks = 0;
  std::vector<std::byte> bytes = setup_bytes(setup, chunks);
  const auto append = [&](ChunkType type, auto&& fill) {
    std::vector<std::byte> payload;
    fill(ByteWriter(payload));
    append_chunk(bytes, type, chunks++, payload);
  };
  const auto put_sample_of = [](ByteWriter writer, std::uint8_t glove) {
    put_entry(writer, RecordedSample{glove, GloveSample{}});
  };
  append(log_chunk, [&](ByteWriter writer) { put_sample_of(writer, 0); });
  for (std::uint8_t glove = 1; glove < gloves; ++glove)
    append(glove_chunk,
           [&](ByteWriter writer) { put_glove(writer, {glove, driver::GloveInfo{}}); });
  append(log_chunk, [&](ByteWriter writer) {
    for (std::uint8_t glove = 0; glove < gloves; ++glove)
      put_sample_of(writer, glove);
  });
  return bytes;
}

} // namespace

TEST_SUITE("take_tools") {
  TEST_CASE("a summary counts what is there and what is missing, by the numbers of the samples") {
    RecordedLoop live(Mode::type1);
    live.record();
    const HostTime begin = HostClock::now();
    for (std::uint64_t at = 0; at < 100; ++at) {
      for (const Side side : {Side::left, Side::right}) {
        if (side == Side::right && at % 10 == 3) continue; // lost on the way
        GloveSample sample = test::bent_sample(side, 5, begin + at * 10ms);
        sample.sequence = at;
        live.test.rings[flow::Placement::index_of(side)]->try_push(sample);
      }
      live.test.loop->tick(2 * at, begin + at * 10ms, begin + at * 10ms); // each other is missed
    }
    live.test.commands.try_push(flow::Request::undo);
    live.test.loop->tick(200, begin + 1s, begin + 1s);
    REQUIRE(live.end());
    const auto summary = summarise(live.path);
    REQUIRE(summary);
    CHECK(summary->is_whole());
    CHECK(summary->ending.has_value());
    CHECK(summary->gloves[0].samples == 100);
    CHECK(summary->gloves[0].lost == 0);
    CHECK(summary->gloves[0].rate_hz() == doctest::Approx(100.0));
    CHECK(summary->gloves[0].longest_pause == 10ms);
    CHECK(summary->gloves[1].samples == 90);
    CHECK(summary->gloves[1].lost == 10);
    CHECK(summary->gloves[1].longest_pause == 20ms);
    CHECK(summary->ticks == 101);
    CHECK(summary->missed == 100);
    CHECK(summary->requests == std::array<std::uint64_t, flow::requests.size()>{0, 0, 0, 1});
    CHECK(summary->gaps == 0);
    CHECK(summary->marks.empty());
  }

  TEST_CASE("marks are found again when they were made, and a replay does the same with them") {
    RecordedLoop live(Mode::type2);
    live.record();
    const HostTime begin = HostClock::now();
    for (int at = 0; at < 50; ++at) {
      for (const Side side : {Side::left, Side::right}) {
        GloveSample sample = test::bent_sample(side, at, begin + at * 10ms);
        sample.sequence = static_cast<std::uint64_t>(at);
        live.test.rings[flow::Placement::index_of(side)]->try_push(sample);
      }
      if (at == 20 || at == 45) live.test.commands.try_push(flow::Mark{});
      live.test.loop->tick(static_cast<std::uint64_t>(at), begin + at * 10ms, begin + at * 10ms);
    }
    REQUIRE(live.end());
    const auto summary = summarise(live.path);
    REQUIRE(summary);
    CHECK(summary->is_whole());
    REQUIRE(summary->marks.size() == 2);
    CHECK(summary->setup.begun_host + summary->marks[0] == begin + 200ms);
    CHECK(summary->setup.begun_host + summary->marks[1] == begin + 450ms);
    auto reader = TakeReader::open(live.path);
    auto replay = LoopReplay::make(reader->setup(), live.test.model);
    REQUIRE(replay);
    while (const auto entry = reader->next())
      (*replay)->feed(*entry);
    CHECK((*replay)->is_exact());
    CHECK(sum_of((*replay)->loop().final_shape()) == reader->ending()->shape);
  }

  TEST_CASE(
      "whatever byte is damaged, or wherever it ends, it is seen, and repair saves the rest") {
    Take take;
    const std::uint64_t whole = entries_of(take.live.path).size();
    CHECK(summarise(take.live.path)->is_whole());
    for (std::size_t at = 0; at < take.bytes.size(); at += 1 + take.bytes.size() / 101) {
      for (const bool cuts : {false, true}) {
        CAPTURE(at);
        CAPTURE(cuts);
        if (cuts) {
          take.cut_off(at);
        } else {
          take.damage(at);
        }
        const auto summary = summarise(take.other);
        CHECK((!summary || !summary->is_whole() || !summary->ending));
        std::filesystem::remove(take.made);
        const auto repaired = repair_take(take.other, take.made);
        if (!repaired) { // nothing but the header was left
          CHECK(repaired.error().code == Errc::bad_input);
          CHECK(cuts);
          continue;
        }
        const auto of_made = summarise(take.made);
        REQUIRE(of_made);
        CHECK(of_made->damage_count == 0);
        if (summary) CHECK(repaired->damages == summary->damage_count);
        CHECK(repaired->chunks > 0);
        CHECK(repaired->shapes == 0);
        const auto saved = entries_of(take.made);
        CHECK(saved.size() <= whole + 1);
        // One chunk's worth at most: of the setup, which may leave the gloves unknown, or an input
        // log's.
        if (!cuts && summary && summary->gloves.size() == 2) CHECK(ticks_in(saved) >= 10);
      }
    }
  }

  TEST_CASE(
      "a part from the beginning replays exactly, one from the middle says that it does not") {
    Take take(60);
    const auto all = entries_of(take.live.path);
    const auto tick_time = [&](std::uint64_t number) {
      for (const Entry& entry : all) {
        const auto* tick = std::get_if<flow::LoggedTick>(&entry);
        if (tick != nullptr && tick->number == number) return tick->woke;
      }
      return HostTime{};
    };
    const HostTime begun = take.live.setup.begun_host;
    REQUIRE(cut_take(take.live.path, take.made, 0s, tick_time(35) - begun));
    const auto beginning = entries_of(take.made);
    REQUIRE(beginning.size() < all.size());
    CHECK(ticks_in(beginning) == 35);
    const auto replay = LoopReplay::make(take.live.setup, take.live.test.model);
    const auto same = LoopReplay::make(take.live.setup, take.live.test.model);
    REQUIRE((replay && same));
    for (std::size_t at = 0; at < beginning.size(); ++at) {
      (*replay)->feed(beginning[at]);
      (*same)->feed(all[at]);
    }
    CHECK((*replay)->is_exact());
    CHECK((*replay)->loop().final_shape() == (*same)->loop().final_shape());

    REQUIRE(cut_take(take.live.path, take.other, tick_time(20) - begun, 1h));
    const auto middle = entries_of(take.other);
    REQUIRE(std::holds_alternative<Gap>(middle.front()));
    CHECK(std::get<Gap>(middle.front()).entries + middle.size() - 1 == all.size());
    CHECK(ticks_in(middle) == 40);
    CHECK(summarise(take.other)->is_whole());
    const auto refused = cut_take(take.live.path, take.live.folder.path() / "none", 1h, 2h);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::bad_input);
  }

  TEST_CASE("a recording says what was missed on the line, and one that does not know says so") {
    const std::vector<driver::RecordCounts> sent{{359, 98, 1, 12}, {400, 0, 0, 0}};
    RecordedLoop live(Mode::type1);
    live.record({.sent = [&] { return sent; }});
    test::play(live, 50);
    REQUIRE(live.end());
    const auto sent_counts = [](const std::filesystem::path& path) {
      const auto summary = summarise(path);
      REQUIRE(summary);
      CHECK(summary->is_whole());
      return std::vector{summary->gloves[0].sent, summary->gloves[1].sent};
    };
    const std::vector<std::optional<driver::RecordCounts>> known{sent[0], sent[1]};
    CHECK(sent_counts(live.path) == known);
    const auto made = live.folder.path() / "made.nendo";
    REQUIRE(repair_take(live.path, made));
    CHECK(sent_counts(made) == known);
    const auto with_shapes = live.folder.path() / "shapes.nendo";
    REQUIRE(add_shapes(live.path, with_shapes, live.test.model, 10.0));
    CHECK(sent_counts(with_shapes) == known);
    // It is unknown how much of it was missed in a part of the time.
    const auto part = live.folder.path() / "part.nendo";
    REQUIRE(cut_take(live.path, part, 0s, 1h));
    CHECK(sent_counts(part) == std::vector<std::optional<driver::RecordCounts>>(2));
    Take old;
    CHECK(sent_counts(old.live.path) == std::vector<std::optional<driver::RecordCounts>>(2));
  }

  TEST_CASE("counts of other gloves than the recording has, or half of them, are none") {
    Setup setup = begin_setup("test 1.0");
    setup.gloves.resize(2);
    const std::vector<driver::RecordCounts> sent(3, driver::RecordCounts{5, 4, 3, 2});
    for (const std::size_t gloves : {std::size_t{1}, std::size_t{2}, std::size_t{3}}) {
      for (const bool cuts : {false, true}) {
        CAPTURE(gloves);
        std::uint32_t chunks = 0;
        std::vector<std::byte> bytes = setup_bytes(setup, chunks);
        std::vector<std::byte> payload;
        ByteWriter writer(payload);
        put_sent(writer, std::span(sent).first(gloves));
        if (cuts) payload.pop_back();
        append_chunk(bytes, sent_chunk, chunks++, payload);
        const auto summary = summarise(bytes, "counts");
        REQUIRE(summary);
        const bool fine = gloves == 2 && !cuts;
        CHECK(summary->unknown_entries == (fine ? 0 : 1));
        CHECK(summary->gloves[0].sent.has_value() == fine);
      }
    }
  }

  TEST_CASE(
      "gloves that are described after the first sample are ignored, and so are their samples") {
    const std::uint8_t gloves = 200;
    const auto bytes = with_late_gloves(gloves);
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "late.nendo";
    test::write_bytes(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    for (const auto& summary : {summarise(bytes, "late"), summarise(path)}) {
      REQUIRE(summary);
      REQUIRE(summary->gloves.size() == 1);
      CHECK(summary->gloves[0].samples == 2);
      CHECK(summary->unknown_entries == 2 * (gloves - 1)); // the gloves, and a sample each
      CHECK_FALSE(summary->is_whole());
    }
  }

  TEST_CASE("a copy for which there is no space leaves no half of a file, and can be tried again") {
    Take take(20);
    const std::string whole = take.bytes;
    const auto model = take.live.test.model;
    const std::vector<std::function<Result<NewTake>()>> makers{
        [&] { return repair_take(take.live.path, take.made); },
        [&] { return cut_take(take.live.path, take.made, 0s, 1h); },
        [&] { return add_shapes(take.live.path, take.made, model, 100.0); }};
    for (const auto& make : makers) {
      const auto full = make();
      REQUIRE(full);
      CHECK(std::filesystem::file_size(take.made) == full->bytes);
      for (const std::uint64_t space : {std::uint64_t{0}, std::uint64_t{10}, std::uint64_t{100},
                                        full->bytes / 2, full->bytes - 1}) {
        CAPTURE(space);
        std::filesystem::remove(take.made);
        Result<NewTake> made = NewTake{};
        {
          const test::SmallDisk small(space);
          made = make();
        }
        REQUIRE_FALSE(made);
        CHECK(made.error().code == Errc::failed);
        CHECK(made.error().message.find("free some space") != std::string::npos);
        CHECK(made.error().message.find("recording has ended") == std::string::npos);
        CHECK_FALSE(std::filesystem::exists(take.made));
      }
      const auto again = make();
      REQUIRE(again);
      CHECK(again->bytes == full->bytes);
      std::filesystem::remove(take.made);
    }
    CHECK(test::file_bytes(take.live.path) == whole);
  }

  TEST_CASE("files are never overwritten") {
    Take take(10);
    test::write_bytes(take.made, "precious");
    CHECK(repair_take(take.live.path, take.made).error().code == Errc::failed);
    CHECK(cut_take(take.live.path, take.made, 0s, 1h).error().code == Errc::failed);
    CHECK(test::file_bytes(take.made) == "precious");
  }

  TEST_CASE(
      "shapes that are added are those of the live loop, and the recording replays as before") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      RecordedLoop live(mode);
      live.record();
      std::vector<deform::Points> shapes;
      const HostTime begin = HostClock::now();
      for (std::uint64_t tick = 0; tick < 50; ++tick) {
        live.test.bend(static_cast<int>(tick % 25), begin + tick * 11ms);
        shapes.push_back(live.test.vertices_of(live.test.frame_after_tick(tick)));
      }
      REQUIRE(live.end());
      const auto with = live.folder.path() / "with.nendo";
      const auto made = add_shapes(live.path, with, live.test.model, 100.0); // of 1 kHz
      REQUIRE(made);
      CHECK(made->shapes == 5);
      auto reader = TakeReader::open(with);
      REQUIRE(reader);
      auto replay = LoopReplay::make(reader->setup(), live.test.model);
      REQUIRE(replay);
      std::vector<RecordedShape> read;
      const auto take = [&] {
        if (auto shape = reader->take_shape()) read.push_back(*std::move(shape));
      };
      while (const auto entry = reader->next()) {
        take();
        (*replay)->feed(*entry);
      }
      take();
      REQUIRE(read.size() == 5);
      for (const auto& shape : read) {
        CHECK(shape.tick % 10 == 0);
        const auto distance = distance_between(shape, shapes[shape.tick]);
        REQUIRE(distance);
        CHECK(*distance < 1e-6); // half a float's last place of a ball of radius 1
      }
      CHECK((*replay)->loop().final_shape() == live.test.loop->final_shape());
      CHECK(reader->ending()->shape == sum_of(live.test.loop->final_shape()));
      const auto summary = summarise(with);
      REQUIRE(summary);
      CHECK(summary->unknown_entries + summary->damage_count == 0);
      CHECK(summary->counts_agree);
      CHECK(summary->shapes == 5);
      CHECK_FALSE(add_shapes(live.path, with, live.test.model, 100.0)); // is there
    }
  }

  TEST_CASE("a shape's payload is read back, and a hostile one is refused") {
    const RecordedShape shape{7, {1.0F, -2.0F, 3.5F, 0.0F, 1e-30F, 4.0F}};
    std::vector<std::byte> payload;
    ByteWriter writer(payload);
    put_shape(writer, shape);
    const auto read = read_shape(payload);
    REQUIRE(read);
    CHECK(read->tick == 7);
    CHECK(read->xyz == shape.xyz);
    for (std::size_t size = 0; size < payload.size(); ++size)
      CHECK_FALSE(read_shape(std::span(payload).first(size)));
    auto many = payload;
    many[11] = std::byte{0xFF}; // vertices
    CHECK_FALSE(read_shape(many));
    auto nan = payload;
    nan[14] = std::byte{0xC0};
    nan[15] = std::byte{0x7F};
    CHECK_FALSE(read_shape(nan));
  }
}

} // namespace take_tools_test
