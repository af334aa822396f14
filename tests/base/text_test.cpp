#include <nendo/base/text.hpp>

#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

namespace text_test {

using namespace nendo;

TEST_SUITE("base/text") {
  TEST_CASE("lines come without blanks, empty ones not at all, with their numbers") {
    LineReader lines(" one \r\n\n\t\ntwo");
    CHECK(lines.next() == "one");
    CHECK(lines.line() == 1);
    CHECK(lines.next() == "two");
    CHECK(lines.line() == 4);
    CHECK_FALSE(lines.next());
    CHECK_FALSE(LineReader("").next());
  }

  TEST_CASE("lines are the same whichever way they end, and with a mark of their bytes' order") {
    for (const std::string_view text :
         {"one\n\ntwo\nthree", "one\r\n\r\ntwo\r\nthree\r\n", "one\r\rtwo\rthree\r",
          "one\r\n\rtwo\nthree\r\n", "\xEF\xBB\xBFone\n\ntwo\nthree\n"}) {
      CAPTURE(text);
      LineReader lines(text);
      CHECK(lines.next() == "one");
      CHECK(lines.line() == 1);
      CHECK(lines.next() == "two");
      CHECK(lines.line() == 3);
      CHECK(lines.next() == "three");
      CHECK(lines.line() == 4);
      CHECK_FALSE(lines.next());
    }
    CHECK(without_mark("\xEF\xBB\xBF").empty());
    CHECK(without_mark("\xEF\xBB") == "\xEF\xBB");
    CHECK(without_mark("x\xEF\xBB\xBF").size() == 4); // it marks only the beginning
  }

  TEST_CASE("a part is cut off once, fields as often as asked") {
    std::string_view rest = "a,b,,c";
    CHECK(cut(rest, ',') == "a");
    CHECK(cut(rest, ',') == "b");
    CHECK(cut(rest, ',').empty());
    CHECK(cut(rest, ',') == "c");
    CHECK(rest.empty());
    CHECK(cut(rest, ',').empty());
    CHECK(fields_of("  x\ty  z ", 2).size() == 2);
    CHECK(fields_of(" \r").empty());
  }

  TEST_CASE("items are divided by single separators, and an empty text is one item") {
    const auto items_of = [](std::string_view text) {
      std::vector<std::string> items;
      for (ItemReader reader(text, ','); !reader.has_ended();)
        items.emplace_back(reader.next());
      return items;
    };
    using Items = std::vector<std::string>;
    CHECK(items_of("a,b") == Items{"a", "b"});
    CHECK(items_of("a") == Items{"a"});
    CHECK(items_of("") == Items{""});
    CHECK(items_of(",a,,") == Items{"", "a", "", ""});
    ItemReader reader("a", ',');
    CHECK(reader.next() == "a");
    CHECK(reader.next().empty());
  }

  TEST_CASE("a number is the whole field") {
    CHECK(to_number("+1.5e3") == 1500.0);
    CHECK(to_number("inf"));
    CHECK_FALSE(to_finite_number("inf"));
    CHECK_FALSE(to_finite_number("nan"));
    for (const char* text : {"", "+", "+-1", "1x", " 1", "1,5", "0x10"}) {
      CAPTURE(text);
      CHECK_FALSE(to_number(text));
      CHECK_FALSE(to_integer(text));
    }
    CHECK(to_integer("-7") == -7);
    CHECK_FALSE(to_integer("7.0"));
    CHECK_FALSE(to_integer("99999999999999999999"));
  }

  TEST_CASE("decimals read back the same, and as a float of TOML") {
    for (const double value : {0.0, 1.0, -2.5, 0.1, 1e300, 5e-324}) {
      CHECK(to_number(decimal_text(value)) == value);
      CHECK(decimal_text(value).find_first_of(".e") != std::string::npos);
    }
    CHECK(decimal_text(1.0) == "1.0");
  }

  TEST_CASE("what is shown is printable and short") {
    CHECK(printable("a\x1b[2J\x7f\xff") == "a?[2J??");
    CHECK(in_quotes("a\nb") == "'a?b'");
    CHECK(in_quotes(std::string(41, 'x')) == "'" + std::string(40, 'x') + "...'");
    const Error error = bad_line("file", 3, "is bad");
    CHECK(error.code == Errc::bad_input);
    CHECK(error.message == "file:3: is bad");
  }

  TEST_CASE("UTF-8 has one form for each character") {
    CHECK(is_utf8("plain, \xC3\xA9, \xE2\x82\xAC, \xF0\x9F\x98\x80"));
    for (const char* text :
         {"\x80", "\xC0\x80", "\xC1\xBF", "\xC3", "\xE0\x80\x80", "\xED\xA0\x80",
          "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xE2\x82"})
      CHECK_FALSE(is_utf8(text));
  }
}

} // namespace text_test
