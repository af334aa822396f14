#include <nendo/recording/take_reader.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/recording/take_tools.hpp>

#include "support/takes.hpp"

namespace take_reader_test {

using namespace nendo;
using namespace nendo::recording;
using flow::Mode;
using nlohmann::json;
using test::RecordedLoop;

namespace {

/// What the reader of the test's own, which was written from FORMAT.md, makes of a recording.
std::vector<json> read_by_python(const std::filesystem::path& path) {
  const std::string command = "python3 " NENDO_READER " '" + path.string() + "'";
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string text;
  std::array<char, 4096> buffer{};
  for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    text.append(buffer.data(), got);
  CHECK(::pclose(pipe) == 0);
  std::vector<json> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(json::parse(text.substr(at, end - at)));
    at = end + 1;
  }
  return lines;
}

std::int64_t ns(HostTime time) {
  return std::chrono::nanoseconds(time.time_since_epoch()).count();
}

bool is_sample(const json& line, unsigned glove, const GloveSample& sample) {
  const unsigned flags = (sample.has_device_time ? 1U : 0U) | (sample.sampled_too_fast ? 2U : 0U) |
                         static_cast<unsigned>(sample.wrist_switch) * 4U |
                         (sample.side == Side::right ? 16U : 0U);
  bool same = line["glove"] == glove && line["arrival"] == ns(sample.arrival) &&
              line["measured"] == ns(sample.measured) &&
              line["device_time"] == sample.device_time.count() &&
              line["sequence"] == sample.sequence && line["present"] == sample.present.bits &&
              line["flags"] == flags;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    same = same && line["raw"][slot] == sample.raw[slot].value;
  return same;
}

void check_calibration(const json& line, const hand::Calibration& calibration) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    CHECK(line["lines"][2 * slot] == calibration.sensors[slot].gain_rad_per_count);
    CHECK(line["lines"][2 * slot + 1] == calibration.sensors[slot].offset_counts);
  }
  for (std::size_t at = 0; at < calibration.coupling_gains.size(); ++at)
    CHECK(line["couplings"][at] == calibration.coupling_gains[at]);
  CHECK(line["middle_bias"] == calibration.middle_bias);
}

