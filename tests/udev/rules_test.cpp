// The text of udev rules and bindings. What udev does by them is in apps/udev_rules_test.cpp.

#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <nendo/base/files.hpp>
#include <nendo/udev/bindings.hpp>
#include <nendo/udev/device_table.hpp>
#include <nendo/udev/rules.hpp>

#include "support/shell.hpp"

namespace rules_test {

using namespace nendo;
using namespace nendo::udev;

namespace {

SerialPort port_of(const std::string& device, const std::string& place, const std::string& serial,
                   int interface_number = 0) {
  SerialPort port;
  port.device = device;
  port.usb =
      UsbIdentity{0x0403, 0x6001, "FTDI", "FT232R", serial, place, 1, 5, interface_number, 0};
  return port;
}

std::string rule_for(const std::vector<SerialPort>& ports, const std::string& port,
                     BoundDevice device, bool by_place = false) {
  const auto binding = make_binding(port, ports, device, by_place);
  REQUIRE_MESSAGE(binding, (binding ? "" : binding.error().message));
  const auto rule = rule_of(*binding);
  REQUIRE(rule);
  return *rule;
}

} // namespace

TEST_SUITE("udev rules") {
  TEST_CASE("the committed files are what the table of devices makes") {
    std::size_t committed = 0;
    for (const auto& entry : std::filesystem::directory_iterator(NENDO_UDEV_FOLDER))
      committed += entry.path().extension() == ".rules" ? 1U : 0U;
    CHECK(committed == shipped_rules().size());
    for (const RuleText& file : shipped_rules()) {
      const std::string name(file.name);
      const auto text = read_file(NENDO_UDEV_FOLDER "/" + name, 1U << 20U, "udev rules");
      CHECK_MESSAGE((text && *text == file.text), "make it again: nendo udev show ", name,
                    " > udev/", name);
    }
  }

  TEST_CASE("udevadm finds no fault with the committed files") {
    if (test::shell("udevadm verify --help").exit_code != 0) {
      MESSAGE("not run: udevadm verifies rules since systemd 254");
      return;
    }
    for (const RuleText& file : shipped_rules()) {
      const auto judged =
          test::shell("udevadm verify '" NENDO_UDEV_FOLDER "/" + std::string(file.name) + "'");
      CHECK_MESSAGE(judged.exit_code == 0, judged.out);
    }
  }

  TEST_CASE("no rule names an adapter that anything may hang on") {
    for (const RuleText& file : shipped_rules()) {
      CHECK(file.text.starts_with(rule_mark));
      std::string rules = file.text;
      for (std::size_t at = 0; (at = rules.find('#')) != std::string::npos;)
        rules.erase(at, rules.find('\n', at) - at);
      CHECK(rules.find("GOTO") != std::string::npos);
      for (const char* const vendor : {"0403", "067b", "10c4", "1a86"})
        CHECK_MESSAGE(rules.find(vendor) == std::string::npos, vendor);
    }
  }

  TEST_CASE("SpaceMice are known by their numbers, and other devices of Logitech are not") {
    for (const char* const product : {"c603", "c605", "c606", "c621", "c623", "c625", "c626",
                                      "c627", "c628", "c629", "c62b", "c640"})
      CHECK_MESSAGE(numbers_a_space_mouse("046d", product), product);
    for (const char* const product : {"c62e", "c632", "c633", "c635", "c63a", "c652"})
      CHECK_MESSAGE(numbers_a_space_mouse("256f", product), product);
    CHECK_FALSE(numbers_a_space_mouse("046d", "c077"));
    CHECK_FALSE(numbers_a_space_mouse("046d", "c62"));
    CHECK_FALSE(numbers_a_space_mouse("046d", "c6266"));
    CHECK_FALSE(numbers_a_space_mouse("045e", "c626"));
    CHECK_FALSE(numbers_a_space_mouse("", ""));
  }

  TEST_CASE("the grant comes before systemd turns tags into permissions") {
    const auto files = shipped_rules();
    REQUIRE(files.size() == 2);
    CHECK(files[0].name < files[1].name);
    CHECK(files[1].name < std::string_view("73"));
    CHECK(binding_file_name < files[0].name); // bindings are read first
  }

  TEST_CASE("a port is bound by its adapter's serial number") {
    const std::vector ports{port_of("/dev/ttyUSB0", "1-2", "A1"),
                            port_of("/dev/ttyUSB1", "1-3", "A2")};
    const std::string rule = rule_for(ports, "/dev/ttyUSB1", BoundDevice::right_glove);
    CHECK(rule.find(R"(ATTRS{serial}=="A2")") != std::string::npos);
    CHECK(rule.find(R"(ENV{ID_NENDO_HAND}="right")") != std::string::npos);
    CHECK(rule.find('\n') == std::string::npos);
    CHECK(rule.find("INTERFACE") == std::string::npos);
  }

  TEST_CASE("a property that two adapters share binds nothing") {
    auto no_usb = port_of("/dev/ttyS0", "", "");
    no_usb.usb.reset();
    const std::vector ports{port_of("/dev/ttyUSB0", "1-2", "0001"),
                            port_of("/dev/ttyUSB1", "1-3", "0001"),
                            port_of("/dev/ttyUSB2", "1-4", ""), no_usb};
    const auto code = [&](const std::string& port, bool by_place) {
      const auto binding = make_binding(port, ports, BoundDevice::left_glove, by_place);
      return binding ? 0 : static_cast<int>(binding.error().code);
    };
    CHECK(code("/dev/ttyUSB0", false) == static_cast<int>(Errc::usage));
    CHECK(code("/dev/ttyUSB0", true) == 0);
    CHECK(code("/dev/ttyUSB2", false) == static_cast<int>(Errc::usage));
    CHECK(code("/dev/ttyUSB2", true) == 0);
    CHECK(code("/dev/ttyS0", true) == static_cast<int>(Errc::usage));
    CHECK(code("/dev/ttyUSB9", false) == static_cast<int>(Errc::no_device));
  }

  TEST_CASE("of an adapter with several ports only the one is bound") {
    const std::vector ports{port_of("/dev/ttyUSB0", "1-2", "A1", 0),
                            port_of("/dev/ttyUSB1", "1-2", "A1", 1)};
    CHECK(rule_for(ports, "/dev/ttyUSB1", BoundDevice::left_glove).find(R"(INTERFACE}=="01")") !=
          std::string::npos);
    const std::vector same{port_of("/dev/ttyUSB0", "1-2", "A1", 0),
                           port_of("/dev/ttyUSB1", "1-2", "A1", 0)};
    CHECK_FALSE(make_binding("/dev/ttyUSB1", same, BoundDevice::left_glove, false));
  }

  TEST_CASE("a serial number that means something to udev makes no rule") {
    for (const char* const hostile : {"A\", RUN+=\"/bin/sh", "A*", "A?", "A|B", "[A]", "A\nRUN+=x",
                                      "$attr{x}", "%k", "A\\", "A\xC3\xA9", ""}) {
      Binding binding;
      binding.adapter = *port_of("/dev/ttyUSB0", "1-2", hostile).usb;
      CHECK_MESSAGE(!rule_of(binding), hostile);
    }
  }

  TEST_CASE("a hand has one adapter and an adapter one hand, whatever the order") {
    const std::vector ports{port_of("/dev/ttyUSB0", "1-2", "A1"),
                            port_of("/dev/ttyUSB1", "1-3", "A2")};
    const std::string first_right = rule_for(ports, "/dev/ttyUSB0", BoundDevice::right_glove);
    const std::string second_right = rule_for(ports, "/dev/ttyUSB1", BoundDevice::right_glove);
    const std::string first_left = rule_for(ports, "/dev/ttyUSB0", BoundDevice::left_glove);
    const std::string one = with_binding("", BoundDevice::right_glove, first_right);
    CHECK(binding_in(one, BoundDevice::right_glove) == first_right);
    CHECK_FALSE(binding_in(one, BoundDevice::left_glove));
    CHECK(with_binding(one, BoundDevice::right_glove, first_right) == one); // idempotent
    const std::string other = with_binding(one, BoundDevice::right_glove, second_right);
    CHECK(binding_in(other, BoundDevice::right_glove) == second_right);
    CHECK(other.find("A1") == std::string::npos);
    const std::string turned = with_binding(one, BoundDevice::left_glove, first_left);
    CHECK_FALSE(binding_in(turned, BoundDevice::right_glove));
    CHECK(binding_in(turned, BoundDevice::left_glove) == first_left);
    const std::string both = with_binding(turned, BoundDevice::right_glove, second_right);
    CHECK(binding_in(both, BoundDevice::left_glove) == first_left);
    CHECK(binding_in(both, BoundDevice::right_glove) == second_right);
    CHECK(without_binding(without_binding(both, BoundDevice::left_glove), BoundDevice::right_glove)
              .empty());
  }

  TEST_CASE("a tracker is bound beside the gloves, and an adapter is a glove's or a tracker's") {
    const std::vector ports{port_of("/dev/ttyUSB0", "1-2", "A1"),
                            port_of("/dev/ttyUSB1", "1-3", "A2")};
    const std::string glove = rule_for(ports, "/dev/ttyUSB0", BoundDevice::left_glove);
    const std::string tracker = rule_for(ports, "/dev/ttyUSB1", BoundDevice::tracker);
    CHECK(tracker.find(R"(ENV{ID_NENDO_TRACKER}="1")") != std::string::npos);
    CHECK(tracker.find("GLOVE") == std::string::npos);
    const std::string both = with_binding(with_binding("", BoundDevice::left_glove, glove),
                                          BoundDevice::tracker, tracker);
    CHECK(binding_in(both, BoundDevice::left_glove) == glove);
    CHECK(binding_in(both, BoundDevice::tracker) == tracker);
    const std::string moved = with_binding(both, BoundDevice::tracker,
                                           rule_for(ports, "/dev/ttyUSB0", BoundDevice::tracker));
    CHECK_FALSE(binding_in(moved, BoundDevice::left_glove));
    CHECK(without_binding(moved, BoundDevice::tracker).empty());
  }

  TEST_CASE("lines of the user's own survive binding and unbinding") {
    const std::string own = "# mine\nKERNEL==\"ttyS0\", SYMLINK+=\"gps\"\n\n# ends without newline";
    const std::string rule =
        rule_for({port_of("/dev/ttyUSB0", "1-2", "A1")}, "/dev/ttyUSB0", BoundDevice::left_glove);
    const std::string bound = with_binding(own, BoundDevice::left_glove, rule);
    CHECK(bound.find(own + '\n') != std::string::npos);
    CHECK(without_binding(bound, BoundDevice::left_glove).find(own + '\n') != std::string::npos);
    CHECK(without_binding(own, BoundDevice::left_glove) == own);
  }
}

} // namespace rules_test
