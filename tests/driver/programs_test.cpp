// Who holds a device, from the kernel's strings, and what the table of devices says of it.

#include <algorithm>
#include <string>

#include <doctest/doctest.h>
#include <sys/file.h>
#include <unistd.h>

#include <nendo/udev/device_table.hpp>

#include "discovery/programs.hpp"
#include "fivedt_usb/fivedt_usb_parser.hpp"
#include "support/scripted_port.hpp"
#include "support/temporary_folder.hpp"
#include "transport/port_access.hpp"
#include "transport/sysfs.hpp"
#include "usb/usb_glove.hpp"

namespace programs_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;

namespace {

bool holds(const Holders& holders, const std::string& device, int pid) {
  const auto found = holders.of.find(device);
  return found != holders.of.end() &&
         std::any_of(found->second.begin(), found->second.end(),
                     [&](const DeviceHolder& holder) { return holder.pid == pid; });
}

} // namespace

TEST_SUITE("programs") {
  TEST_CASE("a program that holds a terminal is found, once, by number and name") {
    ScriptedPort port; // holds its own terminal
    const int again = ::open(port.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    Holders holders = find_holders({port.path(), "/dev/nothing"});
    REQUIRE(holders.of[port.path()].size() == 1);
    CHECK(holders.of[port.path()][0].pid == ::getpid());
    CHECK(holders.of[port.path()][0].name == read_line("/proc/self/comm"));
    CHECK(holders.of["/dev/nothing"].empty());
    ::close(again);
    port.unplug();
    CHECK_FALSE(holds(find_holders({port.path()}), port.path(), ::getpid()));
  }

  TEST_CASE("a lock shows who holds a file under another name") {
    const TemporaryFolder folder;
    const std::string name = (folder.path() / "port").string();
    const std::string other_name = (folder.path() / "other").string();
    const int file = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    REQUIRE(::link(name.c_str(), other_name.c_str()) == 0);
    CHECK_FALSE(holds(find_holders({other_name}), other_name, ::getpid()));
    REQUIRE(::flock(file, LOCK_EX | LOCK_NB) == 0);
    // A kernel that does not list its locks is no fault of the program.
    const bool listed = !parse_locks(read_text("/proc/locks")).empty();
    CHECK(holds(find_holders({other_name}), other_name, ::getpid()) == listed);
    ::close(file);
  }

  TEST_CASE("the kernel's list of locks is read line by line, and nonsense left out") {
    const auto locks = parse_locks("1: POSIX  ADVISORY  READ 811 08:01:131 128 128\n"
                                   "2: FLOCK  ADVISORY  WRITE 1234 00:06:1059 0 EOF\n"
                                   "2: -> FLOCK  ADVISORY  WRITE 99 00:06:1059 0 EOF\n"
                                   "3: FLOCK ADVISORY WRITE -1 fd:1a:18446744073709551615 0 EOF\n"
                                   "4: FLOCK ADVISORY WRITE 7 00-06-1059 0 EOF\n"
                                   "5: FLOCK ADVISORY WRITE 99999999999999 00:06:1 0 EOF\n"
                                   "\n\x01\xFF garbage\n6: FLOCK ADVISORY WRITE 7 00:06");
    REQUIRE(locks.size() == 3);
    CHECK(locks[0] == FileLock{811, 8, 1, 131});
    CHECK(locks[1] == FileLock{1234, 0, 6, 1059});
    CHECK(locks[2] == FileLock{-1, 0xFD, 0x1A, 18446744073709551615U});
    CHECK(parse_locks("").empty());
  }

  TEST_CASE("USB numbers identify gloves and adapters") {
    CHECK(udev::usb_glove_name({0x0D7F, 0x0100}) == "Essential Reality P5");
    CHECK(udev::usb_glove_name({0x0D7F, 0x0101}).empty());
    // The table has the numbers that the driver can read a model from, and no others.
    for (unsigned product = 0; product <= 0xFFFF; ++product) {
      const auto number = static_cast<std::uint16_t>(product);
      if (udev::usb_glove_name({0x5D70, number}).empty() ==
          fivedt_usb::model_of(number).has_value())
        FAIL("5d70:" << product);
    }
    CHECK(udev::usb_glove_name({0x5D70, 0x0017}) == "5DT Data Glove Ultra");
    CHECK(udev::usb_glove_name({0x0403, 0x6001}).empty());
    REQUIRE(udev::find_usb_adapter({0x0403, 0x6001}) != nullptr);
    CHECK(udev::find_usb_adapter({0x0403, 0x6001})->module == "ftdi_sio");
    CHECK(udev::find_usb_adapter({0x0403, 0x6002}) == nullptr);
    CHECK(to_string(udev::UsbId{0x0D7F, 0x0100}) == "0d7f:0100");
  }

  TEST_CASE("files of /sys that are missing, long or no numbers give nothing") {
    const TemporaryFolder folder;
    const auto file = folder.path() / "attribute";
    CHECK(read_line(file).empty());
    CHECK_FALSE(read_number(file));
    CHECK(read_line(folder.path()).empty());
    CHECK(names_in(file).empty());
    const auto read_as_number = [&](const std::string& text, int base) {
      std::FILE* const out = std::fopen(file.c_str(), "w");
      std::fwrite(text.data(), 1, text.size(), out);
      std::fclose(out);
      return read_number(file, base);
    };
    CHECK(read_as_number("16\n", 10) == 16U);
    CHECK(read_as_number("0D7f", 16) == 0x0D7FU);
    for (const std::string bad : {"", "\n", "-1\n", "1 2\n", "16x\n", "99999999999\n"})
      CHECK_FALSE(read_as_number(bad, 10));
    CHECK_FALSE(read_as_number(std::string(1'000'000, '1'), 10));
    CHECK(printable("a\x1b[2J\x7F\xFF") == "a?[2J??");
    CHECK(printable(std::string(1000, 'x')).size() == 128);
  }

  TEST_CASE("who may open a node is reported") {
    const TemporaryFolder folder;
    const auto file = (folder.path() / "node").string();
    CHECK_FALSE(port_access(file).granted);
    CHECK(port_access(file).who.empty());
    ::close(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
    CHECK(port_access(file).granted);
    CHECK(port_access(file).remedy.empty());
  }
}

} // namespace programs_test