/// A setup of which nothing is what it is by default.
Setup unusual_setup() {
  test::LoopUnderTest test(Mode::type2, {.rings_of_ball = 8,
                                         .rate_hz = 333.0,
                                         .switch_action = flow::SwitchAction::toggle,
                                         .gated = false,
                                         .filter = hand::FilterKind::one_euro,
                                         .close_pinches = true,
                                         .adapt = CountScale{4095, true}});
  auto& input = test.inputs[0];
  auto& [left, right, adapt, learned_before, ends, watched, stuck] = input.wearer;
  watched = CountScale{4095, false};
  stuck.add(Sensor::ring_pip);
  left.left_out.add(Sensor::index_pip);
  right.left_out.add(Sensor::wrist_yaw);
  left.calibration[Sensor::ring_mcp] = {0.1, -17.25};
  left.calibration.coupling_gains[3] = 0.125;
  left.calibration.middle_bias = 0.7;
  left.size = {0.2, 0.09};
  right.calibration[Sensor::thumb_ip] = {-1.0 / 3.0, 1e-9};
  right.size = {0.17, 0.07};
  auto& learned = learned_before.emplace();
  learned.side = Side::left;
  learned.sensors[21] = {12.5, 3000.0, 17, 4'000'000'000, {0.001, -3.5}};
  ends = test::narrow_ends(Side::right);
  ends->counts.present.bits = 0x41;
  ends->counts.high_counts[21] = 3000.5;
  input.first.device_time = std::chrono::nanoseconds(123456789);
  input.first.has_device_time = true;
  test.options.policy = flow::OverrunPolicy::catch_up;
  test.options.max_catch_up = 7;
  test.options.silent_after = std::chrono::milliseconds(321);
  auto& deformer = test.options.sculptor.deformer;
  deformer.supports = {{{0.5, 1.0}, {2.0, 0.25}}, {{3, {0.75, 2.0}}}};
  deformer.csrbf = {deform::Wendland::c6, deform::Polynomial::linear, 0.07};
  deformer.evaluation.weight_bytes = 12345;
  deformer.injective = deform::InjectiveOptions{0.8, 33, 0.04};
  Setup setup = test::setup_of(test);
  setup.gloves[1].facts = {{"serial", "42"}, {"firmware", "2.1"}};
  setup.gloves[1].counts = {1023, true};
  setup.gloves[1].abilities.light = true;
  setup.loop->options.held = false;
  setup.loop->options.settings = flow::LoopSettings{
      .mode = flow::Mode::type2, .radius_m = {0.1, 0.2, 0.3, 0.4, 0.5}, .piece_fraction = 0.07};
  setup.loop->options.sculptor.brushes = {deform::Brush::push, deform::Brush::twist,
                                          deform::Brush::none, deform::Brush::pull,
                                          deform::Brush::scale};
  setup.loop->options.sculptor.brush_strength = -0.25;
  setup.loop->options.sculptor.hold = flow::Hold::hand;
  setup.loop->options.sculptor.deformer.csrbf.keep_volume = 0.75;
  setup.loop->options.settings->keep_volume = 0.125;
  setup.loop->placement.table = flow::Table{{1.5, -2.5, 0.25}, 8.0};
  setup.loop->rest.resize(2);
  setup.loop->rest[1].y[2] = -0.5F;
  setup.loop->rest[1].z[63] = 0.25F;
  return setup;
}

Setup read_back(const std::vector<std::byte>& bytes) {
  auto reader = TakeReader::of(bytes, "test");
  REQUIRE(reader);
  CHECK_FALSE(reader->next().has_value());
  CHECK(reader->unknown_entries() == 0);
  return reader->setup();
}

bool is_hold(const json& line, double keep_volume, flow::Hold hold) {
  return line["keep_volume"] == keep_volume && line["hold"] == static_cast<int>(hold);
}

bool is_settings(const json& line, const flow::LoopSettings& settings) {
  const auto& filter = settings.filter;
  return line["mode"] == static_cast<int>(settings.mode) &&
         line["kernel"] == static_cast<int>(settings.kernel) &&
         line["injective"] == static_cast<int>(settings.injective) &&
         line["filter"] == static_cast<int>(filter.kind) + (filter.close_pinches ? 128 : 0) &&
         line["radii"] == settings.radius_m && line["piece"] == settings.piece_fraction &&
         is_hold(line, settings.keep_volume, settings.hold) &&
         line["cutoffs"] == std::array{filter.min_cutoff_hz, filter.beta_hz_per_rad_s,
                                       filter.derivative_cutoff_hz};
}

template <class OfBrushes>
bool are_brushes(const json& line, const OfBrushes& options) {
  std::array<int, 5> numbers{};
  std::transform(options.brushes.begin(), options.brushes.end(), numbers.begin(),
                 [](deform::Brush brush) { return static_cast<int>(brush); });
  return line["brushes"] == numbers && line["strength"] == options.brush_strength;
}

} // namespace

