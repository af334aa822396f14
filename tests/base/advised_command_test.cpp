// Commands in messages, as a shell reads them.

#include <nendo/base/advised_command.hpp>

#include <string>

#include <doctest/doctest.h>

#include "support/shell.hpp"

namespace advised_command_test {

using nendo::as_root;
using nendo::shell_word;

TEST_SUITE("advised_command") {
  TEST_CASE("a shell reads back what was meant, and plain words stay as they are") {
    CHECK(shell_word("serial:/dev/ttyUSB0") == "serial:/dev/ttyUSB0");
    for (const std::string text : {"serial:/dev/ttyUSB0?rate=60&hand=left", "it's", "a b", "$HOME",
                                   "`ls`", "*", "'", "", "a\"b\\c", "x;y|z>(w)#"}) {
      CAPTURE(text);
      CHECK(nendo::test::shell("printf %s " + shell_word(text)).out == text);
    }
  }

  TEST_CASE("sudo finds an installed nendo by its name, and one that was built by its path") {
    for (const std::string installed : {"/usr/bin/nendo", "/usr/local/bin/nendo"})
      CHECK(as_root("udev install", installed) == "sudo nendo udev install");
    CHECK(as_root("udev install", "/home/anna/nendo/build/release/bin/nendo") ==
          "sudo /home/anna/nendo/build/release/bin/nendo udev install");
    CHECK(as_root("udev install", "/home/anna/my work/nendo") ==
          "sudo '/home/anna/my work/nendo' udev install");
    CHECK(as_root("udev install", "/home/anna/sculptor") == "sudo nendo udev install"); // embeds it
    CHECK(as_root("udev install") == "sudo nendo udev install");
  }
}

} // namespace advised_command_test
