// What the doctor makes of a machine's facts, and what the command says of this one.

#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/driver/devices.hpp>

#include "doctor/doctor.hpp"
#include "support/program.hpp"

namespace doctor_command_test {

using namespace nendo::doctor;
using nendo::driver::DeviceCandidate;
using nendo::driver::DeviceKind;
using namespace std::chrono_literals;

namespace {

/// A port that nothing is wrong with.
DeviceCandidate good_adapter() {
  DeviceCandidate candidate;
  candidate.device = "/dev/ttyUSB0";
  candidate.spec = "serial:/dev/ttyUSB0";
  candidate.may_open = true;
  candidate.access = "you";
  candidate.usb.emplace();
  candidate.latency_timer = 1ms;
  candidate.left_alone = true;
  candidate.holders_complete = true;
  return candidate;
}

/// The only finding about a machine with these devices.
Finding only_finding_of(std::vector<DeviceCandidate> candidates) {
  const auto found = diagnose_ports({std::move(candidates), {}});
  REQUIRE(found.size() == 1);
  return found[0];
}
/// The only finding about a machine with this one device.
Finding only_finding(const DeviceCandidate& candidate, std::vector<std::string> grabbers = {}) {
  const auto found = diagnose_ports({{candidate}, std::move(grabbers)});
  REQUIRE(found.size() == 1);
  CHECK(found[0].subject == candidate.device);
  CHECK_FALSE(found[0].remedy.empty());
  return found[0];
}

} // namespace

TEST_SUITE("doctor") {
  TEST_CASE("of a machine on which all is well nothing is said") {
    CHECK(diagnose_ports({{good_adapter()}, {}}).empty());
    CHECK(diagnose_ports({{good_adapter()}, {"ModemManager"}}).empty()); // a rule keeps it off
  }

  TEST_CASE("a machine without ports is a warning, for simulated gloves need none") {
    const auto found = diagnose_ports({});
    REQUIRE(found.size() == 1);
    CHECK(found[0].severity == Severity::warning);
    CHECK(found[0].check == "presence");
  }

  TEST_CASE("a port that this user may not open is a failure, an on-board one a warning") {
    DeviceCandidate port = good_adapter();
    port.may_open = false;
    port.access = "group dialout";
    port.remedy = "sudo usermod -aG dialout $USER, then log in again";
    Finding finding = only_finding(port);
    CHECK(finding.severity == Severity::failure);
    CHECK(finding.check == "permission");
    CHECK(finding.what.find("group dialout") != std::string::npos);
    CHECK(finding.remedy == port.remedy);
    port.usb.reset();
    CHECK(only_finding(port).severity == Severity::warning);
    port.identified = true;
    CHECK(only_finding(port).severity == Severity::failure);
  }

  TEST_CASE("a port without a node is a failure, with a remedy") {
    DeviceCandidate candidate = good_adapter();
    candidate.may_open = false;
    candidate.access = "";
    candidate.node_missing = true;
    candidate.remedy = "pass it in";
    const Finding finding = only_finding(candidate);
    CHECK(finding.severity == Severity::failure);
    CHECK(finding.check == "node");
    CHECK(finding.remedy == "pass it in");
    candidate.usb.reset(); // one of the computer's own, which containers see as well
    CHECK(only_finding(candidate).severity == Severity::warning);
  }

  TEST_CASE("a port that vanished meanwhile is no finding") {
    DeviceCandidate port = good_adapter();
    port.may_open = false;
    port.access = "";
    CHECK(diagnose_ports({{port}, {}}).empty());
  }

  TEST_CASE("programs that open what they should not are named while an adapter is unmarked") {
    DeviceCandidate port = good_adapter();
    port.left_alone = false;
    CHECK(diagnose_ports({{port}, {}}).empty());
    for (const std::string program : {"ModemManager", "brltty"}) {
      const Finding finding = only_finding(port, {program});
      CHECK(finding.severity == Severity::warning);
      CHECK(finding.check == "grabber");
      CHECK(finding.what.starts_with(program));
      CHECK(finding.remedy.find(program) != std::string::npos);
    }
    port.usb.reset(); // an on-board port does not arrive, so no program takes it
    CHECK(diagnose_ports({{port}, {"ModemManager", "brltty"}}).empty());
  }

  TEST_CASE("a long latency timer is a warning with the command that shortens it") {
    DeviceCandidate port = good_adapter();
    port.latency_timer = 16ms;
    const Finding finding = only_finding(port);
    CHECK(finding.severity == Severity::warning);
    CHECK(finding.what.find("16 ms") != std::string::npos);
    CHECK(finding.remedy == "echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer");
  }

  TEST_CASE("a program that holds a port is named, and weighs more on a known glove") {
    DeviceCandidate port = good_adapter();
    port.holders = {{812, "gpsd"}};
    CHECK(only_finding(port).severity == Severity::warning);
    port.identified = true;
    const Finding finding = only_finding(port);
    CHECK(finding.severity == Severity::failure);
    CHECK(finding.what == "is held by gpsd (pid 812)");
    port.holders = {{0, "another user's program"}};
    CHECK(only_finding(port).what == "is held by another user's program");
  }

  TEST_CASE("an adapter without a port is a failure, and brltty's if that runs") {
    DeviceCandidate adapter = good_adapter();
    adapter.kind = DeviceKind::portless_adapter;
    adapter.device = "/dev/bus/usb/001/005";
    adapter.may_open = false;
    adapter.access = "root";
    adapter.remedy = "sudo modprobe ftdi_sio, then plug it in again";
    CHECK(only_finding(adapter).severity == Severity::failure);
    CHECK(only_finding(adapter).remedy == adapter.remedy);
    const Finding finding = only_finding(adapter, {"brltty"});
    CHECK(finding.check == "portless");
    CHECK(finding.remedy.find("brltty") != std::string::npos);
  }

  TEST_CASE(
      "a SpaceMouse that this user may not open is a warning, also if other programs read it") {
    DeviceCandidate mouse;
    mouse.kind = DeviceKind::input_device;
    mouse.device = "/dev/input/event5";
    mouse.identified = true;
    mouse.access = "group input";
    mouse.remedy = "sudo nendo udev install";
    mouse.usb.emplace();
    mouse.holders = {{812, "Xorg"}};
    const Finding finding = only_finding_of({good_adapter(), mouse});
    CHECK(finding.severity == Severity::warning);
    CHECK(finding.check == "permission");
    CHECK(finding.subject == mouse.device);
    CHECK(finding.remedy == mouse.remedy);
    mouse.may_open = true;
    CHECK(diagnose_ports({{good_adapter(), mouse}, {"ModemManager"}}).empty());
    CHECK(only_finding_of({mouse}).check == "presence"); // it replaces no glove
  }

  TEST_CASE("the command's exit code says whether something will not work") {
    const auto done = nendo::test::nendo({"doctor", "--json"});
    CHECK(done.err.empty());
    bool fails = false;
    for (const auto& line : nendo::test::lines_of(done.out)) {
      const auto finding = nlohmann::json::parse(line);
      fails |= finding["weight"] == "failure";
      for (const char* const key : {"check", "subject", "what", "remedy"})
        CHECK(finding[key].is_string());
    }
    CHECK(done.exit_code == (fails ? 1 : 0));
    const auto text = nendo::test::nendo({"doctor"});
    CHECK(text.exit_code == done.exit_code);
    // The examined subjects are always listed.
    const auto list = text.out.rfind("Checked: ");
    REQUIRE(list != std::string::npos);
    for (const char* const subject :
         {"programs that take ports", "real-time priority", "governors", "timers", "udev rules"})
      CHECK(text.out.find(subject, list) != std::string::npos);
    for (const auto& candidate : nendo::driver::find_devices()) {
      if (candidate.kind == DeviceKind::input_device && !candidate.identified) continue; // a mouse
      CHECK(text.out.find(candidate.device, list) != std::string::npos);
    }
    CHECK(done.out.find("Checked: ") == std::string::npos);
  }
}

} // namespace doctor_command_test
