#include <limits>

#include <doctest/doctest.h>

#include "support/takes.hpp"
#include "support/temporary_folder.hpp"
#include "support/timelines.hpp"
#include "timeline/timeline.hpp"

namespace timeline_file_test {

using namespace nendo;
using namespace nendo::timeline;

namespace {

std::string text_of(const Timeline& timeline) {
  const auto text = timeline_text(timeline);
  REQUIRE(text);
  return *text;
}

std::string without(std::string text, const std::string& part) {
  const auto at = text.find(part);
  REQUIRE(at != std::string::npos);
  return text.erase(at, part.size());
}

std::string instead(std::string text, const std::string& part, const std::string& other) {
  const auto at = text.find(part);
  REQUIRE(at != std::string::npos);
  return text.replace(at, part.size(), other);
}

/// And then the model is cut by two wires, and its parts are edited.
Timeline with_cuts(Timeline timeline, std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (const int places : {2, 128}) {
    auto& wire = timeline.wires.emplace_back();
    for (int place = 0; place < places; ++place)
      wire.push_back({{any(random), any(random), any(random)}, {any(random), -0.0, 1e-300}});
  }
  for (const flow::Command& command :
       {flow::Command(flow::ChangeModel{1, flow::ModelSource::cut}),
        flow::Command(flow::ChangeModel{0, flow::ModelSource::cut}),
        flow::Command(flow::JoinParts{any(random) + 1.0}), flow::Command(flow::EditPart{false, 3}),
        flow::Command(flow::EditPart{true, 0}), flow::Command(flow::ChangeTopology{})})
    timeline.events.push_back({3.0, command});
  return timeline;
}

} // namespace

TEST_SUITE("timeline_file") {
  TEST_CASE("a timeline reads back to the same bits, and is written to the same text again") {
    std::mt19937 random(1);
    for (int round = 0; round < 50; ++round) {
      Timeline made = test::random_timeline(random);
      if (round % 2 == 1) made = with_cuts(std::move(made), random);
      made.hands[0].keys[2].angles.thumb_roll_rad = -0.0;
      made.hands[0].keys[2].angles.wrist_yaw_rad = std::numeric_limits<double>::denorm_min();
      made.hands[1].keys[3].wrist_m.x() = -1000.0;
      const std::string text = text_of(made);
      const auto back = parse_timeline(text, "back");
      CAPTURE((back ? std::string() : back.error().message));
      REQUIRE(back);
      CHECK(test::same_bits(*back, made));
      CHECK(back->take == made.take);
      CHECK(back->mesh == made.mesh);
      CHECK(back->held == made.held);
      CHECK(back->mesh_sum.crc == made.mesh_sum.crc);
      CHECK(back->mesh_sum.vertices == made.mesh_sum.vertices);
      CHECK(back->sculptor.deformer.supports.shared == made.sculptor.deformer.supports.shared);
      CHECK(back->sculptor.deformer.supports.own == made.sculptor.deformer.supports.own);
      CHECK(back->sculptor.deformer.injective.has_value() ==
            made.sculptor.deformer.injective.has_value());
      CHECK(text_of(*back) == text);
    }
  }

  TEST_CASE("a file is written and read, and names itself in errors") {
    const test::TemporaryFolder folder;
    std::mt19937 random(2);
    const Timeline made = test::random_timeline(random);
    const auto path = folder.path() / "a.timeline.toml";
    CHECK(is_timeline(path));
    CHECK_FALSE(is_timeline("a.toml"));
    REQUIRE(write_timeline(path, made));
    const auto back = read_timeline(path);
    REQUIRE(back);
    CHECK(test::same_bits(*back, made));
    CHECK(read_timeline(folder.path() / "none.timeline.toml").error().message.find("none.") !=
          std::string::npos);
    Timeline bad = made;
    bad.hands[1].keys.clear();
    const auto written = write_timeline(path, bad);
    REQUIRE_FALSE(written);
    CHECK(written.error().message.starts_with(path.string()));
    CHECK(read_timeline(path)); // as it was
    bad = made;
    bad.mesh = "\xFF";
    CHECK_FALSE(timeline_text(bad));
  }

  TEST_CASE("a hand's shape is read back, and has all terms or is left out") {
    std::mt19937 random(3);
    Timeline made = test::random_timeline(random);
    auto& terms = made.hands[0].size.shape.terms;
    terms.fill(0.02);
    terms[28] = 0.00125;
    terms[29] = 0.0025;
    const std::string text = text_of(made);
    const auto back = parse_timeline(text, "back");
    REQUIRE(back);
    CHECK(back->hands[0].size.shape.terms == terms);
    CHECK_FALSE(parse_timeline(without(text, ", 0.0025"), "short"));
  }

  TEST_CASE("timelines of unreleased programs are refused, with what to do") {
    std::mt19937 random(3);
    const std::string text = text_of(test::random_timeline(random));
    for (const std::string line : {"pull_is_step = true\n", "clay_scales_few_vertices = true\n"}) {
      for (const std::string& bad :
           {without(text, line), instead(text, line, instead(line, "true", "false"))}) {
        const auto parsed = parse_timeline(bad, "old");
        REQUIRE_FALSE(parsed);
        CHECK(parsed.error().message.find("nendo edit make") != std::string::npos);
      }
    }
  }

  TEST_CASE("what is wrong is said with its line") {
    std::mt19937 random(3);
    const std::string text = text_of(test::random_timeline(random));
    const auto complaint = [](const std::string& bad) {
      const auto parsed = parse_timeline(bad, "bad");
      REQUIRE_FALSE(parsed);
      CHECK(parsed.error().code == Errc::bad_input);
      CHECK(parsed.error().message.starts_with("bad:"));
      CHECK(parsed.error().message.find('\n') == std::string::npos);
      return parsed.error().message;
    };
    CHECK(complaint(instead(text, "version = 1", "version = 2")).starts_with("bad:2: "));
    CHECK(complaint(instead(text, "version = 1", "versions = 1")).find("version") !=
          std::string::npos);
    CHECK(complaint(without(text, "thumb_roll")).find("bad:") == 0);
    CHECK(complaint(instead(text, "thumb_roll = ", "thumb_rolls = ")).find("thumb_roll") !=
          std::string::npos);
    CHECK(complaint(instead(text, "time_s = 0.0", "time_s = nan")).find("finite") !=
          std::string::npos);
    CHECK(complaint(instead(text, "time_s = 0.0\nwrist", "time_s = -1\nwrist")).find("time") !=
          std::string::npos);
    CHECK(complaint(instead(text, "\"right\"", "\"left\"")).find("different sides") !=
          std::string::npos);
    CHECK(complaint(instead(text, "\"let go\"", "\"dance\"")).find("dance") != std::string::npos);
    CHECK(complaint(instead(text, "tip = 3", "tip = 11")).find("tip") != std::string::npos);
    CHECK(complaint(instead(text, "rate_hz = 60.0", "rate_hz = 1e300")).find("rate_hz") !=
          std::string::npos);
    CHECK(complaint(text + "\n[more]\n").find("more") != std::string::npos);
    const std::string cut = text_of(with_cuts(test::random_timeline(random), random));
    CHECK(complaint(instead(cut, "cut = 1", "cut = 2")).find("there is no wire 2") !=
          std::string::npos);
    CHECK(complaint(instead(cut, "copy_part = 3", "copy_part = -3")).find("copy_part") !=
          std::string::npos);
    CHECK(complaint(instead(cut, "join = ", "join = -")).find("seam") != std::string::npos);
    CHECK(complaint(instead(cut, "1e-300]", "1e300]")).find("wire 0") != std::string::npos);
    CHECK(complaint(instead(cut, "1e-300]", "1e-300, 1]")).find("a wire's place") !=
          std::string::npos);
    CHECK(complaint(instead(cut, "wires = [", "wires = [[],")).find("wire 0: must have 2") !=
          std::string::npos);
  }

  TEST_CASE("whatever is done to its bytes, it is refused, or can be written and played") {
    std::mt19937 random(4);
    const std::string text = text_of(with_cuts(test::random_timeline(random, 2), random));
    const auto judge = [](const std::string& bytes) {
      const auto parsed = parse_timeline(bytes, "bytes");
      if (!parsed) {
        CHECK(parsed.error().message.starts_with("bytes:"));
        CHECK(parsed.error().message.find('\n') == std::string::npos);
        return;
      }
      CHECK(complaint_about(*parsed).empty());
      CHECK(timeline_text(*parsed));
    };
    for (std::size_t length = 0; length < text.size(); length += 7)
      judge(text.substr(0, length));
    for (int round = 0; round < 800; ++round) {
      std::string bytes = text;
      for (auto turns = 1 + random() % 3; turns > 0; --turns)
        bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
      judge(bytes);
    }
  }
}

} // namespace timeline_file_test
