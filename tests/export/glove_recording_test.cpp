// What can be made of a recording of gloves alone: a table of all samples, and the hands.

#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/recording/recorder.hpp>

#include "export/gltf_export.hpp"
#include "export/motion_files.hpp"
#include "support/bvh_reader.hpp"
#include "support/csv_table.hpp"
#include "support/glb_reader.hpp"
#include "support/takes.hpp"
#include "takes/recorded_frames.hpp"

namespace glove_recording_test {

using namespace nendo;
using namespace nendo::exporting;
using std::chrono::milliseconds;

namespace {

constexpr double gain = 0.01;
constexpr double offset = 100.0;
constexpr std::size_t moments = 30;

/// Two gloves: the left one is calibrated and has a clock, the right one neither.
struct RecordedGloves {
  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "gloves.nendo";
  recording::Setup setup = recording::begin_setup("test 1.0");
  std::vector<GloveSample> samples; ///< samples of both, in the order of the recording

  RecordedGloves() {
    for (const Side side : {Side::left, Side::right}) {
      driver::GloveInfo glove;
      glove.kind = driver::SourceKind::device;
      glove.source = "serial:/dev/ttyUSB0";
      glove.side = side;
      glove.sensors = side == Side::left ? sensors_22 : sensors_18;
      glove.rate_hz = 100.0;
      setup.gloves.push_back(glove);
      flow::HandInput hand;
      hand.side = side;
      if (side == Side::left) hand.wearer.left.calibration = own_calibration();
      hand.first = sample(side, 0);
      setup.hands.push_back(hand);
    }
    write();
  }

  static hand::Calibration own_calibration() {
    hand::Calibration calibration;
    for (auto& sensor : calibration.sensors)
      sensor = {gain, offset};
    calibration[Sensor::palm_arch] = {}; // as one that was never calibrated
    return calibration;
  }

  /// The left glove's first sample comes 5 ms before the recording begins, and each of the right
  /// glove's 1 ms before the left one's.
  GloveSample sample(Side side, std::size_t moment) const {
    GloveSample sample;
    sample.side = side;
    sample.sequence = 7 + moment;
    sample.arrival = setup.begun_host + milliseconds(10 * static_cast<int>(moment) - 5);
    sample.measured = sample.arrival;
    if (side == Side::right) {
      sample.arrival -= milliseconds(1);
      sample.measured = sample.arrival;
    } else {
      sample.has_device_time = true;
      sample.device_time = milliseconds(10 * static_cast<int>(moment)) + std::chrono::seconds(42);
      sample.measured = sample.arrival - std::chrono::microseconds(2300);
      sample.wrist_switch = moment % 2 == 0 ? WristSwitch::on : WristSwitch::off;
    }
    const SensorMask mask = side == Side::left ? sensors_22 : sensors_18;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const auto sensor = static_cast<Sensor>(slot);
      if (mask.has(sensor))
        sample.set(sensor, RawCount{static_cast<std::uint16_t>(
                               offset + static_cast<double>(slot + moment))});
    }
    return sample;
  }

  std::string out(const std::string& name) const { return (folder.path() / name).string(); }

private:
  void write() {
    flow::InputLog input_log;
    recording::RecorderOptions options;
    options.file = path;
    auto recorder = recording::Recorder::begin(setup, input_log, std::move(options));
    REQUIRE(recorder);
    for (std::size_t moment = 0; moment < moments; ++moment)
      for (const Side side : {Side::right, Side::left}) {
        samples.push_back(sample(side, moment));
        input_log.sample(side == Side::left ? 0 : 1, samples.back());
      }
    REQUIRE((*recorder)->end());
  }
};

using Row = std::map<std::string, std::string>;

std::vector<Row> rows_of(const std::string& file) {
  std::istringstream lines(test::file_bytes(file));
  std::string line;
  std::getline(lines, line);
  const auto head = test::csv_cells(line);
  std::vector<Row> rows;
  while (std::getline(lines, line)) {
    const auto cells = test::csv_cells(line);
    REQUIRE(cells.size() == head.size());
    rows.emplace_back();
    for (std::size_t at = 0; at < head.size(); ++at)
      rows.back()[head[at]] = cells[at];
  }
  return rows;
}

std::unique_ptr<takes::FrameSource> frames_of(const RecordedGloves& gloves) {
  auto frames = takes::GloveFrames::open(gloves.path);
  REQUIRE(frames);
  return *std::move(frames);
}

/// The hand that the wearer had, in the wrist's own frame.
hand::HandPose pose_of(const RecordedGloves& gloves, std::size_t sample) {
  const GloveSample& taken = gloves.samples[sample];
  const auto& wearer = gloves.setup.hands[taken.side == Side::left ? 0 : 1].wearer.of(taken.side);
  return hand::HandSkeleton(taken.side, wearer.size)
      .pose(hand::joint_angles(taken, wearer.calibration), Eigen::Isometry3d::Identity());
}

} // namespace

