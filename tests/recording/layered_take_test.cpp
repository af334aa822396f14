// Recordings of takes in layers: replays, layers over layers, and files that lie about them.

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_tools.hpp>

#include "setup_parts.hpp"
#include "support/any_puppet.hpp"
#include "support/eventually.hpp"
#include "support/layered_loop.hpp"
#include "support/takes.hpp"

namespace layered_take_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::recording;
using flow::AngleSet;
using flow::Mode;
using test::LayeredLoop;
using test::LoopUnderTest;

namespace {

constexpr std::uint64_t ticks = 150;

/// A loop over inputs, with a recorder.
struct LayeredTake {
  LoopUnderTest& like;
  std::filesystem::path path;
  Setup setup;
  LayeredLoop played;
  std::unique_ptr<Recorder> recorder;
  std::vector<deform::Points> shapes; ///< shapes of the last recorded file

  LayeredTake(LoopUnderTest& test, std::filesystem::path file, std::vector<flow::HandInput> inputs,
              flow::InputScript* script = nullptr)
      : like(test), path(std::move(file)), setup(setup_with(test, inputs)),
        played(test, std::move(inputs), script) {
    setup.loop->options.rate_hz = LayeredLoop::rate_hz;
    record(played.log);
  }

  static Setup setup_with(LoopUnderTest& test, const std::vector<flow::HandInput>& inputs) {
    const auto before = std::exchange(test.inputs, inputs);
    Setup made = test::setup_of(test);
    test.inputs = before;
    return made;
  }
  void record(flow::InputLog& log) {
    RecorderOptions options;
    options.file = path;
    auto begun = Recorder::begin(setup, log, std::move(options));
    REQUIRE(begun);
    recorder = *std::move(begun);
    shapes.clear();
  }

  /// Hands of two seeds in the rings of `like`.
  void tick(std::uint64_t number, HostTime begin, unsigned seed) {
    const HostTime due = flow::TickGrid(begin, LayeredLoop::rate_hz).deadline(number);
    for (const Side side : {Side::left, Side::right}) {
      const auto slot = flow::Placement::index_of(side);
      GloveSample sample = test::bent_sample(
          side, test::performance(seed + static_cast<unsigned>(slot))(number), due - 1ms);
      sample.sequence = number;
      like.rings[slot]->try_push(sample);
    }
    const flow::Frame& frame = played.tick(number, begin);
    played.loop->changes().layout(frame.model).unpack(frame.shape, shapes.emplace_back());
  }
  void end() { REQUIRE(recorder->end(sum_of(played.loop->final_shape()))); }
};

/// Every frame of the replay is the recorded one, bit for bit.
void check_replay(const LayeredTake& take) {
  auto reader = TakeReader::open(take.path);
  REQUIRE(reader);
  auto replay = LoopReplay::make(reader->setup(), take.like.model);
  REQUIRE(replay);
  std::size_t at = 0;
  deform::Points shape;
  while (const auto entry = reader->next()) {
    if (!(*replay)->feed(*entry)) continue;
    flow::DeformLoop& loop = (*replay)->loop();
    loop.frames().update();
    loop.changes().layout(loop.frames().front().model).unpack(loop.frames().front().shape, shape);
    REQUIRE(at < take.shapes.size());
    CHECK((shape == take.shapes[at++]));
  }
  CHECK(at == take.shapes.size());
  CHECK((*replay)->is_exact());
  CHECK(reader->unknown_entries() == 0);
  REQUIRE(reader->ending());
  CHECK(reader->ending()->shape == sum_of((*replay)->loop().final_shape()));
}

std::vector<flow::HandInput> with_layers(const Setup& take, const flow::InputScript& script,
                                         const LoopUnderTest& like, const char* part) {
  std::vector<flow::HandInput> inputs = take.hands;
  for (auto& input : inputs)
    input.first = script.moved(input.first);
  for (const auto& hand : like.inputs)
    inputs.push_back(test::layer_of(hand, *flow::angles_named(part), false));
  return inputs;
}

} // namespace

