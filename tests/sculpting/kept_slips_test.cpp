#include <nendo/sculpting/kept_learning.hpp>

#include <cstdlib>
#include <string_view>

#include <doctest/doctest.h>

#include <nendo/hand/calibration_file.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "support/temporary_folder.hpp"

namespace kept_slips_test {

using namespace nendo;

namespace {

constexpr auto pip = static_cast<std::size_t>(Sensor::ring_pip);
constexpr auto mcp = static_cast<std::size_t>(Sensor::ring_mcp);

/// A home in which vera's right hand is calibrated.
struct Home {
  test::TemporaryFolder folder;
  driver::GloveInfo glove;
  hand::WearerCalibration made;

  Home() {
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    glove.source = "a test's glove";
    glove.model = "CyberGlove";
    made.user = "vera";
    made.glove_model = glove.model;
    made.method = "full";
    made.calibration = hand::default_calibration();
    made.quality[pip] = hand::SensorQuality{0.02, 60.0, 250.0, 1.0};
    made.quality[mcp] = hand::SensorQuality{0.01, 40.0, 160.0, 1.0};
    REQUIRE(hand::write_calibration(file(), made));
  }
  ~Home() { ::unsetenv("XDG_CONFIG_HOME"); }
  Home(const Home&) = delete;
  Home& operator=(const Home&) = delete;

  static std::filesystem::path file() {
    return *hand::own_calibration_path("vera", "", Side::right);
  }
  Result<hand::Wearer> wearer(const sculpting::CalibrationOptions& options) const {
    return sculpting::find_wearer(glove, Side::right, options, [](std::string_view) {});
  }
};

} // namespace

TEST_SUITE("kept_slips") {
  TEST_CASE("--adapt begins from the calibration of a user, or from one that is named") {
    const Home home;
    for (const sculpting::CalibrationOptions& options :
         {sculpting::CalibrationOptions{"vera", "", true}, {"", "vera", true}}) {
      const auto wearer = home.wearer(options);
      REQUIRE_MESSAGE(wearer, wearer.error().message);
      CHECK(wearer->adapt == home.glove.counts);
      CHECK(wearer->right.calibration == home.made.calibration);
      CHECK_FALSE(wearer->learned);
      REQUIRE(wearer->ends);
      CHECK(wearer->ends->side == Side::right);
      CHECK(wearer->ends->counts.present.bits == (1U << pip | 1U << mcp));
      CHECK(wearer->ends->counts.low_counts[pip] == 60.0);
      CHECK(wearer->ends->counts.high_counts[mcp] == 160.0);
    }
    hand::WearerCalibration left = home.made;
    left.side = Side::left;
    left.calibration.sensors[pip].offset_counts = 77.0;
    REQUIRE(hand::write_calibration(*hand::own_calibration_path("vera", "", Side::left), left));
    const auto both = home.wearer({"vera", "", true}); // a left glove may take its place
    REQUIRE(both);
    CHECK(both->left.calibration == left.calibration);
    CHECK(both->ends->side == Side::right);
    const auto visitor = home.wearer({"", "", true});
    REQUIRE(visitor);
    CHECK_FALSE(visitor->ends);
  }

  TEST_CASE("a calibration without its ends, or that counts otherwise, is refused") {
    Home home;
    home.glove.counts = {4095, false};
    const auto other = home.wearer({"vera", "", true});
    REQUIRE_FALSE(other);
    CHECK(other.error().code == Errc::bad_input);
    CHECK(other.error().message.find("counts otherwise") != std::string::npos);
    home.glove.counts = {};
    home.made.quality = {};
    REQUIRE(hand::write_calibration(home.file(), home.made));
    const auto imported = home.wearer({"vera", "", true});
    REQUIRE_FALSE(imported);
    CHECK(imported.error().message.find("does not have the ranges of its sensors") !=
          std::string::npos);
  }

  TEST_CASE("what has slipped by half a count is kept, with its ends, and nothing else changes") {
    const Home home;
    hand::SensorAngles slips{};
    slips[mcp] = 0.3;
    const auto none = sculpting::keep_slips(home.glove, Side::right, "vera", slips);
    REQUIRE(none);
    CHECK_FALSE(none->is_changed);
    slips[pip] = 7.25;
    const auto kept = sculpting::keep_slips(home.glove, Side::right, "vera", slips);
    REQUIRE(kept);
    CHECK(kept->is_changed);
    CHECK(kept->path == home.file());
    const auto now = hand::read_calibration(home.file());
    REQUIRE(now);
    auto expected = home.made.calibration;
    expected.sensors[pip].offset_counts += 7.25;
    CHECK(now->calibration.sensors[pip] == expected.sensors[pip]);
    CHECK(now->calibration.sensors[mcp] == expected.sensors[mcp]);
    CHECK(now->method == "full");
    CHECK(now->quality[mcp] == home.made.quality[mcp]);
    CHECK(now->quality[pip]->min_counts == 67.25);
    CHECK(now->quality[pip]->max_counts == 255.0); // no glove counts further
    CHECK(now->quality[pip]->residual_rad == home.made.quality[pip]->residual_rad);
    std::size_t files = 0; // also the previous one
    for ([[maybe_unused]] const auto& file :
         std::filesystem::directory_iterator(home.file().parent_path()))
      ++files;
    CHECK(files == 2);
    REQUIRE(hand::retire_calibration(home.file()));
    CHECK_FALSE(sculpting::keep_slips(home.glove, Side::right, "vera", slips));
  }
}

} // namespace kept_slips_test
