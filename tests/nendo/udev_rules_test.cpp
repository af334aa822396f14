// What udev makes of the rules: of gloves, of a bound adapter, and of their neighbours.

#include <doctest/doctest.h>

#include "support/udev_sandbox.hpp"

namespace udev_rules_test {

using namespace nendo::test;

namespace {

/// The installed rules, and bindings, as `nendo udev` writes them into a folder.
class Rules {
public:
  Rules() {
    REQUIRE(nendo::test::nendo({"udev", "install", "--root", root_.path().string()}).exit_code ==
            0);
  }

  std::filesystem::path path() const { return root_.path() / "etc/udev/rules.d"; }
  /// `nendo udev bind` on an emulated machine.
  void bind(const std::vector<PluggedDevice>& devices, const std::string& port,
            const std::string& hand) const {
    const auto description = root_.path() / "devices.umockdev";
    write_file(description, describe(devices));
    const std::string command = "umockdev-run -d '" + description.string() +
                                "' -- '" NENDO_PROGRAM "' udev bind /dev/" + port + " --as " +
                                hand + " --root '" + root_.path().string() + "' >/dev/null";
    REQUIRE(std::system(command.c_str()) == 0); // NOLINT(cert-env33-c)
  }

private:
  TemporaryFolder root_;
};

PluggedDevice adapter(const std::string& place, const std::string& port,
                      const std::string& serial) {
  return {place, "0403", "6001", "FTDI", "FT232R USB UART", serial, port, "ftdi_sio", "00"};
}

std::vector<std::string> all_paths(const PluggedDevice& device) {
  return {device.usb_path(), device.serial_path(), device.tty_path()};
}

} // namespace

// Nothing is asked where no sandbox can be made: udevadm would write to this machine's /dev.
#define ASK(verdict, ...)                                                                          \
  const auto verdict = ask_udev(__VA_ARGS__);                                                      \
  if (!verdict) {                                                                                  \
    MESSAGE("not run: this machine allows no namespaces");                                         \
    return;                                                                                        \
  }

TEST_SUITE("udev") {
  TEST_CASE("a bound adapter gets its link, its rights, peace and its latency timer") {
    const auto glove = adapter("1-2", "ttyUSB0", "A6008isP");
    const Rules rules;
    rules.bind({glove}, "ttyUSB0", "right");
    ASK(verdict, rules.path(), {glove}, all_paths(glove));
    CHECK_FALSE(verdict->complains());
    CHECK(verdict->links == "/dev/nendo/right\n");
    CHECK(verdict->property(glove.tty_path(), "TAGS").find(":uaccess:") != std::string::npos);
    CHECK(verdict->property(glove.tty_path(), "ID_MM_PORT_IGNORE") == "1");
    CHECK(verdict->mentions(glove.tty_path(), "MODE 0660"));
    CHECK(verdict->mentions(glove.tty_path(), "61-nendo-uaccess.rules:5 GROUP"));
    CHECK(verdict->property(glove.usb_path(), "ID_MM_DEVICE_IGNORE") == "1");
    // Who may open the adapter's own node could take its kernel driver away.
    CHECK_FALSE(verdict->mentions(glove.usb_path(), "uaccess:"));
    CHECK(verdict->mentions(glove.serial_path(), "latency_timer' writing '1'"));
  }

  TEST_CASE("an adapter that is bound to a tracker gets the same, and is no glove") {
    const auto tracker = adapter("1-2", "ttyUSB0", "A6008isP");
    const Rules rules;
    rules.bind({tracker}, "ttyUSB0", "tracker");
    ASK(verdict, rules.path(), {tracker}, all_paths(tracker));
    CHECK_FALSE(verdict->complains());
    CHECK(verdict->links == "/dev/nendo/tracker\n");
    CHECK(verdict->property(tracker.tty_path(), "TAGS").find(":uaccess:") != std::string::npos);
    CHECK(verdict->property(tracker.tty_path(), "ID_MM_PORT_IGNORE") == "1");
    CHECK(verdict->property(tracker.tty_path(), "ID_NENDO_GLOVE").empty());
    CHECK(verdict->mentions(tracker.serial_path(), "latency_timer' writing '1'"));
  }

  TEST_CASE("neighbours are left alone: a GPS and a modem on the same chip, an Arduino") {
    const auto glove = adapter("1-2", "ttyUSB0", "A6008isP");
    const auto gps = adapter("1-3", "ttyUSB1", "A6008isQ");
    const auto modem = adapter("1-4", "ttyUSB2", "");
    const PluggedDevice arduino{"1-5",      "2341",    "0043",    "Arduino", "Uno",
                                "A6008isP", "ttyACM0", "cdc_acm", "00"};
    const std::vector devices{glove, gps, modem, arduino};
    const Rules rules;
    rules.bind(devices, "ttyUSB0", "left");
    std::vector<std::string> paths;
    for (const PluggedDevice& device : {gps, modem, arduino}) {
      for (const std::string& path : all_paths(device))
        paths.push_back(path);
    }
    ASK(verdict, rules.path(), devices, paths);
    CHECK(verdict->links.empty());
    for (const std::string& path : paths) {
      REQUIRE(verdict->property(path, "ACTION") == "add"); // udev saw it
      for (const char* const trace :
           {"ID_NENDO", "ID_MM", "uaccess:", "latency_timer'", "GROUP ", "MODE "})
        CHECK_MESSAGE(!verdict->mentions(path, trace), path << ": " << trace);
    }
  }

  TEST_CASE("of two ports of an adapter only the bound one is a glove's") {
    auto first = adapter("1-2", "ttyUSB0", "A1");
    auto second = adapter("1-2", "ttyUSB1", "A1");
    second.interface_number = "01";
    const Rules rules;
    rules.bind({first, second}, "ttyUSB1", "right");
    ASK(verdict, rules.path(), {first, second},
        {first.tty_path(), second.tty_path(), first.usb_path()});
    CHECK(verdict->links == "/dev/nendo/right\n");
    CHECK(verdict->property(first.tty_path(), "ID_NENDO_GLOVE").empty());
    CHECK(verdict->property(second.tty_path(), "ID_NENDO_GLOVE") == "1");
    CHECK(verdict->property(first.usb_path(), "ID_MM_DEVICE_IGNORE").empty());
  }

  TEST_CASE("gloves with USB numbers of their own are granted, and told by their name") {
    const PluggedDevice p5{"1-2", "0d7f", "0100", "Essential Reality", "P5", "", "", "", ""};
    const PluggedDevice ultra{"1-3", "5d70", "0017", "5DT", "Glove", "", "", "", ""};
    const PluggedDevice stranger{"1-4", "5d70", "0004", "5DT", "Other", "", "", "", ""};
    const Rules rules;
    ASK(verdict, rules.path(), {p5, ultra, stranger},
        {p5.usb_path(), ultra.usb_path(), stranger.usb_path()});
    CHECK(verdict->property(p5.usb_path(), "ID_NENDO_MODEL") == "Essential Reality P5");
    CHECK(verdict->property(ultra.usb_path(), "ID_NENDO_MODEL") == "5DT Data Glove Ultra");
    for (const PluggedDevice& glove : {p5, ultra})
      CHECK(verdict->property(glove.usb_path(), "TAGS").find(":uaccess:") != std::string::npos);
    CHECK_FALSE(verdict->mentions(stranger.usb_path(), "NENDO"));
  }

  TEST_CASE("what calls itself a CyberGlove gets a link by its serial number, inside the folder") {
    auto glove = adapter("1-2", "ttyUSB0", "CG3-0815");
    glove.product = "cyberGLOVE III";
    auto escaping = adapter("1-3", "ttyUSB1", "../../ttyUSBfake");
    auto splitting = adapter("1-4", "ttyUSB2", "x sda ../sdb");
    escaping.manufacturer = splitting.manufacturer = "CyberGlove Systems";
    const Rules rules;
    ASK(verdict, rules.path(), {glove, escaping, splitting},
        {glove.tty_path(), escaping.tty_path(), splitting.tty_path()});
    CHECK(verdict->links == "/dev/nendo/glove-CG3-0815\n");
    CHECK(verdict->property(escaping.tty_path(), "ID_NENDO_GLOVE") == "1");
  }

  TEST_CASE("the events of SpaceMice are granted, and those of other devices are not") {
    const std::string usb = "/devices/pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0/0003:046D:C626.0001";
    const std::string bluetooth = "/devices/virtual/misc/uhid/0005:256F:C63A.0002";
    const PluggedInput navigator{usb, "5", "046d", "c626", "3f"}; // REL_ axes
    const PluggedInput wireless{bluetooth, "6", "256f", "c63a", "0", "3f"};
    const PluggedInput its_maker_s_keyboard{bluetooth, "7", "256f", "c664", "0", "100000000"};
    const PluggedInput its_maker_s_mouse{bluetooth, "8", "256f", "c654", "1943"};
    const PluggedInput another_mouse{usb, "9", "046d", "c077", "143"};
    const PluggedInput another_joystick{usb, "10", "046d", "c215", "0", "3f"};
    const std::vector inputs{navigator,         wireless,      its_maker_s_keyboard,
                             its_maker_s_mouse, another_mouse, another_joystick};
    std::vector<std::string> paths;
    for (const PluggedInput& input : inputs) {
      paths.push_back(input.event_path());
      paths.push_back(input.input_path());
    }
    const Rules rules;
    ASK(verdict, rules.path(), inputs, paths);
    CHECK_FALSE(verdict->complains());
    for (const PluggedInput& input : {navigator, wireless}) {
      const std::string path = input.event_path();
      CHECK(verdict->property(path, "TAGS").find(":uaccess:") != std::string::npos);
      CHECK(verdict->property(path, "ID_NENDO_GLOVE").empty());
      CHECK_FALSE(verdict->mentions(path, "GROUP ")); // a display server may need its own
      CHECK_FALSE(verdict->mentions(input.input_path(), "NENDO"));
    }
    for (const PluggedInput& input :
         {its_maker_s_keyboard, its_maker_s_mouse, another_mouse, another_joystick}) {
      REQUIRE(verdict->property(input.event_path(), "ACTION") == "add"); // udev saw it
      for (const char* const trace : {"ID_NENDO", "uaccess:"})
        CHECK_MESSAGE(!verdict->mentions(input.event_path(), trace), input.number);
    }
  }

  TEST_CASE("the control: a bad rule is noticed") {
    const TemporaryFolder folder;
    const auto device = adapter("1-2", "ttyUSB0", "A1");
    write_file(folder.path() / "60-bad.rules", "SUBSYSTEM==\"tty\", FOO==\"x\", MODE=\"0660\"\n");
    ASK(verdict, folder.path(), {device}, {device.tty_path()});
    CHECK(verdict->complains());
  }
}

} // namespace udev_rules_test
