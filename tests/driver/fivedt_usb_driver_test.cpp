#include <nendo/driver/open_glove.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include <doctest/doctest.h>

#include "support/eventually.hpp"
#include "support/glove_facts.hpp"
#include "support/mocked_usb.hpp"
#include "support/required.hpp"

namespace fivedt_usb_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

std::string spec_of(std::uint16_t product) {
  return "usb:5d70:00" + std::string(product < 16 ? "0" : "1") + std::to_string(product % 16);
}

} // namespace

TEST_SUITE("fivedt_usb_driver") {
  TEST_CASE("each model says its hand, and every value arrives at its sensor, in order") {
    for (const std::uint16_t product : std::array<std::uint16_t, 5>{0x00, 0x01, 0x07, 0x10, 0x13}) {
      CAPTURE(product);
      MockedUsb bus;
      UltraModel model(product);
      bus.plug(model, 3, 7);
      SampleRing ring(4096);
      auto glove = required(open_glove(spec_of(product)));
      const Side side = product % 2 == 0 ? Side::right : Side::left;
      CHECK(glove->info().side == side);
      CHECK(glove->info().counts == CountScale{4095, true});
      CHECK(glove->info().model ==
            (product < 16 ? "5DT Data Glove 14 Ultra" : "5DT Data Glove 5 Ultra"));
      CHECK(fact(glove->info(), "link") == (product == 7      ? "wireless, port B"
                                            : product == 0x13 ? "wireless, port A"
                                                              : "cable"));
      test::require_ok(glove->start(ring));
      CHECK(eventually([&] { return ring.size() >= 40; }));
      glove->stop();
      const StreamStats stats = glove->stats();
      CHECK(stats.records == ring.size());
      CHECK(stats.bytes == 64 * stats.records);
      CHECK(stats.record_bytes == stats.bytes);
      const SensorMask sensors = glove->info().sensors;
      glove.reset();

      GloveSample sample;
      REQUIRE(ring.try_pop(sample));
      auto sent = std::find_if(model.sent.begin(), model.sent.end(),
                               [&](const SentCounts& counts) { return shows(sample, counts); });
      REQUIRE(sent != model.sent.end());
      for (bool more = true; more; more = ring.try_pop(sample)) {
        REQUIRE(sent != model.sent.end());
        CHECK(shows(sample, *sent++));
        CHECK(sample.side == side);
        CHECK(sample.present == sensors);
      }
    }
  }

  TEST_CASE("reports of another length are dropped and counted") {
    MockedUsb bus;
    UltraModel model(0x0000);
    auto& device = bus.plug(model, 3, 7);
    SampleRing ring(4096);
    auto glove = required(open_glove("usb:5d70:0000"));
    test::require_ok(glove->start(ring));
    MockedUsb::with_model(device, [&] { model.odd_reports = {UsbBytes(63, 1), UsbBytes(1, 1)}; });
    CHECK(eventually([&] { return glove->stats().bad_records == 2; }));
    CHECK(glove->stats().discarded_bytes == 64);
    glove->stop();
  }

  TEST_CASE("hand= goes before what the glove says, and a receiver without a glove is no glove") {
    MockedUsb bus;
    UltraModel model(0x0002);
    auto& device = bus.plug(model, 3, 7);
    {
      const auto turned = required(open_glove("usb:5d70:0002?hand=left"));
      CHECK(turned->info().side == Side::left);
    }
    CHECK(open_glove("usb:5d70:0000").error().code == Errc::no_device);
    MockedUsb::with_model(device, [&] { model.silent = true; });
    const auto silent = open_glove("usb:5d70:0002");
    REQUIRE_FALSE(silent);
    CHECK(silent.error().code == Errc::no_device);
    CHECK(silent.error().message.find("switched on") != std::string::npos);
  }
}

} // namespace fivedt_usb_driver_test
