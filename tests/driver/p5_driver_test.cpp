#include <nendo/driver/open_glove.hpp>

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/eventually.hpp"
#include "support/mocked_usb.hpp"
#include "support/required.hpp"

namespace p5_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;

constexpr SensorMask knuckles{1U << 1U | 1U << 4U | 1U << 8U | 1U << 12U | 1U << 16U};

/// The samples are an unbroken run of the glove's reports.
void check_in_order(SampleRing& ring, const UsbGlove& glove) {
  std::vector<GloveSample> samples;
  ring.drain([&](const GloveSample& sample) { samples.push_back(sample); });
  REQUIRE(samples.size() >= 30);
  std::size_t first = 0;
  const auto all_from = [&](std::size_t begin) {
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (!shows(samples[k], glove.sent[begin + k])) return false;
    }
    return true;
  };
  while (first + samples.size() <= glove.sent.size() && !all_from(first))
    ++first;
  CHECK(first + samples.size() <= glove.sent.size());
  for (std::size_t k = 0; k < samples.size(); ++k)
    CHECK(samples[k].sequence == k);
}

/// A P5 at a bus of its own, streaming.
struct StreamingP5 {
  MockedUsb bus;
  P5Model model;
  MockedUsb::Device& device = bus.plug(model, 3, 7);
  SampleRing ring{1U << 15U};
  std::unique_ptr<Glove> glove = required(open_glove("usb:0d7f:0100"));

  StreamingP5() { test::require_ok(glove->start(ring)); }
};

void check_conservation(const StreamStats& stats) {
  CHECK(stats.bytes == stats.record_bytes + stats.discarded_bytes);
  CHECK(stats.record_bytes == 24 * stats.records);
}

} // namespace

