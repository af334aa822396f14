// What find_devices() says of emulated machines.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <doctest/doctest.h>

#include <nendo/driver/devices.hpp>
#include <nendo/driver/open_glove.hpp>

#include "support/mocked_machine.hpp"
#include "support/temporary_folder.hpp"
#include "transport/port_access.hpp"
#include "transport/serial_ports.hpp"

namespace discovery_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

const DeviceCandidate& at(const std::vector<DeviceCandidate>& found, std::string_view device) {
  const auto candidate = std::find_if(found.begin(), found.end(),
                                      [&](const DeviceCandidate& c) { return c.device == device; });
  REQUIRE_MESSAGE(candidate != found.end(), device);
  return *candidate;
}

MockedUsb second_adapter() {
  MockedUsb usb;
  usb.port = "ttyUSB1";
  usb.place = "1-3";
  usb.address = 6;
  usb.serial = "A2";
  return usb;
}

} // namespace

TEST_SUITE("discovery") {
  TEST_CASE("two adapters of one kind are two entries, distinguished by their serial numbers") {
    MockedMachine machine;
    machine.plug({});
    machine.plug(second_adapter());
    const auto found = find_devices();
    REQUIRE(found.size() == 2);
    REQUIRE(found[0].usb);
    CHECK(found[0].device == "/dev/ttyUSB0");
    CHECK(found[0].kind == DeviceKind::serial_port);
    CHECK(found[0].usb->serial == "A1");
    CHECK(found[0].usb->vendor_id == 0x0403);
    CHECK(found[0].usb->product_id == 0x6001);
    CHECK(found[0].usb->place == "1-2");
    CHECK(found[0].usb->interface_number == 0);
    CHECK(found[0].description == "FTDI FT232R USB UART (serial number A1)");
    CHECK(found[0].latency_timer == 16ms);
    CHECK(found[0].may_open);
    CHECK(found[0].access == "you");
    REQUIRE(found[1].usb);
    CHECK(found[1].usb->serial == "A2");
    CHECK(found[1].usb->address == 6);
    CHECK(machine.modem_lines == 0); // none was opened
  }

  TEST_CASE("of several links the one that survives longest becomes the specification") {
    MockedMachine machine;
    machine.plug({});
    CHECK(find_devices().at(0).spec == "serial:/dev/ttyUSB0");
    machine.link("serial/by-path/pci-0000:00:14.0-usb-0:2:1.0-port0", "ttyUSB0");
    CHECK(find_devices().at(0).spec ==
          "serial:/dev/serial/by-path/pci-0000:00:14.0-usb-0:2:1.0-port0");
    machine.link("serial/by-id/usb-FTDI_A1-if00-port0", "ttyUSB0");
    CHECK(find_devices().at(0).spec == "serial:/dev/serial/by-id/usb-FTDI_A1-if00-port0");
    CHECK_FALSE(find_devices().at(0).identified);
    machine.link("nendo/right", "ttyUSB0");
    const auto found = find_devices();
    CHECK(found.at(0).spec == "serial:/dev/nendo/right");
    CHECK(found.at(0).stable_name == "/dev/nendo/right");
    CHECK(found.at(0).identified);
  }

  TEST_CASE("a port that is bound to a tracker is identified, and is no glove's") {
    MockedMachine machine;
    machine.plug({});
    machine.plug(second_adapter());
    machine.link("nendo/tracker", "ttyUSB1");
    const auto found = find_devices();
    REQUIRE(found.size() == 2);
    CHECK(found[0].device == "/dev/ttyUSB1");
    CHECK(found[0].identified);
    CHECK(found[0].spec.empty());
    CHECK(found[0].stable_name == "/dev/nendo/tracker");
    CHECK_FALSE(found[1].identified);
  }

  TEST_CASE("adapters without a serial number of their own are named by their place") {
    MockedMachine machine;
    MockedUsb first;
    MockedUsb second = second_adapter();
    SUBCASE("because they have none") {
      first.serial = second.serial = "";
    }
    SUBCASE("because their maker gave both the same") {
      first.serial = second.serial = "0001";
    }
    machine.plug(first);
    machine.plug(second);
    machine.link("serial/by-id/usb-FTDI_FT232R", "ttyUSB1");
    machine.link("serial/by-path/usb-0:2:1.0", "ttyUSB0");
    machine.link("serial/by-path/usb-0:3:1.0", "ttyUSB1");
    const auto found = find_devices();
    CHECK(at(found, "/dev/ttyUSB0").spec == "serial:/dev/serial/by-path/usb-0:2:1.0");
    CHECK(at(found, "/dev/ttyUSB1").spec == "serial:/dev/serial/by-path/usb-0:3:1.0");
  }

  TEST_CASE("a link whose name a specification cannot express is not used") {
    MockedMachine machine;
    machine.plug({});
    machine.link("serial/by-id/what?is=this", "ttyUSB0");
    machine.link("serial/by-path/a\nb", "ttyUSB0");
    CHECK(find_devices().at(0).spec == "serial:/dev/ttyUSB0");
  }

  TEST_CASE("neighbours are listed and never identified") {
    MockedMachine machine;
    MockedUsb neighbour;
    SUBCASE("an Arduino") {
      neighbour.port = "ttyACM0";
      neighbour.vendor_id = "2341";
      neighbour.product_id = "0043";
      neighbour.manufacturer = "Arduino (www.arduino.cc)";
      neighbour.product = "Uno R3";
      neighbour.driver = "cdc_acm";
    }
    SUBCASE("a GPS receiver") {
      neighbour.port = "ttyACM0";
      neighbour.vendor_id = "1546";
      neighbour.product_id = "01a7";
      neighbour.manufacturer = "u-blox AG";
      neighbour.product = "u-blox 7 - GPS/GNSS Receiver";
      neighbour.driver = "cdc_acm";
    }
    SUBCASE("a modem on a glove's chip") {
      neighbour.product = "US Robotics Modem";
    }
    SUBCASE("another device of a maker of gloves") {
      neighbour.manufacturer = "Immersion Corporation";
      neighbour.product = "MicroScribe";
    }
    SUBCASE("an adapter of whose chip nothing is known") {
      neighbour.vendor_id = "1234";
    }
    machine.plug(neighbour);
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].spec == "serial:/dev/" + neighbour.port);
    CHECK_FALSE(found[0].identified);
    CHECK(found[0].reason.starts_with("may be a glove: USB"));
    CHECK_FALSE(open_glove("auto"));
    CHECK(machine.modem_lines == 0);
  }

  TEST_CASE("what a device says of itself cannot reach a terminal's controls") {
    MockedMachine machine;
    machine.plug({});
    machine.write("/sys/devices/pci0000:00/0000:00:14.0/usb1/1-2/product",
                  "CyberGlove\x1b[2J\xC2\x9B\n" + std::string(100'000, 'x'));
    machine.write("/sys/devices/pci0000:00/0000:00:14.0/usb1/1-2/serial", "");
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].description == "FTDI CyberGlove?[2J??");
  }

  TEST_CASE("a Bluetooth port is not taken for the dongle that it hangs on") {
    MockedMachine machine;
    MockedUsb dongle;
    dongle.port = "rfcomm0";
    dongle.product = "CyberGlove look-alike dongle";
    dongle.driver = "btusb";
    machine.plug(dongle);
    const auto found = find_devices();
    const DeviceCandidate& port = at(found, "/dev/rfcomm0");
    CHECK_FALSE(port.usb);
    CHECK_FALSE(port.identified);
    CHECK(port.reason == "may be a glove: Bluetooth serial port");
  }

  TEST_CASE("a USB glove is identified, with the specification that opens it") {
    MockedMachine machine;
    MockedUsb glove;
    glove.port = "";
    SUBCASE("P5") {
      glove.vendor_id = "0d7f";
      glove.product_id = "0100";
    }
    SUBCASE("5DT, left, 5 sensors") {
      glove.vendor_id = "5d70";
      glove.product_id = "0011";
    }
    machine.plug(glove);
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].kind == DeviceKind::usb_glove);
    CHECK(found[0].device == "/dev/bus/usb/001/005");
    CHECK(found[0].spec == "usb:" + glove.vendor_id + ":" + glove.product_id);
    CHECK(found[0].identified);
    REQUIRE(found[0].usb);
    CHECK(found[0].usb->serial == "A1");
  }

  TEST_CASE("an adapter without a port is listed, and other USB devices are not") {
    MockedMachine machine;
    MockedUsb adapter;
    adapter.port = "";
    machine.plug(adapter);
    MockedUsb keyboard = second_adapter();
    keyboard.port = "";
    keyboard.vendor_id = "046d";
    keyboard.product_id = "c31c";
    machine.plug(keyboard);
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].kind == DeviceKind::portless_adapter);
    CHECK(found[0].spec.empty());
    CHECK(found[0].remedy.find("modprobe ftdi_sio") != std::string::npos);
  }

  TEST_CASE("entries that lead nowhere are left out or listed without details") {
    MockedMachine machine;
    machine.plug({});
    std::filesystem::remove(machine.real("/dev/ttyUSB0"));
    machine.write("/sys/devices/pci0000:00/0000:00:14.0/usb1/1-2/idVendor", "nonsense\n");
    std::filesystem::create_symlink("../../nowhere", machine.real("/sys/class/tty/ttyUSB7"));
    const auto found = find_devices();
    const DeviceCandidate& port = at(found, "/dev/ttyUSB0");
    CHECK_FALSE(port.usb);
    CHECK_FALSE(port.may_open);
    CHECK(port.node_missing);
    CHECK(std::none_of(found.begin(), found.end(),
                       [](const auto& c) { return c.device == "/dev/ttyUSB7"; }));
  }

  TEST_CASE("a port without a node is reported, with how to pass it into a container") {
    MockedMachine machine;
    machine.plug({});
    CHECK_FALSE(at(find_devices(), "/dev/ttyUSB0").node_missing);
    std::filesystem::remove(machine.real("/dev/ttyUSB0"));
    const auto found = find_devices();
    const DeviceCandidate& port = at(found, "/dev/ttyUSB0");
    CHECK(port.node_missing);
    CHECK_FALSE(port.may_open);
    CHECK(port.access.empty());
    // Which way it names depends on the container in which the test itself runs, if any.
    CHECK(port.remedy == missing_node("/dev/ttyUSB0"));
    CHECK(port.remedy.find("/dev/ttyUSB0") != std::string::npos);
    const auto glove = open_glove("serial:/dev/ttyUSB0");
    REQUIRE_FALSE(glove);
    CHECK(glove.error().code == Errc::no_device);
    CHECK(glove.error().message.find("no node") != std::string::npos);
    CHECK(glove.error().message.find(port.remedy) != std::string::npos);
  }

  TEST_CASE("its maker's marks show the container, and then only its remedy is named") {
    MockedMachine machine;
    machine.plug({});
    CHECK_FALSE(missing_node("/dev/ttyUSB0")); // it is there
    CHECK_FALSE(missing_node("/dev/ttyUSB9")); // the kernel does not have it
    std::filesystem::remove(machine.real("/dev/ttyUSB0"));
    const TemporaryFolder root;
    const auto remedy = [&] { return missing_node("/dev/ttyUSB0", root.path()).value_or(""); };
    for (const char* way :
         {"docker run --device=/dev/ttyUSB0", "podman run --device=/dev/ttyUSB0",
          "systemd-nspawn --bind=/dev/ttyUSB0", "lxc-device", "mknod -m 660 /dev/ttyUSB0 c 188 0"})
      CHECK_MESSAGE(remedy().find(way) != std::string::npos, remedy());
    std::filesystem::create_directories(root.path() / "run/systemd");
    const auto marked = [&](const std::string& kind) {
      std::ofstream(root.path() / "run/systemd/container") << kind << '\n';
      return remedy();
    };
    CHECK(marked("lxc").find("lxc-device -n NAME add /dev/ttyUSB0") != std::string::npos);
    CHECK(marked("lxc").find("docker") == std::string::npos);
    CHECK(marked("systemd-nspawn").find("--bind=/dev/ttyUSB0") != std::string::npos);
    CHECK(marked("podman").find("podman run --device=/dev/ttyUSB0") != std::string::npos);
    std::ofstream(root.path() / ".dockerenv") << "";
    CHECK(remedy().find("docker run --device=/dev/ttyUSB0") != std::string::npos);
    CHECK(remedy().find("podman") == std::string::npos);
  }

  TEST_CASE("a port is left alone if a udev rule says so, by the port or the device") {
    MockedMachine machine;
    machine.plug({});
    const std::string file = MockedUsb().tty_path() + "/uevent";
    const std::string node = "MAJOR=188\nMINOR=0\nDEVNAME=ttyUSB0\n";
    CHECK_FALSE(find_devices().at(0).left_alone);
    for (const std::string property : {"ID_MM_DEVICE_IGNORE", "ID_MM_PORT_IGNORE"}) {
      machine.write(file, node + property + "=1\n");
      CHECK(find_devices().at(0).left_alone);
      machine.write(file, node + property + "=0\n");
      CHECK_FALSE(find_devices().at(0).left_alone);
    }
  }

  TEST_CASE("the latency timer of an FTDI adapter is read through any name, and set") {
    MockedMachine machine;
    machine.plug({});
    machine.link("nendo/right", "ttyUSB0");
    CHECK(ftdi_latency_timer("/dev/ttyUSB0") == 16ms);
    CHECK(ftdi_latency_timer("/dev/nendo/right") == 16ms);
    CHECK(shorten_ftdi_latency("/dev/nendo/right") == 1ms);
    CHECK(ftdi_latency_timer("/dev/ttyUSB0") == 1ms);
    CHECK_FALSE(ftdi_latency_timer("/dev/ttyUSB1"));
    CHECK_FALSE(ftdi_latency_timer("/dev/pts/0"));
    CHECK_FALSE(shorten_ftdi_latency("/dev/pts/0"));
    machine.write("/sys/bus/usb-serial/devices/ttyUSB0/latency_timer", "soon\n");
    CHECK_FALSE(ftdi_latency_timer("/dev/ttyUSB0"));
  }
}

} // namespace discovery_test
