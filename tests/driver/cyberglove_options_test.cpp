#include "cyberglove/cyberglove_options.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

namespace cyberglove_options_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::cyberglove;

namespace {

Result<Options> options_of(const std::string& text) {
  const auto spec = parse_device_spec("serial:/dev/ttyUSB0" + text);
  REQUIRE(spec);
  return read_options(*spec);
}

Options with_rate(double rate_hz) {
  Options options;
  options.rate_hz = rate_hz;
  return options;
}

} // namespace

TEST_SUITE("cyberglove_options") {
  TEST_CASE("every option is read") {
    const auto options = options_of("?baud=38400&rate=62.5&mask=0x7FFF7F&stamps=off&filter=off&"
                                    "quantised=on&sync=off&hires=off");
    REQUIRE_MESSAGE(options, options.error().message);
    CHECK(options->baud == 38400);
    CHECK(options->rate_hz == 62.5);
    CHECK(options->mask == sensors_22);
    CHECK(options->stamps == false);
    CHECK(options->filter == false);
    CHECK(options->quantised == true);
    CHECK_FALSE(options->sync);
    CHECK_FALSE(options->hires);

    const auto none = options_of("");
    REQUIRE(none);
    CHECK_FALSE(none->baud);
    CHECK_FALSE(none->rate_hz);
    CHECK_FALSE(none->mask);
    CHECK_FALSE(none->stamps);
    CHECK_FALSE(none->filter);
    CHECK_FALSE(none->quantised);
    CHECK(options_of("?sync=on")->sync);
    CHECK(options_of("?hires=on")->hires);
  }

  TEST_CASE("a bad value is a usage error that names the option") {
    for (const char* text : {"?baud=9601",
                             "?baud=38400x",
                             "?rate=0",
                             "?rate=-1",
                             "?rate=nan",
                             "?rate=inf",
                             "?rate=1001",
                             "?rate=90Hz",
                             "?rate=1e99",
                             "?mask=7FFF7F",
                             "?mask=0x",
                             "?mask=0x0",
                             "?mask=0x1000000",
                             "?mask=0xFFFFFFFFFFFF",
                             "?mask=0x-1",
                             "?stamps=yes",
                             "?filter=1",
                             "?quantised=ON",
                             "?sync=2",
                             "?hires=12",
                             "?speed=9600",
                             "?sync=on&rate=90",
                             "?sync=on&hires=on",
                             "?hires=on&mask=0x1",
                             "?hires=on&stamps=on"}) {
      CAPTURE(text);
      const auto options = options_of(text);
      REQUIRE_FALSE(options);
      CHECK(options.error().code == Errc::usage);
      const std::string key = std::string(text).substr(1, std::string(text).find('=') - 1);
      CHECK(options.error().message.find(key) != std::string::npos);
      CHECK(options.error().message.find("/dev/ttyUSB0") != std::string::npos);
    }
  }

  TEST_CASE("periods are the reference's, exactly") {
    struct Row {
      double rate_hz;
      Period period;
    };
    for (const Row& row :
         {Row{1, {57600, 2}}, Row{10, {11520, 1}}, Row{15, {7680, 1}}, Row{30, {3840, 1}},
          Row{45, {2560, 1}}, Row{60, {1920, 1}}, Row{75, {1536, 1}}, Row{80, {1440, 1}},
          Row{90, {1280, 1}}, Row{100, {1152, 1}}}) {
      CAPTURE(row.rate_hz);
      const auto period = choose_period(row.rate_hz);
      REQUIRE(period);
      CHECK(*period == row.period);
      CHECK(rate_of(*period) == row.rate_hz);
    }
    CHECK(rate_of({1152, 0}) == 0.0); // as fast as possible
    CHECK(rate_of({0, 0}) == 0.0);
  }

  TEST_CASE("the period chosen is the nearest there is, at the extremes too") {
    CHECK(choose_period(115200.0) == Period{1, 1});
    CHECK(choose_period(2.0) == Period{57600, 1});
    for (const double rate_hz : {0.0001, 0.01, 0.1, 0.7, 1.7577, 1.76, 3.3, 59.94, 333.3, 997.0}) {
      CAPTURE(rate_hz);
      const auto period = choose_period(rate_hz);
      REQUIRE(period);
      const double wanted = 115200.0 / rate_hz;
      const double got = static_cast<double>(period->ticks) * period->times;
      CHECK(std::abs(got - wanted) <= 0.5 * period->times);
      CHECK(std::abs(rate_of(*period) / rate_hz - 1.0) < 1e-2);
    }
    for (const double none :
         {0.0, -1.0, 115201.0, 1e-9, std::nan(""), std::numeric_limits<double>::infinity()}) {
      CHECK_FALSE(choose_period(none));
    }
  }

  TEST_CASE("the byte order of a period shows against what was set, and mostly in its value") {
    const auto bytes = [](std::array<unsigned, 4> numbers) {
      std::array<std::byte, 4> data{};
      for (std::size_t k = 0; k < 4; ++k)
        data[k] = static_cast<std::byte>(numbers[k]);
      return data;
    };
    CHECK(order_of(bytes({0x04, 0x80, 0, 1}), {1152, 1}) == WordOrder::high_first);
    CHECK(order_of(bytes({0x80, 0x04, 1, 0}), {1152, 1}) == WordOrder::low_first);
    CHECK_FALSE(order_of(bytes({0x80, 0x04, 0, 1}), {1152, 1})); // not one order for both words
    CHECK_FALSE(order_of(bytes({0x04, 0x80, 0, 2}), {1152, 1}));

    CHECK(guess_period(bytes({0x80, 0x04, 1, 0})) == Period{1152, 1});
    CHECK(guess_period(bytes({0x04, 0x80, 0, 1})) == Period{1152, 1});
    CHECK(guess_period(bytes({0x00, 0xE1, 2, 0})) == Period{57600, 2});
    CHECK(guess_period(bytes({0xE1, 0x00, 0, 2})) == Period{57600, 2});
    CHECK(rate_of(*guess_period(bytes({0x80, 0x04, 0, 0}))) == 0.0); // as fast as possible
    CHECK(rate_of(*guess_period(bytes({0, 0, 0, 0}))) == 0.0);
  }

  TEST_CASE("the baud register is the processor's") {
    struct Row {
      unsigned byte;
      int baud;
    };
    for (const Row& row : {Row{0x00, 115200}, Row{0x01, 57600}, Row{0x02, 28800}, Row{0x03, 14400},
                           Row{0x10, 38400}, Row{0x11, 19200}, Row{0x12, 9600}, Row{0x13, 4800},
                           Row{0x14, 2400}, Row{0x15, 1200}, Row{0x16, 600}, Row{0x17, 300}}) {
      CAPTURE(row.byte);
      CHECK(baud_of_register(static_cast<std::uint8_t>(row.byte)) == row.baud);
    }
    for (const unsigned none : {0x08U, 0x18U, 0x40U, 0xFFU})
      CHECK_FALSE(baud_of_register(static_cast<std::uint8_t>(none)));
  }

  TEST_CASE("a rate that the line cannot carry is refused with the arithmetic") {
    const auto plan = plan_records(with_rate(1000), 22, 115200, 0.0);
    REQUIRE_FALSE(plan);
    CHECK(plan.error().code == Errc::usage);
    CHECK(plan.error().message ==
          "rate=1000: a record of 24 bytes at 115200 baud takes 2.1 ms; at "
          "most 480 records per second; lower the rate or mask sensors off");
    Options with_stamps = with_rate(400);
    with_stamps.stamps = true;
    const auto stamped = plan_records(with_stamps, 22, 115200, 0.0);
    REQUIRE_FALSE(stamped);
    CHECK(stamped.error().message ==
          "rate=400: a record of 30 bytes at 115200 baud takes 2.6 ms; at most 384 records per "
          "second; lower the rate or say stamps=off (at most 480)");
  }

  TEST_CASE("stamps are on where the line carries them, and dropped for a wanted rate") {
    const auto stamps = [](std::size_t values, int baud, const Options& options, double present) {
      const auto plan = plan_records(options, values, baud, present);
      REQUIRE(plan);
      CHECK(plan->record_bytes == values + (plan->stamps ? 8 : 2));
      CHECK(plan->stamps_dropped == (!plan->stamps && !options.stamps));
      return plan->stamps;
    };
    // The ceilings of the reference: 22 sensors 480, 160, 80, 40 per second; with stamps 30 bytes.
    CHECK(stamps(22, 115200, with_rate(384), 0.0));
    CHECK_FALSE(stamps(22, 115200, with_rate(385), 0.0));
    CHECK_FALSE(stamps(22, 115200, with_rate(480), 0.0));
    CHECK_FALSE(plan_records(with_rate(480.1), 22, 115200, 0.0));
    CHECK(stamps(22, 9600, with_rate(32), 0.0));
    CHECK_FALSE(stamps(22, 9600, with_rate(40), 0.0));
    CHECK_FALSE(plan_records(with_rate(41), 22, 9600, 0.0));
    CHECK(stamps(18, 38400, with_rate(147), 0.0));
    // Without a wish, the rate that the unit has already.
    CHECK(stamps(22, 115200, {}, 90.0));
    CHECK_FALSE(stamps(22, 9600, {}, 90.0));
    CHECK(stamps(22, 9600, {}, 0.0));
    Options insist;
    insist.stamps = true;
    CHECK(stamps(22, 9600, insist, 90.0));
    Options without;
    without.stamps = false;
    CHECK_FALSE(stamps(22, 115200, without, 90.0));
    CHECK(plan_records(with_rate(90), 22, 115200, 0.0)->period == Period{1280, 1});
    CHECK_FALSE(plan_records({}, 22, 115200, 90.0)->period);
  }

  TEST_CASE("12-bit records come in steps of 30 Hz") {
    CHECK(plan_hires(with_rate(90), 115200).operator*() == 3);
    CHECK_FALSE(*plan_hires({}, 115200));
    for (const double wrong : {0.1, 45.0, 100.0, 150.0})
      CHECK(plan_hires(with_rate(wrong), 115200).error().code == Errc::usage);
    // 61 bytes: 62 per second at 38400 baud.
    CHECK(plan_hires(with_rate(60), 38400));
    CHECK(plan_hires(with_rate(90), 38400).error().message.find("at most 62") != std::string::npos);
  }
}

} // namespace cyberglove_options_test
