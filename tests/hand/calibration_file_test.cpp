#include <nendo/hand/calibration_file.hpp>

#include <algorithm>
#include <csignal>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "support/random_calibration.hpp"
#include "support/temporary_folder.hpp"

#include <fstream>
#include <iterator>

namespace calibration_file_test {

using namespace nendo;
using namespace nendo::hand;
using nendo::test::random_calibration;
using nendo::test::same_bits;
using nendo::test::TemporaryFolder;

namespace fs = std::filesystem;

namespace {

const std::string written_by_hand = R"(version = 1
user = "anna"
hand = "left"
made = 2026-11-21T21:27:05+02:00
method = "full"
middle_bias = 0.25
mixed_in = [ { of = "thumb_roll", by = "thumb_abduction", rad_per_rad = -0.5 } ]

[glove]
model = "CyberGlove, 22 sensors"
serial = "A1"
counts_most = 255
whole_range = false

[hand_size]
length_m = 0.19
breadth_m = 0.08

[sensors]
index_mcp = { gain_rad_per_count = 0.0125, offset_counts = 60 }
wrist_yaw = { gain_rad_per_count = -0.011, offset_counts = 128.5, residual_rad = 0.05, least_counts = 40, most_counts = 200, confidence = 0.9 }
)";

std::string with(const std::string& what, const std::string& instead) {
  std::string text = written_by_hand;
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), instead);
}

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

WearerCalibration wearer_named(const std::string& user) {
  WearerCalibration wearer;
  wearer.user = user;
  wearer.method = "quick";
  wearer.calibration = default_calibration();
  return wearer;
}

/// Files of this process cannot grow beyond so many bytes, while this lives.
class FullDisk {
public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

private:
  void (*handler_)(int);
  rlimit before_{};
};

} // namespace

