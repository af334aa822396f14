// The picture of a calibration.

#include <chrono>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include <doctest/doctest.h>

#include <nendo/base/units.hpp>

#include "calibrate/report.hpp"
#include "support/temporary_folder.hpp"

namespace calibration_report_test {

using namespace nendo;

TEST_SUITE("calibration_report") {
  TEST_CASE("the picture says whose hand it is and when, and no zero has a sign") {
    const test::TemporaryFolder folder;
    hand::WearerCalibration wearer;
    wearer.user = "Zo\u00eb <&> Ann";
    wearer.side = Side::left;
    using namespace std::chrono_literals;
    wearer.made = std::chrono::sys_days(2026y / std::chrono::November / 24) + 21h + 5min + 9s;
    hand::CalibrationFit fit;
    // From -0.3 to 0.3 degrees, and from -1.4 to 90.
    const double gain = from_degrees(0.6);
    fit.calibration[Sensor::index_mcp] = {gain, 60.0};
    fit.sensors[static_cast<std::size_t>(Sensor::index_mcp)] = {true, true, 59.5, 60.5, 1e-9, 0.0};
    fit.calibration[Sensor::index_pip] = {gain, 60.0};
    fit.sensors[static_cast<std::size_t>(Sensor::index_pip)] = {
        true, true, 60.0 - 1.4 / 0.6, 210.0, from_degrees(2.25), 0.0};
    SensorMask sensors;
    sensors.add(Sensor::index_mcp);
    sensors.add(Sensor::index_pip);
    const auto path = folder.path() / "picture.svg";
    REQUIRE(calibrate::write_report_picture(path, fit, wearer, sensors));
    std::ifstream file(path);
    const std::string picture{std::istreambuf_iterator<char>(file), {}};
    CAPTURE(picture);
    CHECK(picture.find(">Calibration of Zo\u00eb &lt;&amp;&gt; Ann, left hand, "
                       "2026-11-24T21:05:09Z<") != std::string::npos);
    CHECK(picture.find(">0 to 0 deg<") != std::string::npos);
    CHECK(picture.find(">-1 to 90 deg<") != std::string::npos);
    CHECK(picture.find(">0.0 deg<") != std::string::npos);
    CHECK_FALSE(std::regex_search(picture, std::regex("-0(\\.0)?[ <]")));
  }
}

} // namespace calibration_report_test
