#include <nendo/base/table.hpp>

#include <string>
#include <vector>

#include <doctest/doctest.h>

namespace table_test {

using namespace nendo;

namespace {

/// The cells of all rows, those of a row joined by '|', or the message of an error.
std::vector<std::string> rows_of(TableReader& table, std::size_t columns) {
  std::vector<std::string> rows;
  for (;;) {
    const auto any = table.next();
    if (!any) rows.push_back(any.error().message);
    if (!any || !*any) return rows;
    std::string row;
    for (std::size_t at = 0; at < columns; ++at)
      row.append(at == 0 ? "" : "|").append(table.cell(at));
    rows.push_back(row);
  }
}

std::vector<std::string> rows_of(const std::string& text, std::vector<std::string> names) {
  TableReader table(text, "t");
  if (const auto fine = table.read_head("a,b"); !fine) return {fine.error().message};
  CHECK(table.names() == names);
  return rows_of(table, names.size());
}

using Rows = std::vector<std::string>;

} // namespace

TEST_SUITE("base/table") {
  TEST_CASE("the first line decides what separates cells") {
    const Rows two{"1|2", "3|4"};
    CHECK(rows_of("a,b\n1,2\n3,4\n", {"a", "b"}) == two);
    CHECK(rows_of("a;b\r\n1;2\r\n3;4", {"a", "b"}) == two);
    CHECK(rows_of("a\tb\r1\t2\r3\t4\r", {"a", "b"}) == two);
    CHECK(rows_of("  a  b\n 1 2 \n\t3\t4\n", {"a", "b"}) == two);
    CHECK(rows_of("a,\tb\n1,\t2\n3\t,4\n", {"a", "b"}) == two); // tabs that only align
    CHECK(rows_of("sep=;\na;b\n1;2\n3;4\n", {"a", "b"}) == two);
    CHECK(rows_of("\"a;x\",b\n1,2\n3,4\n", {"a;x", "b"}) == two);
    CHECK(rows_of("a\n1\n2\n", {"a"}) == Rows{"1", "2"});
    CHECK(rows_of("a;b\n0,5;1,5\n", {"a", "b"}) == Rows{"0,5|1,5"});
  }

  TEST_CASE("marks, comments, blank lines and empty cells at the end are passed over") {
    CHECK(rows_of("\xEF\xBB\xBF# note\n\n a , b ,\n\n1,2,\n # more\n,,\n3,4\n", {"a", "b"}) ==
          Rows{"1|2", "3|4"});
    CHECK(rows_of("a,b\n", {"a", "b"}).empty());
  }

  TEST_CASE("a cell in quotes may hold what separates, quotes and line ends") {
    CHECK(rows_of("a,b\n\"1,5\", \"x \"\"y\"\" z\" \n\"two\nlines\",4\n", {"a", "b"}) ==
          Rows{"1,5|x \"\"y\"\" z", "two\nlines|4"});
    CHECK(rows_of("a,b\n\"1\r\n2\",3\n4\n", {"a", "b"}) ==
          Rows{"1\r\n2|3", "t:4: has 1 cell where there are 2 columns; write one for each, "
                           "separated as in the first line"});
    CHECK(rows_of("a,b\n1,\"2\n3,4\n", {"a", "b"}) ==
          Rows{"t:2: column 2: a quote begins here and never ends; close it"});
    CHECK(rows_of("a,b\n1,\"2\"3\n", {"a", "b"}).front().starts_with("t:2: column 2: letters"));
    CHECK(rows_of("a b\n\"1\" \"2\"\n", {"a", "b"}) == Rows{"1|2"});
  }

  TEST_CASE("names are compared without case, blanks and brackets") {
    CHECK(TableReader::plain("  Time (s) ") == "time_s");
    CHECK(TableReader::plain("time [ms]") == "time_ms");
    CHECK(TableReader::plain("Index MCP") == "index_mcp");
    CHECK(TableReader::plain("index_mcp") == "index_mcp");
    CHECK(TableReader::plain(" - ").empty());
    CHECK(TableReader::plain("}\rTime\n(s)") == "time_s"); // of a cell in quotes
    TableReader table("B,note,A,A,,c\n", "t");
    REQUIRE(table.read_head("a,b"));
    CHECK(table.find("b") == 0);
    CHECK(table.find("a") == 2);
    CHECK_FALSE(table.find("d"));
    CHECK(table.is_double("a"));
    CHECK_FALSE(table.is_double("b"));
    CHECK(table.columns_not_read() == "note, a, column 5, c");
    std::string many = "a";
    for (int k = 0; k < 12; ++k)
      many += ",n" + std::to_string(k);
    TableReader wide(many, "t");
    REQUIRE(wide.read_head("a"));
    CHECK(wide.find("a"));
    CHECK(wide.columns_not_read() == "n0, n1, n2, n3, n4, n5, n6, n7 and 4 more");
  }

  TEST_CASE("the head may be a comment, as numpy writes it, but not numbers") {
    CHECK(rows_of("# a b\n1.0 2.0\n3.0 4.0\n", {"a", "b"}) == Rows{"1.0|2.0", "3.0|4.0"});
    CHECK(rows_of("# a;b\n1,5;2\n", {"a", "b"}) == Rows{"1,5|2"});
    for (const char* text : {"1,2\n3,4\n", "# a\n1,2\n", "# 5,6\n1,2\n", "1,5;nan\n"})
      CHECK(rows_of(text, {}).front().find(": has numbers where the names") != std::string::npos);
    CHECK(rows_of("", {}).front() == "t: is empty; name the columns in the first line, like a,b");
    CHECK(rows_of("# a\n\n", {}).front().starts_with("t: is empty"));
  }

  TEST_CASE("a table without names") {
    const auto read = [](const std::string& text) {
      TableReader table(text, "t");
      REQUIRE(table.begin_without_head(3));
      return rows_of(table, 3);
    };
    const Rows two{"1|2|3", "4|5|6"};
    CHECK(read("1,2,3\n4,5,6\n") == two);
    CHECK(read("1 2 3\n4 5\t6\n") == two);
    CHECK(read("1 2, 3\n4, 5 6\n") == two); // two kinds
    CHECK(read("x;y;z\n1;2;3\n4;5;6;\n") == two);
    CHECK(read("0,5;1;2\n") == Rows{"0,5|1|2"});
    CHECK(read("").empty());
    CHECK(read("one two\n1 2 3\n").front().starts_with("t:1: has 2 cells"));
    CHECK(read("1 2 3\nx y z\n").size() == 2);
  }

  TEST_CASE("numbers have a point or a decimal comma, or are missing") {
    TableReader table("a;b;c;d\n-0,25; 1e3 ;NaN;\n1.234,5;1,2,3;inf;N/A\n+7;0x1; 5 ;null\n", "t");
    REQUIRE(table.read_head("a"));
    REQUIRE(*table.next());
    CHECK(table.number(0) == -0.25);
    CHECK(table.number(1) == 1000.0);
    CHECK_FALSE(table.number(2));
    CHECK(table.is_missing(2));
    CHECK(table.is_missing(3));
    CHECK_FALSE(table.is_missing(0));
    REQUIRE(*table.next());
    CHECK_FALSE(table.number(0));
    CHECK_FALSE(table.number(1));
    CHECK_FALSE(table.number(2));
    CHECK_FALSE(table.is_missing(2));
    CHECK(table.bad_cell(0, "is no number").message == "t:3: column 1 (a): '1.234,5' is no number");
    REQUIRE(*table.next());
    CHECK(table.number(0) == 7.0);
    CHECK_FALSE(table.number(1));
    CHECK(table.number(2) == 5.0);
  }

  TEST_CASE("scaled numbers are exact where a double is not") {
    const auto scaled = [](const std::string& cell, int digits) {
      const std::string text = "a;b\n" + cell + ";1\n";
      TableReader table(text, "t");
      REQUIRE(table.read_head("a"));
      REQUIRE(*table.next());
      return table.scaled(0, digits, 4.5e9);
    };
    CHECK(scaled("1700000000.0111", 9) == 1'700'000'000'011'100'000);
    CHECK(scaled("1700000000,0111", 9) == 1'700'000'000'011'100'000);
    CHECK(scaled("-0.0000000015", 9) == -2);
    CHECK(scaled("0.00000000149999", 9) == 1);
    CHECK(scaled("+12", 3) == 12'000);
    CHECK(scaled(".5", 0) == 1);
    CHECK(scaled("0.4", 0) == 0);
    CHECK(scaled("1.7e9", 9) == 1'700'000'000'000'000'000);
    CHECK_FALSE(scaled("4.6e9", 9));
    CHECK_FALSE(scaled("nan", 9));
    CHECK_FALSE(scaled("1.2.3", 9));
    CHECK_FALSE(scaled("", 9));
  }

  TEST_CASE("what is no text is named") {
    using namespace std::string_literals;
    const auto complaint = [](const std::string& text) {
      TableReader table(text, "t");
      const auto fine = table.read_head("a");
      REQUIRE_FALSE(fine);
      CHECK_FALSE(TableReader(text, "t").begin_without_head(2));
      return fine.error().message;
    };
    CHECK(complaint("\xFF\xFE"s + "a\0,\0"s) == "t: is UTF-16; save it as CSV in UTF-8");
    CHECK(complaint("PK\x03\x04rest").find("spreadsheet") != std::string::npos);
    CHECK(complaint("\x1F\x8B\x08").find("gzip") != std::string::npos);
  }
}

} // namespace table_test
