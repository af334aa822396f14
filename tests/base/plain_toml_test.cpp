// What is not plain TOML is refused with its line before toml++ sees it.

#include <string>

#include <doctest/doctest.h>

#include <nendo/base/plain_toml.hpp>

namespace plain_toml_test {

using namespace nendo;

namespace {

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int at = 0; at < count; ++at)
    all += text;
  return all;
}

bool refuses(const std::string& text, std::size_t line, std::string_view with) {
  const auto fault = find_toml_fault(text);
  if (!fault) return false;
  INFO(fault->line << ": " << fault->what);
  CHECK(fault->line == line);
  CHECK(fault->what.find(with) != std::string::npos);
  return true;
}

} // namespace

TEST_SUITE("base/plain_toml") {
  TEST_CASE("what TOML 1.0 allows on one line, and lists over several, may be read") {
    for (const std::string text :
         {"", "\n", "# only a comment",
          "\xEF\xBB\xBF"
          "a = 1",
          "a = 1\r\nb = 2\r\n", "a = 1 # tail\nb='x#y'\n", "a.b . \"c d\".'e' = -1.5e+3",
          "x = [ # one\n 1,\n\n 2, ]\n", "x = []\ny = {}\n",
          "t = { a = [1, {b = 2}], c.d = \"]}\" }", "[ a . b ]\n[[c]]\n[[ c ]]",
          "s = \"\\\"\\\\\" # \"", "s = '\\'", "t = 2026-11-21T19:27:05Z",
          "t = [2026-11-21T19:27:05.25-01:30, inf, -nan, +1, 1E3]",
          "u = \"\xC3\xA9\" # \xC3\xA9"}) {
      CAPTURE(text);
      CHECK_FALSE(find_toml_fault(text));
    }
  }

  TEST_CASE("what stops toml++ is refused") {
    CHECK(refuses("a = 1\nb = # none", 2, "expected a value, and there is '#'"));
    CHECK(refuses("a =", 1, "the end of the file"));
    CHECK(refuses("a = \nb = 1", 1, "the end of the line"));
    CHECK(refuses("a = ]", 1, "expected a value"));
    CHECK(refuses("a = 2026-11-21T:7:32:00Z", 1, "'2026-11-21T:7:32:00Z' is no value"));
    for (const std::string word :
         {"+", "-", "1.", ".5", "1e", "1e+", "0x1F", "1_0", "tru", "infinity", "--1", "2026-11-21",
          "19:27:05", "2026-11-21T19:27:05X", "2026-11-21T19:27:05.Z", "2026-11-21T19:27:05+1:00",
          "2026-11-21T19:27:05Z0"}) {
      CAPTURE(word);
      CHECK(refuses("a = " + word, 1, "is no value"));
    }
    CHECK(refuses("a = [1,\n2,\n}]", 3, "expected a value"));
    CHECK(refuses("a = {,}", 1, "expected a key"));
    CHECK(refuses("[ ,]", 1, "expected a key"));
    CHECK(refuses("[]", 1, "expected a key"));
    CHECK(refuses("a = 1\n[[a]", 2, "expected ]"));
    CHECK(refuses("a.", 1, "expected a key"));
    CHECK(refuses("a = 1 b = 2", 1, "expected the end of the line"));
    CHECK(refuses("a = [1 2]", 1, "expected , or ]"));
    CHECK(refuses("a \xE2\x80\xA8= 1", 1, "expected = after a key"));
    CHECK(refuses("a\xC2\xA0= 1", 1, "expected = after a key"));
  }

  TEST_CASE("strings must be UTF-8 on one line, without control characters") {
    CHECK(refuses("a = 1\nb = \"x", 2, "no closing quote"));
    CHECK(refuses("a = \"x\\", 1, "no closing quote"));
    CHECK(refuses("a = \"x\ny\"", 1, "no closing quote"));
    CHECK_FALSE(find_toml_fault("a = '''x\n'y''z'''\nb = 1"));
    CHECK(refuses("a = '''x\ny", 2, "three quotes"));
    CHECK(refuses("a = '''x\n''''", 2, "four quotes"));
    CHECK(refuses("a = '''x\n\1'''", 2, "control character"));
    CHECK(refuses("'''a''' = 1", 1, "three quotes"));
    CHECK(refuses("a = \"\"\"x\"\"\"", 1, "three quotes"));
    CHECK(refuses("a = \"\xC3\"", 1, "not UTF-8"));
    CHECK(refuses("# \xED\xA0\x80", 1, "not UTF-8"));
    CHECK(refuses("a = \"\x1B[2J\"", 1, "control character"));
    CHECK(refuses(std::string("a = \"\0\"", 7), 1, "control character"));
    CHECK(refuses("a = 1\rb = 2", 1, "the end of the line"));
  }

  TEST_CASE("depth is bounded, and a file at the bound is plain") {
    const auto nested = [](int depth) {
      return "a = " + repeated("[", depth) + repeated("]", depth);
    };
    CHECK_FALSE(find_toml_fault(nested(max_toml_depth)));
    CHECK(refuses(nested(max_toml_depth + 1), 1, "more than 16 deep"));
    CHECK(refuses("a = " + repeated("[", 1000000), 1, "more than 16 deep"));
    CHECK(refuses("a = " + repeated("{b=", 1000000), 1, "more than 16 deep"));
    CHECK(refuses(repeated("[", 1000000), 1, "expected a key"));
    const auto key = [](int parts) { return "a" + repeated(".a", parts - 1) + " = 1"; };
    CHECK_FALSE(find_toml_fault(key(max_toml_depth)));
    CHECK(refuses(key(max_toml_depth + 1), 1, "more than 16 parts"));
    CHECK(refuses("[a" + repeated(".a", 1000000) + "]", 1, "more than 16 parts"));
  }
}

} // namespace plain_toml_test