TEST_SUITE("take_reader") {
  TEST_CASE("a reader that was written from FORMAT.md alone finds what was recorded") {
    RecordedLoop live(Mode::type1);
    live.setup = unusual_setup();
    live.record();
    test::play(live, 80, 1, true, [](const flow::Frame&) {});
    const auto recorded = live.end();
    REQUIRE(recorded);
    const auto lines = read_by_python(live.path);
    std::size_t at = 0;
    const Setup& setup = live.setup;
    CHECK(lines[at]["chunk"] == "HEAD");
    CHECK(lines[at]["wall"] == setup.begun.time_since_epoch().count());
    CHECK(lines[at]["host"] == ns(setup.begun_host));
    CHECK(lines[at]["program"] == "test 1.0");
    CHECK(lines[at++]["wearer"] == "anna");
    for (unsigned glove = 0; glove < 2; ++glove) {
      CHECK(lines[at]["number"] == glove);
      CHECK(lines[at]["source"] == "sim");
      CHECK(lines[at++]["sensors"] == sensors_22.bits);
    }
    CHECK(lines[2]["facts"] == json::parse(R"([["serial", "42"], ["firmware", "2.1"]])"));
    CHECK(lines[2]["abilities"] == 2);
    for (unsigned hand = 0; hand < 2; ++hand, ++at) {
      CHECK(lines[at]["side"] == hand);
      const auto& wearer = setup.hands[hand].wearer;
      const auto& own = hand == 0 ? wearer.left : wearer.right;
      const auto& other = hand == 0 ? wearer.right : wearer.left;
      CHECK(lines[at]["size"][0] == own.size.length_m);
      CHECK(lines[at]["swapped_size"][0] == other.size.length_m);
      CHECK(lines[at]["swapped_size"][1] == other.size.breadth_m);
      CHECK(lines[at]["gated"] == 0);
      CHECK(lines[at]["adapt"] == json::parse("[1, 4095, 1]"));
      CHECK(is_sample(lines[at]["first"], hand, setup.hands[hand].first));
      check_calibration(lines[at]["own"], own.calibration);
      check_calibration(lines[at]["swapped"], other.calibration);
    }
    CHECK(lines[3]["learned"]["side"] == 0);
    CHECK(lines[3]["learned"]["sensors"][21] ==
          json::parse("[12.5, 3000.0, 17, 4000000000, 0.001, -3.5]"));
    CHECK_FALSE(lines[4].contains("learned"));
    CHECK(lines[3]["ends"]["side"] == 1);
    CHECK(lines[3]["ends"]["sensors"] == 0x41);
    CHECK(lines[3]["ends"]["counts"][21] == json::parse("[50.0, 3000.5]"));
    CHECK_FALSE(lines[4].contains("ends"));
    CHECK(lines[3]["stuck"] == json{{"watched", 1},
                                    {"most", 4095},
                                    {"whole_range", 0},
                                    {"found", 1U << 13U},
                                    {"left", 1U << 5U},
                                    {"right", 1U << 22U}});
    CHECK_FALSE(lines[4].contains("stuck"));
    const auto& options = setup.loop->options;
    CHECK(lines[at]["mesh"] == "ball.obj");
    CHECK(lines[at]["vertices"] == setup.loop->mesh_sum.vertices);
    CHECK(lines[at]["crc"] == setup.loop->mesh_sum.crc);
    CHECK(lines[at]["poses"][1][3] == setup.loop->placement.T_stage_wrist[1](0, 3));
    CHECK(lines[at]["poses"][1][4] == setup.loop->placement.T_stage_wrist[1](1, 0));
    CHECK(lines[at]["rate_hz"] == 333.0);
    CHECK(lines[at]["policy"] == 1);
    CHECK(lines[at]["switch"] == 3);
    CHECK(lines[at]["mode"] == 1);
    CHECK(lines[at]["piece"] == options.sculptor.piece_length);
    CHECK(lines[at]["shared"] == json::parse("[[0.5, 1.0], [2.0, 0.25]]"));
    CHECK(lines[at]["own"] == json::parse("[[3, 0.75, 2.0]]"));
    CHECK(lines[at]["kernel"] == 3);
    CHECK(lines[at]["merge"] == 0.07);
    CHECK(lines[at]["most_links"] == 33);
    CHECK(lines[at]["held"] == 0);
    CHECK(lines[at]["pull_is_step"] == 1);
    CHECK(is_settings(lines[at]["settings"], *options.settings));
    CHECK(are_brushes(lines[at], options.sculptor));
    CHECK(is_hold(lines[at], 0.75, flow::Hold::hand));
    CHECK(lines[at]["table"] == json::parse("[1.5, -2.5, 0.25, 8.0]"));
    CHECK(lines[at]["type2_along_surface"] == 1);
    CHECK(lines[at]["clay_scales_few_vertices"] == 1);
    CHECK(lines[at++]["least_gap"] == 0.04);
    REQUIRE(lines[at]["chunk"] == "REST");
    REQUIRE(lines[at]["blocks"].size() == 2);
    CHECK(lines[at]["blocks"][0]["x"][0] == 0.0F);
    CHECK(lines[at]["blocks"][1]["y"][2] == -0.5F);
    CHECK(lines[at++]["blocks"][1]["z"][63] == 0.25F);
    auto reader = TakeReader::open(live.path);
    REQUIRE(reader);
    int changes = 0;
    for (; const auto entry = reader->next(); ++at) {
      while (lines[at]["chunk"] ==
             "PUPV") // masks that were asked for, before the tape that names them
        ++at;
      REQUIRE(lines[at]["chunk"] == "TAPE");
      if (const auto* sample = std::get_if<RecordedSample>(&*entry))
        CHECK(is_sample(lines[at], sample->glove, sample->sample));
      if (const auto* request = std::get_if<flow::Request>(&*entry))
        CHECK(lines[at]["request"] == static_cast<int>(*request));
      if (const auto* settings = std::get_if<flow::LoopSettings>(&*entry)) {
        ++changes;
        CHECK(is_settings(lines[at], *settings));
        CHECK(are_brushes(lines[at], *settings));
      }
      if (const auto* tick = std::get_if<flow::LoggedTick>(&*entry)) {
        CHECK(lines[at]["tick"] == tick->number);
        CHECK(lines[at]["scheduled"] == ns(tick->scheduled));
        CHECK(lines[at]["woke"] == ns(tick->woke));
      }
    }
    CHECK(changes > 2);
    REQUIRE(at + 1 == lines.size());
    CHECK(lines[at]["chunk"] == "END ");
    CHECK(lines[at]["ticks"] == 80);
    CHECK(lines[at]["samples"] == recorded->samples);
    CHECK(lines[at]["has_shape"] == 1);
    CHECK(lines[at]["crc"] == sum_of(live.test.loop->final_shape()).crc);
  }

  TEST_CASE("that reader finds trackers, how they move wrists, and their poses") {
    RecordedLoop live(Mode::type1, hand::FilterKind::off, false, false, flow::SwitchAction::none,
                      nullptr, false, true);
    auto& tracking = live.setup.hands[1].wrist_source->tracking;
    tracking.mount.T_station_wrist.translation() = Eigen::Vector3d(0.01, -0.02, 0.03);
    tracking.mount.late_s = 0.015;
    tracking.filter.kind = hand::FilterKind::one_euro;
    live.record();
    PoseSample pose;
    pose.arrival = pose.measured = HostClock::now();
    pose.sequence = 5;
    pose.station = 2;
    pose.position_m = {0.25, 0.5, -0.125};
    pose.error = 'k';
    live.test.poses[1]->try_push(pose);
    live.test.commands.try_push(flow::Recentre{});
    live.test.loop->tick(0, pose.arrival, pose.arrival);
    REQUIRE(live.end());
    std::vector<json> trackers, poses, recentres;
    bool is_tracked = false;
    for (const json& line : read_by_python(live.path)) {
      if (line["chunk"] == "TRAK") trackers.push_back(line);
      if (line["chunk"] == "LOOP") is_tracked = line["tracked"] == 1;
      if (line.contains("position")) poses.push_back(line);
      if (line.contains("recentre")) recentres.push_back(line);
    }
    CHECK(is_tracked);
    REQUIRE(trackers.size() == 2);
    CHECK(trackers[1]["side"] == 1);
    CHECK(trackers[1]["station"] == 2);
    CHECK(trackers[1]["source"] == "sim:orbit");
    CHECK(trackers[1]["facts"] == json::parse(R"([["firmware", "1.0"]])"));
    CHECK(trackers[1]["mount_pose"][3] == 0.01);
    CHECK(trackers[1]["mount_pose"][7] == -0.02);
    CHECK(trackers[1]["late_s"] == 0.015);
    CHECK(trackers[1]["filter"][0] == 1);
    CHECK(trackers[1]["filter"][1] == tracking.filter.min_cutoff_hz);
    CHECK(trackers[1]["lost_ns"] == 100'000'000);
    REQUIRE(poses.size() == 1);
    CHECK(poses[0]["side"] == 1);
    CHECK(poses[0]["arrival"] == ns(pose.arrival));
    CHECK(poses[0]["sequence"] == 5);
    CHECK(poses[0]["position"] == json::parse("[0.25, 0.5, -0.125]"));
    CHECK(poses[0]["turn"] == json::parse("[0.0, 0.0, 0.0, 1.0]"));
    CHECK(poses[0]["error"] == 'k');
    CHECK(recentres.size() == 1);
  }

  TEST_CASE("a setup that is read and written again is the same to the byte") {
    std::uint32_t chunks = 0;
    const auto bytes = setup_bytes(unusual_setup(), chunks);
    const Setup read = read_back(bytes);
    std::uint32_t again = 0;
    CHECK(setup_bytes(read, again) == bytes);
    CHECK(again == chunks);
    CHECK(chunks == 7);
  }

  TEST_CASE("how a model was cut is read back, and whether it rests as before") {
    for (const bool keeps_rest : {false, true}) {
      auto source = test::setup_of(test::LoopUnderTest(Mode::type1));
      flow::ModelOrigin origin;
      origin.source = flow::ModelSource::cut;
      origin.wire = {{{-1.0, 0.5, 0.25}, {1.0, 0.5, 0.25}}, {{-1.0, 0.5, 2.0}, {1.0, 0.5, 2.0}}};
      origin.shape = deform::Points::Random(3, 750'000); // more than go into one chunk
      origin.keeps_rest = keeps_rest;
      source.loop->origins = {std::make_shared<const flow::ModelOrigin>(origin)};
      std::uint32_t chunks = 0;
      const Setup read = read_back(setup_bytes(source, chunks));
      REQUIRE(read.loop->origins.size() == 1);
      const flow::ModelOrigin& back = *read.loop->origins[0];
      CHECK(back.source == origin.source);
      CHECK(back.keeps_rest == keeps_rest);
      CHECK(back.shape == origin.shape);
      REQUIRE(back.wire.size() == 2);
      CHECK(back.wire[1].to == origin.wire[1].to);
    }
  }

  TEST_CASE("the setup is complete with the first input log, whatever comes behind it") {
    std::uint32_t chunks = 0;
    const auto setup = setup_bytes(unusual_setup(), chunks);
    auto source = ChunkReader::of(setup, "test");
    REQUIRE(source);
    std::vector<std::byte> bytes;
    ByteWriter(bytes).bytes(file_header());
    std::vector<std::byte> input_log;
    ByteWriter writer(input_log);
    put_entry(writer, flow::Request::grab);
    append_chunk(bytes, log_chunk, 0, input_log);
    while (const auto chunk = source->next())
      append_chunk(bytes, chunk->type, chunk->number + 1, chunk->payload);
    auto reader = TakeReader::of(bytes, "test");
    REQUIRE(reader);
    while (reader->next()) {
    }
    CHECK(reader->setup().gloves.empty());
    CHECK(reader->setup().hands.empty());
    CHECK_FALSE(reader->setup().loop.has_value());
    CHECK(reader->setup().program.empty());
    CHECK(reader->unknown_entries() == chunks);
    CHECK(reader->chunks().damage_count() == 0);
  }

  TEST_CASE("numbers that no loop may have are refused, one by one, and never come out") {
    std::uint32_t chunks = 0;
    const auto bytes = setup_bytes(unusual_setup(), chunks);
    auto reader = ChunkReader::of(bytes, "test");
    REQUIRE(reader);
    while (const auto chunk = reader->next()) {
      if (chunk->type != chunk_type("LOOP") && chunk->type != chunk_type("HAND")) continue;
      std::uint64_t refused = 0;
      // NaN, infinity, and the largest of everything, at each position of a number.
      for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), 1e300}) {
        const auto pattern = std::bit_cast<std::array<std::byte, 8>>(bad);
        for (std::size_t at = 0; at + 8 <= chunk->payload.size(); ++at) {
          std::vector<std::byte> payload(chunk->payload.begin(), chunk->payload.end());
          std::copy(pattern.begin(), pattern.end(),
                    payload.begin() + static_cast<std::ptrdiff_t>(at));
          Setup setup;
          if (!read_setup_chunk(chunk->type, payload, setup)) {
            ++refused;
            CHECK_FALSE(setup.loop.has_value());
            continue;
          }
          for (const auto& hand : setup.hands) {
            for (const Side side : {Side::left, Side::right}) {
              for (const auto& line : hand.wearer.of(side).calibration.sensors)
                CHECK(std::abs(line.gain_rad_per_count) < 1e7);
              CHECK(hand.wearer.of(side).size.length_m < 2.0);
            }
          }
          if (!setup.loop) continue;
          CHECK(setup.loop->placement.T_stage_wrist[0].matrix().allFinite());
          CHECK(setup.loop->options.rate_hz <= 1e4);
          CHECK(setup.loop->options.sculptor.deformer.supports.are_usable());
        }
      }
      CHECK(refused > 100);
    }
  }

  TEST_CASE("what the gloves sent is where and what FORMAT.md says") {
    RecordedLoop live(Mode::type1);
    live.record({.sent = [] {
      return std::vector<driver::RecordCounts>{{359, 98, 7, 12}, {1ULL << 40U, 0, 0, 0}};
    }});
    test::play(live, 20);
    REQUIRE(live.end());
    std::vector<std::string> kinds;
    json sent;
    for (const auto& line : read_by_python(live.path)) {
      kinds.push_back(line["chunk"]);
      if (kinds.back() == "SENT") sent = line;
    }
    REQUIRE(kinds.size() > 2);
    CHECK(kinds.back() == "END ");
    CHECK(kinds[kinds.size() - 2] == "SENT");
    CHECK(sent["gloves"][0] ==
          json{{"delivered", 359}, {"missed", 98}, {"refused", 7}, {"bad", 12}});
    CHECK(sent["gloves"][1]["delivered"] == 1ULL << 40U);
  }

  TEST_CASE("shapes are where and what FORMAT.md says") {
    RecordedLoop live(Mode::type1);
    live.record();
    for (std::uint64_t tick = 0; tick < 20; ++tick) {
      live.test.bend(static_cast<int>(tick), HostClock::now());
      live.test.frame_after_tick(tick);
    }
    const auto last = live.test.vertices_of(live.test.loop->frames().front());
    REQUIRE(live.end());
    const auto with = live.folder.path() / "with.nendo";
    REQUIRE(add_shapes(live.path, with, live.test.model, 1e9));
    std::uint64_t tick = 0;
    std::uint64_t shapes = 0;
    json shape;
    for (const auto& line : read_by_python(with)) {
      if (line.contains("tick") && line["chunk"] == "TAPE") tick = line["tick"];
      if (line["chunk"] != "SHAP") continue;
      ++shapes;
      CHECK(line["tick"] == tick);
      shape = line;
    }
    CHECK(shapes == 20);
    REQUIRE(shape["vertices"] == last.cols());
    double farthest = 0.0;
    for (Eigen::Index at = 0; at < last.size(); ++at)
      farthest =
          std::max(farthest, std::abs(shape["xyz"][static_cast<std::size_t>(at)].get<double>() -
                                      last.data()[at]));
    CHECK(farthest < 1e-6);
  }
}

} // namespace take_reader_test
