// A visit of the studio to a calibration.

#include <doctest/doctest.h>

#include "studio/calibration_visit.hpp"
#include "support/eventually.hpp"

namespace calibration_visit_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

Side calibrated_side(const NamedGlove& glove) {
  CalibrationVisit visit(glove);
  driver::Glove* opened = nullptr;
  REQUIRE(test::eventually([&] {
    const auto now = visit.glove();
    REQUIRE(now);
    opened = *now;
    return opened != nullptr;
  }));
  return opened->info().side;
}

} // namespace

TEST_SUITE("calibration_visit") {
  TEST_CASE("a glove is calibrated for the hand that it is made for, or else for the named one") {
    CHECK(calibrated_side({"sim:rest", Side::left}) == Side::left);
    CHECK(calibrated_side({"sim:rest", Side::right}) == Side::right);
    CHECK(calibrated_side({"sim:rest?hand=left", Side::right}) == Side::left);
    CHECK(calibrated_side({"sim:rest"}) == Side::right);
  }
}

} // namespace calibration_visit_test