TEST_SUITE("glove_recording") {
  TEST_CASE("every sample is a row, with its counts, both clocks and the glove's readings") {
    const RecordedGloves gloves;
    const auto done = export_samples_csv(gloves.path, {}, gloves.out("a.csv"));
    REQUIRE(done);
    CHECK(done->frames == 2 * moments);
    CHECK(done->exact);
    CHECK(done->bytes == std::filesystem::file_size(gloves.out("a.csv")));
    const auto rows = rows_of(gloves.out("a.csv"));
    REQUIRE(rows.size() == gloves.samples.size());
    for (std::size_t at = 0; at < rows.size(); ++at) {
      const GloveSample& sample = gloves.samples[at];
      const bool left = sample.side == Side::left;
      Row row = rows[at];
      const double time_s = 0.01 * static_cast<double>(at / 2) - (left ? 0.005 : 0.006);
      CHECK(std::stod(row["time_s"]) == doctest::Approx(time_s).epsilon(1e-12));
      CHECK(std::stod(row["measured_s"]) ==
            doctest::Approx(left ? time_s - 0.0023 : time_s).epsilon(1e-12));
      CHECK((row["device_time_s"] == "nan") == !left);
      if (left)
        CHECK(std::stod(row["device_time_s"]) ==
              doctest::Approx(42.0 + 0.01 * static_cast<double>(at / 2)).epsilon(1e-12));
      CHECK(row["hand"] == (left ? "0" : "1"));
      CHECK(row["calibrated"] == (left ? "1" : "0"));
      CHECK(row["sequence"] == std::to_string(7 + at / 2));
      CHECK(row["switch"] == (!left ? "nan" : at / 2 % 2 == 0 ? "1" : "0"));
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        const auto sensor = static_cast<Sensor>(slot);
        const std::string name(name_of(sensor));
        CHECK(row.contains(name + "_count") == sensors_22.has(sensor));
        if (!sensors_22.has(sensor)) continue;
        CHECK(row[name + "_count"] ==
              (sample.present.has(sensor) ? std::to_string(100 + slot + at / 2) : "nan"));
      }
    }
  }

  TEST_CASE("angles are the calibration's own, and there are none where there is none") {
    const RecordedGloves gloves;
    REQUIRE(export_samples_csv(gloves.path, {}, gloves.out("a.csv")));
    const auto rows = rows_of(gloves.out("a.csv"));
    constexpr double degrees = 57.29577951308232;
    for (std::size_t at = 0; at < rows.size(); ++at) {
      Row row = rows[at];
      const bool left = gloves.samples[at].side == Side::left;
      CHECK(row["palm_arch_deg"] == "nan");
      for (const Sensor sensor : {Sensor::index_mcp, Sensor::thumb_ip, Sensor::wrist_yaw}) {
        const std::string cell = row[std::string(name_of(sensor)) + "_deg"];
        CHECK((cell == "nan") == !left);
        if (left)
          CHECK(std::abs(std::stod(cell) -
                         degrees * gain *
                             static_cast<double>(static_cast<std::size_t>(sensor) + at / 2)) <
                1e-4);
      }
    }
  }

  TEST_CASE("a part of the time has the samples of that time, and none is an error") {
    const RecordedGloves gloves;
    const auto done =
        export_samples_csv(gloves.path, {.from_s = 0.1, .to_s = 0.2}, gloves.out("a.csv"));
    REQUIRE(done);
    CHECK(done->frames == 20);
    CHECK(done->first_s == doctest::Approx(0.104));
    CHECK(done->last_s == doctest::Approx(0.195));
    const auto none = export_samples_csv(gloves.path, {.from_s = 50.0}, gloves.out("b.csv"));
    REQUIRE_FALSE(none);
    CHECK(none.error().code == Errc::bad_input);
    CHECK_FALSE(std::filesystem::exists(gloves.out("b.csv")));
  }

  TEST_CASE("a table of a damaged recording is not exact, and has the samples that are whole") {
    const RecordedGloves gloves;
    std::string bytes = test::file_bytes(gloves.path);
    const std::size_t log = bytes.find("TAPE");
    REQUIRE(log != std::string::npos);
    bytes[log + 40] = static_cast<char>(bytes[log + 40] ^ 1);
    test::write_bytes(gloves.path, bytes);
    const auto done = export_samples_csv(gloves.path, {}, gloves.out("a.csv"));
    if (done)
      CHECK_FALSE(done->exact);
    else
      CHECK(done.error().code == Errc::bad_input); // all samples were in that chunk
  }

  TEST_CASE("a hand's BVH has its joints where the wearer's hand had them") {
    const RecordedGloves gloves;
    const auto source = frames_of(gloves);
    CHECK(source->rate_hz() == doctest::Approx(100.0));
    auto frames = ChosenFrames::make(*source, {.from_s = 0.0045, .rate_hz = 100.0});
    REQUIRE(frames);
    Skeletons skeletons;
    for (const auto& hand : gloves.setup.hands)
      skeletons[flow::Placement::index_of(hand.side)].emplace(hand.skeleton(hand.side));
    REQUIRE(export_hands_bvh(*frames, skeletons, gloves.out("hands.bvh")));
    for (const Side side : {Side::left, Side::right}) {
      const test::BvhRecording bvh(
          test::file_bytes(gloves.out("hands-" + std::string(name_of(side)) + ".bvh")));
      REQUIRE(bvh.frames.size() == moments - 1); // from the second sample on
      const std::string suffix = side == Side::left ? "_L" : "_R";
      for (const std::size_t frame : {0U, 13U, 27U}) {
        const auto world = bvh.world(frame);
        const auto pose = pose_of(gloves, 2 * (frame + 1) + (side == Side::left ? 1U : 0U));
        const auto place_of = [&](const std::string& name) -> Eigen::Vector3d {
          return world[bvh.find(name + suffix)].block<3, 1>(0, 3);
        };
        const Eigen::Vector3d way = place_of("index_distal") - place_of("wrist");
        const Eigen::Vector3d wanted =
            pose[hand::Joint::index_distal].translation() - pose[hand::Joint::wrist].translation();
        CHECK((way - 100.0 * wanted).norm() < 1e-3);
      }
    }
  }

  TEST_CASE("a GLB of gloves alone has both hands, each under a root of its own, and no model") {
    const RecordedGloves gloves;
    const auto done = export_gltf(*frames_of(gloves), {}, {}, gloves.out("hands.glb"));
    REQUIRE(done);
    CHECK_FALSE(done->morphs);
    const test::Glb glb(test::file_bytes(gloves.out("hands.glb")));
    CHECK(glb.json["skins"].size() == 2);
    CHECK(glb.json["scenes"][0]["nodes"].size() == 4); // two hands, two skins
    for (const auto& node : glb.json["nodes"])
      CHECK(node["name"] != "model");
    const std::size_t last = gloves.samples.size() - 2;
    // From the first sample, which is a moment before the beginning and counts as at it.
    const double time_s = 0.01 * static_cast<double>(moments - 1) - 0.005;
    for (const Side side : {Side::left, Side::right}) {
      const auto pose = pose_of(gloves, last + (side == Side::left ? 1U : 0U));
      const std::string suffix = side == Side::left ? "_L" : "_R";
      const auto place_of = [&](const std::string& name) -> Eigen::Vector3d {
        return glb.world(glb.node_named(name + suffix), time_s).translation();
      };
      CHECK((place_of("thumb_tip") - place_of("wrist") -
             (pose[hand::Joint::thumb_tip].translation() - pose[hand::Joint::wrist].translation()))
                .norm() < 1e-5);
      CHECK((place_of("wrist").x() > 0.0) == (side == Side::right)); // they do not overlap
    }
    const auto nothing =
        export_gltf(*frames_of(gloves), {}, {.hands = false}, gloves.out("nothing.glb"));
    REQUIRE_FALSE(nothing);
    CHECK(nothing.error().code == Errc::bad_input);
  }
}

} // namespace glove_recording_test