TEST_SUITE("layered_take") {
  TEST_CASE("a layer over a layer over a take is replayed bit for bit, with all its commands") {
    for (const char* puppet : {static_cast<const char*>(nullptr), test::ball_puppet}) {
      for (const Mode mode : {Mode::type1, Mode::type2}) {
        test::TemporaryFolder folder;
        LoopUnderTest like(mode, {.rings_of_ball = 10, .puppet = puppet});
        const auto name = [&](unsigned number) {
          return folder.path() / ("take-" + std::to_string(number) + ".nendo");
        };
        LayeredTake first(like, name(0), like.inputs);
        for (std::uint64_t tick = 0; tick < ticks; ++tick) {
          if (tick == 40) first.played.commands.try_push(flow::Request::commit);
          if (tick == 60) first.played.commands.try_push(flow::Request::release);
          if (tick == 70) first.played.commands.try_push(flow::Request::grab);
          if (tick == 90) first.played.commands.try_push(flow::Request::undo);
          if (tick == 80)
            first.played.commands.try_push(
                flow::SetClutch{Side::right, puppet::RigPlayer::all_fingers, false});
          if (tick == 100) first.played.commands.try_push(flow::Mark{});
          first.tick(tick, HostTime(1000s), 1);
        }
        first.end();
        check_replay(first);
        std::vector<std::vector<deform::Points>> shapes{first.shapes};
        const std::array parts{"ring", "middle", "index"};
        for (unsigned over = 1; over <= parts.size(); ++over) {
          auto input = read_take_input(name(over - 1));
          REQUIRE(input);
          CHECK(input->is_exact);
          const HostTime begin(1000s + over * 77s);
          input->script->begin_at(begin);
          LayeredTake take(like, name(over),
                           with_layers(input->setup, *input->script, like, parts[over - 1]),
                           input->script.get());
          CHECK(take.setup.hands.size() == 2 + 2 * over);
          const auto top = static_cast<std::uint8_t>(2 * over);
          for (std::uint64_t tick = 0; tick < ticks; ++tick) {
            if (tick == 30 || tick == 90)
              take.played.commands.try_push(flow::SetLayer{top, tick == 30});
            if (tick == 50)
              take.played.commands.try_push(flow::SetLayer{std::uint8_t(top + 1), true});
            take.tick(tick, begin, 10 * over);
          }
          take.end();
          CHECK(input->script->has_ended());
          check_replay(take);
          // Until the layer comes in, it is the take below; then it is not.
          for (std::size_t tick = 0; tick < 30; ++tick)
            CHECK((take.shapes[tick] == shapes.back()[tick]));
          const bool differs = take.shapes[80] != shapes.back()[80];
          CHECK((differs || puppet != nullptr)); // which may have released
          shapes.push_back(take.shapes);
          const auto summary = summarise(name(over));
          REQUIRE(summary);
          CHECK(summary->is_whole());
          CHECK(summary->marks.size() == 1);
        }
      }
    }
  }

  TEST_CASE("a recording that begins while a layer comes in continues with it, bit for bit") {
    test::TemporaryFolder folder;
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 10});
    const HostTime begin(1000s);
    LayeredTake first(like, folder.path() / "first.nendo", {like.inputs[1], like.inputs[0]});
    for (std::uint64_t tick = 0; tick < ticks; ++tick)
      first.tick(tick, begin, 1);
    first.end();
    auto input = read_take_input(first.path);
    REQUIRE(input);
    input->script->begin_at(begin);
    // A hand at rest below its own layer.
    std::vector<flow::HandInput> inputs{
        test::scripted(like.inputs[1]), test::layer_of(like.inputs[1], AngleSet::all(), false),
        test::layer_of(like.inputs[0], *flow::angles_named("middle"), false)};
    LayeredTake take(like, folder.path() / "whole.nendo", inputs);
    for (std::uint64_t tick = 0; tick < 50; ++tick) {
      if (tick == 43)
        for (const auto at : {std::uint8_t{1}, std::uint8_t{2}})
          take.played.commands.try_push(flow::SetLayer{at, true});
      take.tick(tick, begin, 4);
    }
    flow::InputLog later;
    take.played.loop->changes().change_log(&later, take.played.loop->frames().front().shape);
    take.tick(50, begin, 4);
    const auto state = take.played.loop->changes().take_state();
    REQUIRE(state);
    REQUIRE(state->inputs[1].layer);
    CHECK(state->inputs[1].layer->weight > 0.0);
    CHECK(state->inputs[1].layer->weight < 1.0);
    take.end();
    check_replay(take);
    continue_from(*state, take.played.loop->changes().layout(), take.setup);
    take.path = folder.path() / "later.nendo";
    take.record(later);
    for (std::uint64_t tick = 51; tick < ticks; ++tick) {
      if (tick == 90) take.played.commands.try_push(flow::SetLayer{2, false});
      take.tick(tick, begin, 4);
    }
    take.end();
    check_replay(take);
    CHECK(summarise(take.path)->setup.hands[2].layer->below.has_value());
  }

  TEST_CASE("files that lie about their layers are refused, or found strange") {
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 10});
    const flow::HandInput layer = test::layer_of(like.inputs[0], AngleSet::all());
    const auto read = [](const std::vector<flow::HandInput>& hands, std::size_t flaw_at,
                         std::uint8_t flaw) {
      std::vector<flow::HandInput> known;
      for (std::size_t at = 0; at < hands.size(); ++at) {
        std::vector<std::byte> bytes;
        ByteWriter writer(bytes);
        put_hand(writer, static_cast<std::uint8_t>(at), hands[at]);
        if (flaw_at > 0) bytes[bytes.size() - flaw_at] = std::byte{flaw};
        ByteReader reader(bytes);
        if (!read_hand(reader, known)) return false;
      }
      return true;
    };
    // The last bytes: joints (4), in (1), how far (8), has a hand below (1), is of another form
    // (1).
    CHECK(read({layer}, 0, 0));
    CHECK(read({layer}, 15, 0));
    CHECK_FALSE(read({layer}, 12, 0xFF)); // joints that no hand has
    CHECK_FALSE(read({layer}, 3, 0xFF));  // NaN
    CHECK_FALSE(read({layer}, 3, 0x40));  // 2 or more
    CHECK_FALSE(read({layer}, 2, 1));     // the angles below are cut off
    CHECK_FALSE(read({layer}, 1, 1));     // and what form the hand has
    CHECK_FALSE(read({layer, like.inputs[0]}, 0, 0));
    CHECK_FALSE(read({like.inputs[0], like.inputs[0]}, 0, 0));
    std::vector<flow::HandInput> many{like.inputs[0]};
    many.resize(flow::max_inputs, layer);
    CHECK(read(many, 0, 0));
    many.push_back(layer);
    CHECK_FALSE(read(many, 0, 0));

    // A setup with an unreadable layer is reported as that, and not as another shape.
    Setup setup = LayeredTake::setup_with(like, {like.inputs[0], layer});
    CHECK(LoopReplay::make(setup, like.model));
    setup.hands.pop_back();
    const auto refused = LoopReplay::make(setup, like.model);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("a layer is missing") != std::string::npos);

    // Commands to layers that are none are found.
    std::uint32_t chunks = 0;
    auto bytes = setup_bytes(LayeredTake::setup_with(like, {like.inputs[0], layer}), chunks);
    std::vector<std::byte> tape;
    ByteWriter writer(tape);
    for (const unsigned at : {0U, 1U, 2U, 255U})
      put_entry(writer, flow::SetLayer{static_cast<std::uint8_t>(at), true});
    append_chunk(bytes, log_chunk, chunks, tape);
    auto reader = TakeReader::of(bytes, "test");
    REQUIRE(reader);
    unsigned layers = 0;
    while (const auto entry = reader->next())
      layers += std::holds_alternative<flow::SetLayer>(*entry) ? 1U : 0U;
    CHECK(layers == 1);
    CHECK(reader->unknown_entries() == 3);
  }

  TEST_CASE("what recorders repeat in each chunk is no change in what is played over") {
    test::RecordedLoop live(Mode::type1, {}, false, false, {}, test::ball_puppet);
    flow::DeformLoop& loop = *live.test.loop;
    live.record({.chunk_time = 5ms});
    flow::LoopSettings other = loop.changes().settings();
    other.kernel = deform::Wendland::c0;
    std::mt19937 random(3);
    std::uint64_t tick = 0;
    const auto run_until_chunk_with = [&](std::uint64_t entries) {
      return test::eventually([&] {
        live.test.frame_after_tick(tick++);
        std::uint64_t settings = 0, puppets = 0;
        auto reader = TakeReader::open(live.path);
        REQUIRE(reader);
        while (const auto entry = reader->next()) {
          settings += std::holds_alternative<flow::LoopSettings>(*entry) ? 1U : 0U;
          puppets += std::holds_alternative<PuppetChange>(*entry) ? 1U : 0U;
        }
        return settings >= entries && puppets >= entries;
      });
    };
    REQUIRE(loop.changes().change_settings(other));
    CHECK(test::eventually([&] {
      live.test.frame_after_tick(tick++);
      return !loop.changes().is_changing();
    }));
    REQUIRE(
        live.change_puppet(test::any_puppet(loop.changes().puppet(0), live.test.model, random)));
    CHECK(run_until_chunk_with(4));
    REQUIRE(live.end());

    auto input = read_take_input(live.path);
    REQUIRE(input);
    input->script->play(input->script->length() + 1s, [](const flow::InputLogEntry&) {});
    std::vector<flow::Command> given;
    input->script->for_others().drain([&](const flow::Command& one) { given.push_back(one); });
    REQUIRE(given.size() == 2);
    CHECK(std::get<flow::ChangeSettings>(given[0]).settings == other);
    CHECK(std::get<flow::ChangePuppet>(given[1]).number == 1);
  }

  TEST_CASE("a recording without ticks, or of gloves alone, is nothing to play over") {
    test::TemporaryFolder folder;
    LoopUnderTest like(Mode::type1, {.rings_of_ball = 10});
    LayeredTake none(like, folder.path() / "none.nendo", like.inputs);
    none.end();
    const auto refused = read_take_input(none.path);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("none.nendo") != std::string::npos);
    CHECK_FALSE(read_take_input(folder.path() / "missing.nendo"));
  }
}

} // namespace layered_take_test
