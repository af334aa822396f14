// What the doctor reads from a machine's files, and makes of it. The machines are folders.

#include <algorithm>

#include <doctest/doctest.h>

#include <nendo/udev/rules.hpp>

#include "doctor/doctor.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace doctor_machine_test {

using namespace nendo::doctor;
using nendo::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

/// A machine on which all is well, until something is written over.
class Machine {
public:
  Machine() {
    limits("99", "unlimited");
    write("proc/self/status", "Name:\tnendo\nCapEff:\t0000000000000000\n");
    write("proc/timer_list", "Timer List Version: v0.8\ncpu: 0\n  .hres_active    : 1\n");
    for (const char* const cpu : {"cpu0", "cpu1"})
      governor(cpu, "performance");
    fs::create_directories(folder_.path() / "run/udev");
    for (const auto& file : nendo::udev::shipped_rules())
      write("usr/lib/udev/rules.d/" + std::string(file.name), file.text);
  }
  void write(const std::string& name, const std::string& text) const {
    const fs::path path = folder_.path() / name;
    fs::create_directories(path.parent_path());
    nendo::test::write_file(path, text);
  }
  void remove(const std::string& name) const { fs::remove_all(folder_.path() / name); }
  void limits(const std::string& priority, const std::string& memory) const {
    write("proc/self/limits",
          "Limit                     Soft Limit           Hard Limit           Units     \n"
          "Max locked memory         " +
              memory + "                 unlimited            bytes     \n" +
              "Max realtime priority     " + priority + "                    99      \n");
  }
  void governor(const std::string& cpu, const std::string& name) const {
    write("sys/devices/system/cpu/" + cpu + "/cpufreq/scaling_governor", name + "\n");
  }
  std::vector<Finding> examine() const { return diagnose_machine(read_machine(folder_.path())); }
  /// Its only finding.
  Finding finding(const std::string& check) const {
    const auto found = examine();
    REQUIRE(found.size() == 1);
    CHECK(found[0].check == check);
    CHECK(found[0].severity == Severity::warning);
    CHECK_FALSE(found[0].what.empty());
    CHECK_FALSE(found[0].remedy.empty());
    return found[0];
  }

private:
  TemporaryFolder folder_;
};

} // namespace

TEST_SUITE("doctor") {
  TEST_CASE("of a machine that may be punctual and has the rules nothing is said") {
    CHECK(Machine().examine().empty());
  }

  TEST_CASE("a machine that says nothing of itself has no findings") {
    const TemporaryFolder empty;
    CHECK(diagnose_machine(read_machine(empty.path())).empty());
    CHECK(diagnose_machine({}).empty());
  }

  TEST_CASE("a missing real-time limit is named, unless a capability overrides it") {
    const Machine machine;
    machine.limits("0", "unlimited");
    CHECK(machine.finding("realtime").remedy.find("rtprio") != std::string::npos);
    machine.write("etc/security/limits.d/nendo.conf", "@audio - rtprio 99\n");
    const auto joined = machine.finding("realtime");
    CHECK(joined.remedy.find("tee") == std::string::npos); // the file is there: only the group
    CHECK(joined.remedy.find("usermod -aG audio") != std::string::npos);
    machine.write("proc/self/status", "CapEff:\t0000000000800000\n"); // CAP_SYS_NICE is 23
    CHECK(machine.examine().empty());
    machine.write("proc/self/status", "CapEff:\t000001ffff7fffff\n"); // all but that
    machine.finding("realtime");
  }

  TEST_CASE("a limit of locked memory is named, unless a capability overrides it") {
    const Machine machine;
    machine.limits("99", "8388608");
    CHECK(machine.finding("memlock").what.find("8192 KiB") != std::string::npos);
    machine.write("proc/self/status", "CapEff:\t0000000000004000\n"); // CAP_IPC_LOCK is 14
    CHECK(machine.examine().empty());
  }

  TEST_CASE("CPUs that save power are counted") {
    const Machine machine;
    machine.governor("cpu1", "powersave");
    machine.governor("cpu2", "powersave");
    const auto found = machine.finding("governor");
    CHECK(found.what.find("powersave of 2 CPUs") != std::string::npos);
    CHECK(found.remedy.find("scaling_governor") != std::string::npos);
  }

  TEST_CASE("a kernel without high-resolution timers is named") {
    const Machine machine;
    machine.write("proc/timer_list", "cpu: 0\n  .hres_active    : 0\n");
    machine.finding("timers");
  }

  TEST_CASE("rules that are missing, of another version or hidden are named with their path") {
    const Machine machine;
    const std::string name = "usr/lib/udev/rules.d/61-nendo-uaccess.rules";
    machine.remove(name);
    CHECK(machine.finding("rules").remedy == "sudo nendo udev install");
    machine.write(name, "# Made by nendo: 0.0.1\n");
    CHECK(machine.finding("rules").subject.ends_with(name));
    CHECK(machine.finding("rules").what.find("another version") != std::string::npos);
    machine.write("etc/udev/rules.d/61-nendo-uaccess.rules", "# mine\n"); // hides the package's
    CHECK(machine.finding("rules").subject.find("/etc/") != std::string::npos);
    machine.remove("run/udev"); // no udev would read them
    CHECK(machine.examine().empty());
  }

  TEST_CASE("nonsense in the files is no finding and no crash") {
    const Machine machine;
    machine.limits("many", "-1");
    machine.write("proc/self/status", "CapEff:\tzz\n");
    machine.write("proc/timer_list", std::string(100'000, '\0') + "\xFF\n");
    CHECK(machine.examine().empty());
  }
}

} // namespace doctor_machine_test
