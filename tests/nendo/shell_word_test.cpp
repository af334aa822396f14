// Words that messages tell somebody to type, as a shell reads them.

#include "cli/shell_word.hpp"

#include <string>

#include <doctest/doctest.h>

#include "support/shell.hpp"

namespace shell_word_test {

using nendo::cli::shell_word;

TEST_SUITE("shell_word") {
  TEST_CASE("a shell reads back what was meant, and plain words stay as they are") {
    CHECK(shell_word("serial:/dev/ttyUSB0") == "serial:/dev/ttyUSB0");
    for (const std::string text : {"serial:/dev/ttyUSB0?rate=60&hand=left", "it's", "a b", "$HOME",
                                   "`ls`", "*", "'", "", "a\"b\\c", "x;y|z>(w)#"}) {
      CAPTURE(text);
      CHECK(nendo::test::shell("printf %s " + shell_word(text)).out == text);
    }
  }
}

} // namespace shell_word_test