TEST_SUITE("p5_driver") {
  TEST_CASE("a P5 says what it is, and its bends arrive in order at the knuckles") {
    MockedUsb bus;
    P5Model model;
    bus.plug(model, 3, 7);
    SampleRing ring(4096);
    auto glove = required(open_glove("usb:0d7f:0100"));
    const GloveInfo& info = glove->info();
    CHECK(info.source == "usb:0d7f:0100");
    CHECK(info.side == Side::right);
    CHECK(info.sensors == knuckles);
    CHECK(info.counts == CountScale{63, true});
    CHECK(info.abilities.wrist_switch);
    test::require_ok(glove->start(ring));
    CHECK_FALSE(glove->start(ring));
    CHECK(eventually([&] { return ring.size() >= 60; }));
    glove->stop();
    const StreamStats stats = glove->stats();
    CHECK(stats.records == ring.size());
    CHECK(stats.bad_records == 0);
    check_conservation(stats);
    glove.reset();
    check_in_order(ring, model);
  }

  TEST_CASE("the option says that it is worn on the left hand, and other options are refused") {
    MockedUsb bus;
    P5Model model;
    bus.plug(model, 3, 7, "A1");
    SampleRing ring(64);
    auto glove = required(open_glove("usb:0d7f:0100?serial=A1&hand=left"));
    CHECK(glove->info().side == Side::left);
    test::require_ok(glove->start(ring));
    GloveSample sample;
    CHECK(eventually([&] { return ring.try_pop(sample); }));
    CHECK(sample.side == Side::left);
    glove->stop();
    for (const char* wrong : {"usb:0d7f:0100?hand=both", "usb:0d7f:0100?baud=9600", "usb:0d7f",
                              "usb:", "usb:0d7f:01000", "usb:0d7f:zzzz", "usb:0d7f:0100:1",
                              "usb:1234:5678", "usb:5d70:0004", "usb:+d7f:0100"}) {
      CAPTURE(wrong);
      const auto refused = open_glove(wrong);
      REQUIRE_FALSE(refused);
      CHECK(refused.error().code == Errc::usage);
      CHECK(refused.error().message.find('\n') == std::string::npos);
    }
    CHECK(open_glove("usb:1234:5678").error().message.find("0d7f:0100") != std::string::npos);
    CHECK(open_glove("usb:0d7f:0100?serial=Z9").error().code == Errc::no_device);
  }

  TEST_CASE("button A is the wrist switch") {
    StreamingP5 p5;
    const auto arrives = [&](WristSwitch position) {
      GloveSample sample;
      return eventually([&] { return p5.ring.try_pop(sample) && sample.wrist_switch == position; });
    };
    CHECK(arrives(WristSwitch::off));
    MockedUsb::with_model(p5.device, [&] { p5.model.buttons = 1; });
    CHECK(arrives(WristSwitch::on));
    MockedUsb::with_model(p5.device, [&] { p5.model.buttons = 6; });
    CHECK(arrives(WristSwitch::off));
    p5.glove->stop();
  }

  TEST_CASE(
      "while it streams the glove moves no mouse, afterwards it does again if it did before") {
    for (const std::uint8_t before : std::array<std::uint8_t, 2>{0x01, 0xFF}) {
      MockedUsb bus;
      P5Model model;
      model.mouse_mode = before;
      auto& device = bus.plug(model, 3, 7);
      SampleRing ring(4096);
      auto glove = required(open_glove("usb:0d7f:0100"));
      MockedUsb::with_model(device, [&] { CHECK(model.mouse_modes_set.empty()); });
      for (int round = 0; round < 2; ++round) {
        test::require_ok(glove->start(ring));
        MockedUsb::with_model(device, [&] { CHECK(model.mouse_mode == 0xFF); });
        CHECK(eventually([&] { return glove->stats().records > 3; }));
        const auto start = Clock::now();
        glove->stop();
        glove->stop();
        CHECK(Clock::now() - start < 1s);
        MockedUsb::with_model(device, [&] { CHECK(model.mouse_mode == before); });
      }
      const std::vector<std::uint8_t> switched{0xFF, 0x01, 0xFF, 0x01};
      CHECK(model.mouse_modes_set == (before == 0x01 ? switched : std::vector<std::uint8_t>{}));
    }
  }

  TEST_CASE("a glove that knows no mouse mode works all the same") {
    MockedUsb bus;
    P5Model model;
    model.knows_mouse_mode = false;
    bus.plug(model, 3, 7);
    SampleRing ring(4096);
    auto glove = required(open_glove("usb:0d7f:0100"));
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return ring.size() > 3; }));
  }

  TEST_CASE("short, over-long and foreign reports are dropped and counted") {
    StreamingP5 p5;
    REQUIRE(eventually([&] { return p5.ring.size() > 3; }));
    UsbBytes overlong(30, 0x77); // one transfer takes 24 bytes of it, the next one 6
    overlong[0] = 2;
    MockedUsb::with_model(p5.device, [&] {
      p5.model.odd_reports = {{1, 2, 3}, overlong, UsbBytes(24, 0x33), UsbBytes(1, 1)};
    });
    CHECK(eventually([&] { return p5.glove->stats().bad_records == 5; }));
    const std::uint64_t records = p5.glove->stats().records;
    CHECK(eventually([&] { return p5.glove->stats().records > records + 3; }));
    p5.glove->stop();
    CHECK(p5.glove->stats().discarded_bytes >= 3 + 30 + 24 + 1);
    check_conservation(p5.glove->stats());
  }

  TEST_CASE("a glove that sends nothing, or something else, is an error that says so in time") {
    MockedUsb bus;
    P5Model model;
    model.silent = true;
    auto& device = bus.plug(model, 3, 7);
    const auto start = Clock::now();
    const auto silent = open_glove("usb:0d7f:0100");
    CHECK(Clock::now() - start < 30s);
    REQUIRE_FALSE(silent);
    CHECK(silent.error().code == Errc::no_device);
    CHECK(silent.error().message.find("switched on") != std::string::npos);
    MockedUsb::with_model(device, [&] {
      model.silent = false;
      model.odd_reports.assign(100'000, UsbBytes(8, 9));
    });
    const auto babbling = open_glove("usb:0d7f:0100");
    REQUIRE_FALSE(babbling);
    CHECK(babbling.error().message.find("another device") != std::string::npos);
    CHECK(MockedUsb::log_of(device).kernel_has_glove);
  }

  TEST_CASE("a glove that falls silent is asked again, and the mouse is given back all the same") {
    StreamingP5 p5;
    REQUIRE(eventually([&] { return p5.ring.size() > 3; }));
    MockedUsb::with_model(p5.device, [&] { p5.model.silent = true; });
    CHECK(eventually([&] { return p5.glove->stats().silences >= 1; }));
    MockedUsb::with_model(p5.device, [&] { p5.model.silent = false; });
    const std::uint64_t records = p5.glove->stats().records;
    CHECK(eventually([&] { return p5.glove->stats().records > records + 3; }));
    p5.glove->stop();
    CHECK(p5.glove->stats().reopened == 0);
    check_conservation(p5.glove->stats());
    MockedUsb::with_model(p5.device, [&] { CHECK(p5.model.mouse_mode == 0x01); });
  }

  TEST_CASE("a glove that is unplugged is found again under another address, as the same glove") {
    for (const bool has_serial : {true, false}) {
      CAPTURE(has_serial);
      const std::string serial = has_serial ? "A1" : "";
      MockedUsb bus;
      P5Model first;
      P5Model stranger;
      P5Model second;
      auto& device = bus.plug(first, 3, 7, serial);
      SampleRing ring(1U << 15U);
      auto glove = required(open_glove("usb:0d7f:0100"));
      test::require_ok(glove->start(ring));
      REQUIRE(eventually([&] { return ring.size() > 3; }));
      bus.unplug(device);
      // Of the same kind, but not this one: at another port, with another serial number.
      auto& other = bus.plug(stranger, 2, 8, has_serial ? "B2" : "");
      // A serial number is known at any port, a device without one at its own.
      auto& again = bus.plug(second, has_serial ? 4 : 3, 9, serial);
      CHECK(eventually([&] { return glove->stats().reopened == 1; }));
      const std::uint64_t records = glove->stats().records;
      CHECK(eventually([&] { return glove->stats().records > records + 3; }));
      CHECK(MockedUsb::log_of(again).claimed);
      CHECK(MockedUsb::log_of(other).detached == 0);
      MockedUsb::with_model(again, [&] { CHECK(second.mouse_mode == 0xFF); });
      glove->stop();
      MockedUsb::with_model(again, [&] { CHECK(second.mouse_mode == 0x01); });
      check_conservation(glove->stats());
      glove.reset();
      CHECK(MockedUsb::log_of(again).kernel_has_glove);
    }
  }

  TEST_CASE("stop does not wait for a glove that is away") {
    StreamingP5 p5;
    p5.bus.unplug(p5.device);
    CHECK(eventually([&] { return MockedUsb::log_of(p5.device).under_way == 0; })); // it is closed
    const auto start = Clock::now();
    p5.glove->stop();
    CHECK(Clock::now() - start < 1s);
  }
}

} // namespace p5_driver_test
