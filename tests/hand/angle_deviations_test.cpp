#include <nendo/hand/angle_sources.hpp>

#include <cmath>
#include <limits>

#include <doctest/doctest.h>

namespace angle_deviations_test {

using namespace nendo;
using namespace nendo::hand;

TEST_SUITE("angle_deviations") {
  TEST_CASE("whatever a glove measures, estimates are less certain, and assumptions say nothing") {
    SensorMask curl;
    for (const Sensor sensor : {Sensor::index_mcp, Sensor::middle_pip, Sensor::thumb_ip})
      curl.add(sensor);
    for (const SensorMask present : {sensors_22, sensors_18, curl, SensorMask{}}) {
      const AngleSources sources = angle_sources(present);
      const AngleDeviations deviations = angle_deviations({}, present);
      const AngleDeviations measured = angle_deviations({}, sensors_22);
      for (std::size_t at = 0; at < angle_count; ++at) {
        CAPTURE(angle_names[at]);
        if (sources[at] == AngleSource::zero) CHECK(deviations[at] == 0.0);
        if (sources[at] == AngleSource::measured) CHECK(deviations[at] == measured[at]);
        if (is_estimated(sources[at])) CHECK(deviations[at] > from_degrees(5.0));
        CHECK(deviations[at] < from_degrees(90.0));
      }
    }
  }

  TEST_CASE("an estimated DIP joint is surest where the PIP joint is half bent") {
    const auto dip_deg = [](double pip_deg) {
      JointAngles angles;
      angles[Finger::ring].pip_flexion_rad = from_degrees(pip_deg);
      return to_degrees(angle_deviations(angles, sensors_18)[index_of(Angle::ring_dip_flexion)]);
    };
    CHECK(dip_deg(50.0) == doctest::Approx(16.0));
    CHECK(dip_deg(0.0) > 1.5 * dip_deg(50.0));
    CHECK(dip_deg(100.0) > 1.5 * dip_deg(50.0));
    for (double pip = -200.0; pip < 200.0; pip += 0.5)
      CHECK(std::abs(dip_deg(pip + 0.5) - dip_deg(pip)) < 0.4); // no jumps
    CHECK(std::isfinite(dip_deg(std::numeric_limits<double>::quiet_NaN())));
  }
}

} // namespace angle_deviations_test
