#include <nendo/flow/finger_supports.hpp>

#include <doctest/doctest.h>

namespace finger_supports_test {

using namespace nendo;
using namespace nendo::flow;

TEST_SUITE("finger_supports") {
  TEST_CASE("each finger's radius is the largest that it was given, on the stage") {
    const auto alike = radii_on_stage(deform::one_radius(10.0), 4.0);
    for (const double radius : alike)
      CHECK(radius == doctest::Approx(2.5));
    const auto own = radii_on_stage(*parse_finger_supports("1,2,3,4,5+50:0.1"), 2.0);
    CHECK(own[1] == doctest::Approx(1.0));
    CHECK(own[4] == doctest::Approx(25.0));
  }

  TEST_CASE("five radii are for either hand, and ten for both together") {
    const auto five = parse_finger_supports("1,2,3,4,5+50:0.1");
    REQUIRE(five);
    CHECK(supports_of_hands(*five, 2)->own == five->own);
    const auto of_one = deform::parse_supports_by_point("1,2,3,4,5+50:0.1", 5);
    CHECK(supports_of_hands(*five, 1)->own == of_one->own);
    CHECK(supports_of_hands(*five, 1)->shared == of_one->shared);
    const auto ten = parse_finger_supports("1,2,3,4,5,6,7,8,9,10");
    REQUIRE(ten);
    CHECK_FALSE(supports_of_hands(*ten, 1));
    CHECK(supports_of_hands(*parse_finger_supports("7"), 1)->shared.front().radius == 7.0);
    CHECK_FALSE(parse_finger_supports("1,2,3"));
    CHECK_FALSE(parse_finger_supports("-3"));
  }

  TEST_CASE("a radius with a unit is on the stage, and one without in the model's units") {
    constexpr double units = 8.0; // powers of two, so that all numbers are exact
    const auto same = [](const char* one, const char* other) {
      const auto first = parse_finger_supports(one, units);
      const auto second = parse_finger_supports(other, units);
      REQUIRE(first);
      REQUIRE(second);
      return first->shared == second->shared && first->own == second->own;
    };
    CHECK(same("0.25m", "2"));
    CHECK(same("25cm", "2"));
    CHECK(same("250mm", "2"));
    CHECK(same("0.5m+40:0.5", "4+40:0.5"));
    CHECK(same("10+0.5m:0.5", "10+4:0.5"));
    CHECK(same("0.5m,1,1m+3:2,0.125m,5", "4,1,8+3:2,1,5"));
    for (const char* bad : {"3km", "cm", "-3cm", "0cm", "10:2cm", "3 cm", "infm", "3cm+"})
      CHECK_MESSAGE(!parse_finger_supports(bad, units), bad);
    CHECK(parse_finger_supports("3km").error().message.starts_with("3km: use a length"));
  }

  TEST_CASE("all radii are printed on the stage, and in the model's units") {
    CHECK(radius_text({0.132, 0.132, 0.132, 0.132, 0.132}, 1.88) == "13.2 cm (0.248)");
    CHECK(radius_text({0.1, 0.2, 0.1, 0.1, 0.4}, 0.5) == "10 to 40 cm (0.05 to 0.2)");
  }

  TEST_CASE("radii on the stage make the supports that the same radii on the model make") {
    const auto on_model = parse_finger_supports("0.5,1,1.5,2,2.5");
    const auto made = supports_on_model({0.25, 0.5, 0.75, 1.0, 1.25}, 2.0);
    CHECK(made.own == on_model->own);
    CHECK(made.shared == on_model->shared);
  }
}

} // namespace finger_supports_test