TEST_SUITE("calibration file") {
  TEST_CASE("a file says what its text says") {
    const auto wearer = parse_calibration(written_by_hand, "anna.toml");
    REQUIRE(wearer);
    CHECK(wearer->user == "anna");
    CHECK(wearer->side == Side::left);
    CHECK(wearer->method == "full");
    CHECK(wearer->glove_model == "CyberGlove, 22 sensors");
    CHECK(wearer->glove_serial == "A1");
    CHECK(wearer->counts == CountScale{255, false});
    CHECK(rfc3339(wearer->made) == "2026-11-21T19:27:05Z"); // the zone is reckoned in
    CHECK(wearer->size.length_m == 0.19);
    CHECK(wearer->size.breadth_m == 0.08);
    CHECK(wearer->calibration.middle_bias == 0.25);
    CHECK(wearer->calibration.coupling_gains[0] == -0.5);
    CHECK(wearer->calibration.coupling_gains[1] == 0.0);
    CHECK(wearer->calibration[Sensor::index_mcp].gain_rad_per_count == 0.0125);
    CHECK(wearer->calibration[Sensor::index_mcp].offset_counts == 60.0);
    CHECK(wearer->calibration[Sensor::wrist_yaw].offset_counts == 128.5);
    CHECK(wearer->calibration[Sensor::index_pip].gain_rad_per_count == 0.0);
    CHECK(wearer->quality[22] == SensorQuality{0.05, 40.0, 200.0, 0.9});
    CHECK_FALSE(wearer->quality[4]);
  }

  TEST_CASE("what is written is read back to the last bit, and written again is the same text") {
    std::mt19937_64 random(7);
    for (int turn = 0; turn < 2000; ++turn) {
      const auto wearer = random_calibration(random);
      const auto text = calibration_text(wearer);
      REQUIRE(text);
      const auto back = parse_calibration(*text, "text");
      CAPTURE(*text);
      if (!back) FAIL(back.error().message);
      REQUIRE(same_bits(*back, wearer));
      REQUIRE(*calibration_text(*back) == *text);
    }
  }

  TEST_CASE("a file that is not right is refused in one line that names file, line and thing") {
    struct Case {
      std::string text;
      int line; ///< 0: any
      std::string about;
    };
    const std::string index = "index_mcp = { gain_rad_per_count = 0.0125, offset_counts = 60 }";
    const auto sensor = [&](const std::string& line) { return with(index, line); };
    const std::vector<Case> cases{
        {with("version = 1", "version = 2"), 1, "version"},
        {with("version = 1\n", ""), 0, "version"},
        {with("version = 1", "version = \"1\""), 1, "version"},
        {with("user = \"anna\"", "user = 7"), 2, "user"},
        {with("user = \"anna\"", "user = \"\""), 0, "user"},
        {with("user = \"anna\"", "user = \"a\\nb\""), 0, "user"},
        {with("\"left\"", "\"Left\""), 3, "Left"},
        {with("2026-11-21T21:27:05+02:00", "2026-11-21T21:27:05"), 4, "made"},
        {with("2026-11-21T21:27:05+02:00", "\"today\""), 4, "made"},
        {with("middle_bias = 0.25", "middle_bias = nan"), 6, "middle_bias"},
        {with("middle_bias = 0.25", "middle_bias = 1e300"), 0, "middle_bias"},
        {with("middle_bias = 0.25", "middle_biass = 0.25"), 6, "middle_biass"},
        {with("by = \"thumb_abduction\"", "by = \"index_mcp\""), 7, "mixed_in"},
        {with("rad_per_rad = -0.5", "rad_per_rad = inf"), 7, "rad_per_rad"},
        {with("counts_most = 255", "counts_most = 0"), 12, "counts_most"},
        {with("whole_range = false", "whole_range = 0"), 13, "whole_range"},
        {with("length_m = 0.19", "length_m = 19"), 0, "length_m"},
        {with("breadth_m = 0.08\n", ""), 0, "breadth_m"},
        {sensor("index_mpc = { gain_rad_per_count = 0.0125, offset_counts = 60 }"), 20,
         "index_mpc"},
        {sensor("little_pip = { gain_rad_per_count = 0.0125, offset_counts = 60 }\n"
                "pinky_pip = { gain_rad_per_count = 0.0125, offset_counts = 60 }"),
         0, "little_pip is here twice"},
        {sensor("unused = { gain_rad_per_count = 0.0125, offset_counts = 60 }"), 20, "unused"},
        {sensor("index_mcp = 0.0125"), 20, "index_mcp"},
        {sensor("index_mcp = { gain_rad_per_count = 0.0, offset_counts = 60 }"), 20, "index_mcp"},
        {sensor("index_mcp = { gain_rad_per_count = -0.0125, offset_counts = 60 }"), 20, "sign"},
        {sensor("index_mcp = { gain_rad_per_count = 1.5, offset_counts = 60 }"), 20, "absurd"},
        {sensor("index_mcp = { gain_rad_per_count = inf, offset_counts = 60 }"), 20, "gain"},
        {sensor("index_mcp = { gain_rad_per_count = 0.0125 }"), 20, "offset_counts"},
        {sensor("index_mcp = { gain_rad_per_count = 0.0125, offset_counts = 1e9 }"), 20, "offset"},
        {sensor("index_mcp = { gain_rad_per_count = 0.0125, offset_counts = 60, colour = 1 }"), 20,
         "colour"},
        {with("confidence = 0.9", "confidence = 2"), 21, "confidence"},
        {with(", confidence = 0.9", ""), 21, "confidence"},
        {with("most_counts = 200", "most_counts = 20"), 21, "least_counts"},
        {with("[sensors]", "[sensors"), 19, ""},
        {written_by_hand.substr(0, written_by_hand.find("confidence = 0.9")), 21, ""},
        {"", 0, "version"},
        {"\xFF\xFE", 0, ""},
        {std::string(100000, '['), 0, ""},
    };
    for (const Case& c : cases) {
      const std::string& about = c.about;
      const int line = c.line;
      CAPTURE(about);
      const auto wearer = parse_calibration(c.text, "anna.toml");
      REQUIRE_FALSE(wearer);
      CAPTURE(wearer.error().message);
      CHECK(wearer.error().code == Errc::bad_input);
      CHECK(wearer.error().message.starts_with(
          "anna.toml:" + (line == 0 ? std::string{} : std::to_string(line) + ": ")));
      CHECK(wearer.error().message.find(about) != std::string::npos);
      CHECK(wearer.error().message.find('\n') == std::string::npos);
      CHECK(wearer.error().message.size() < 400);
    }
  }

  TEST_CASE("every beginning of a file is refused or whole") {
    for (std::size_t size = 0; size + 2 < written_by_hand.size(); ++size) {
      const auto wearer = parse_calibration(written_by_hand.substr(0, size), "cut");
      // Only the sensors are last and may be fewer: at a line's end.
      if (wearer) CHECK(size + 1 >= written_by_hand.find("[sensors]") + 9);
    }
  }

  TEST_CASE("what a reader would refuse is not written") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const TemporaryFolder folder;
    const auto refused = [&](auto&& spoil) {
      WearerCalibration wearer = wearer_named("anna");
      REQUIRE(calibration_text(wearer));
      spoil(wearer);
      const auto kept = write_calibration(folder.path() / "x.toml", wearer);
      CHECK_FALSE(kept);
      CHECK(names_in(folder.path()).empty());
    };
    refused([](auto& w) { w.user = ""; });
    refused([](auto& w) { w.user = "a\nb"; });
    refused([](auto& w) { w.user = "\xFF"; });
    refused([](auto& w) { w.user = "\xED\xA0\x80"; }); // a surrogate
    refused([](auto& w) { w.glove_serial = std::string(201, 'x'); });
    refused([&](auto& w) { w.calibration.middle_bias = nan; });
    refused([&](auto& w) { w.calibration.coupling_gains[3] = nan; });
    refused([&](auto& w) { w.calibration.sensors[4].gain_rad_per_count = nan; });
    refused([&](auto& w) { w.calibration.sensors[4].offset_counts = nan; });
    refused([](auto& w) { w.calibration.sensors[4].gain_rad_per_count *= -1.0; });
    refused([](auto& w) { w.calibration.sensors[23].gain_rad_per_count = 0.01; });
    refused([&](auto& w) { w.size.length_m = nan; });
    refused([](auto& w) { w.quality[7] = SensorQuality{}; }); // of a sensor without a gain
    refused([](auto& w) { w.counts.max_count = 0; });
    refused([](auto& w) { w.made = std::chrono::sys_seconds::max(); });
  }

  TEST_CASE("the earlier version stays beside the new one, and twenty of them at most") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "deep" / "anna.toml";
    const auto none = write_calibration(path, wearer_named("user 0"));
    REQUIRE(none);
    CHECK(none->empty());
    std::vector<fs::path> kept;
    for (int k = 1; k <= 25; ++k) {
      const auto before = contents(path);
      const auto earlier = write_calibration(path, wearer_named("user " + std::to_string(k)));
      REQUIRE(earlier);
      CHECK(is_earlier_version(*earlier));
      CHECK(earlier->filename().string().starts_with("anna."));
      CHECK(contents(*earlier) == before);
      kept.push_back(*earlier);
    }
    CHECK_FALSE(is_earlier_version(path));
    CHECK(read_calibration(path)->user == "user 25");
    CHECK(names_in(path.parent_path()).size() == 21);
    for (int k = 0; k < 25; ++k) { // the newest are the ones that stayed
      CAPTURE(k);
      REQUIRE(fs::exists(kept[static_cast<std::size_t>(k)]) == (k >= 5));
      if (k >= 5)
        CHECK(read_calibration(kept[static_cast<std::size_t>(k)])->user ==
              "user " + std::to_string(k));
    }
  }

  TEST_CASE("what went out of use last is the newest version, whatever the clock showed") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "anna.toml";
    REQUIRE(write_calibration(path, wearer_named("first")));
    const auto text = contents(path);
    std::ofstream(folder.path() / "anna.99991231T235959Z.toml") << "of a clock gone wrong";
    const auto kept = write_calibration(path, wearer_named("second"));
    REQUIRE(kept);
    CHECK(kept->filename() == "anna.99991231T235959Z-2.toml");
    CHECK(contents(*kept) == text);
  }

  TEST_CASE("a file that is taken out of use is an earlier version") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "anna.toml";
    REQUIRE(write_calibration(path, wearer_named("anna")));
    const auto text = contents(path);
    const auto kept = retire_calibration(path);
    REQUIRE(kept);
    CHECK_FALSE(fs::exists(path));
    CHECK(contents(*kept) == text);
    CHECK_FALSE(retire_calibration(path));
  }

  TEST_CASE("a disk that is full leaves the old file, and nothing else") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "anna.toml";
    REQUIRE(write_calibration(path, wearer_named("before")));
    const auto before = contents(path);
    {
      const FullDisk full(100);
      const auto refused = write_calibration(path, wearer_named("after"));
      REQUIRE_FALSE(refused);
      CHECK(refused.error().code == Errc::failed);
      CHECK(refused.error().message.find(path.string()) != std::string::npos);
    }
    CHECK(contents(path) == before);
    CHECK(names_in(folder.path()) == std::vector<std::string>{"anna.toml"});
    REQUIRE(write_calibration(path, wearer_named("after")));
    CHECK(read_calibration(path)->user == "after");
  }

  TEST_CASE("a folder that may not be written to leaves everything as it is") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "anna.toml";
    REQUIRE(write_calibration(path, wearer_named("before")));
    const uid_t me = ::geteuid();
    if (me == 0) REQUIRE(::seteuid(65534) == 0); // root may write everywhere
    if (me != 0) fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
    const auto refused = write_calibration(path, wearer_named("after"));
    const auto fresh = write_calibration(folder.path() / "new" / "b.toml", wearer_named("after"));
    if (me == 0) REQUIRE(::seteuid(0) == 0);
    if (me != 0) fs::permissions(folder.path(), fs::perms::owner_all);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::failed);
    CHECK_FALSE(fresh);
    CHECK(read_calibration(path)->user == "before");
    CHECK(names_in(folder.path()) == std::vector<std::string>{"anna.toml"});
  }

  TEST_CASE("what is no file is not read") {
    const TemporaryFolder folder;
    CHECK_FALSE(read_calibration(folder.path()));
    CHECK_FALSE(read_calibration("/dev/zero"));
    CHECK_FALSE(read_calibration(folder.path() / "missing.toml"));
    std::ofstream(folder.path() / "large.toml") << std::string(2'000'000, '#');
    CHECK_FALSE(read_calibration(folder.path() / "large.toml"));
  }

  TEST_CASE("a finer converter of the same glove gives the same angles") {
    WearerCalibration wearer = wearer_named("anna");
    wearer.calibration[Sensor::index_mcp] = {0.02, 50.0};
    wearer.calibration[Sensor::index_pip] = {};
    wearer.calibration.middle_bias = 0.3;
    const auto fine = calibration_for(wearer, {4080, false}); // 16 for 1
    CHECK(fine[Sensor::index_mcp].angle_rad(RawCount{1600}) ==
          doctest::Approx(0.02 * (100.0 - 50.0)));
    CHECK(fine.middle_bias == 0.3);
    // What is not calibrated is as without a file.
    CHECK(fine[Sensor::index_pip].gain_rad_per_count ==
          default_calibration({4080, false})[Sensor::index_pip].gain_rad_per_count);
    const auto other_kind = calibration_for(wearer, {255, true});
    CHECK(same_bits(other_kind, default_calibration({255, true})));
  }
}

} // namespace calibration_file_test
