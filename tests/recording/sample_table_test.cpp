#include "sample_table.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/recording/replay_driver.hpp>

#include "support/required.hpp"
#include "support/temporary_folder.hpp"

namespace sample_table_test {

using namespace nendo;
using namespace nendo::recording;

namespace {

struct Table {
  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "take.csv";

  explicit Table(const std::string& text) { std::ofstream(path) << text; }
  Result<SampleTable> read(const TableWishes& wishes = {}) const {
    return read_sample_table(path, wishes);
  }
  std::string complaint(const TableWishes& wishes = {}) const {
    const auto table = read(wishes);
    REQUIRE_FALSE(table);
    CHECK(table.error().message.find(path.string()) != std::string::npos);
    CHECK(table.error().message.find('\n') == std::string::npos);
    return table.error().message;
  }
};

bool says(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

} // namespace

TEST_SUITE("sample_table") {
  TEST_CASE("columns are known by their names, whatever parts them and whatever else there is") {
    for (const char separator : {',', ';', '\t'}) {
      CAPTURE(separator);
      std::string text = "index_mcp_count,note,time_s,thumb_roll\r\n"
                         "12,first,100.25,7.6\r\n"
                         "\r\n"
                         ",second,100.5,\r\n"
                         "300,third,100.75,\"0\"\r\n";
      std::replace(text.begin(), text.end(), ',', separator);
      const auto table = Table(text).read();
      REQUIRE_MESSAGE(table, (table ? "" : table.error().message));
      REQUIRE(table->samples.size() == 2); // a row without any count is none
      const GloveSample &first = table->samples[0], &last = table->samples[1];
      CHECK(first[Sensor::index_mcp].value == 12);
      CHECK(first[Sensor::thumb_roll].value == 8); // rounded
      CHECK(last[Sensor::index_mcp].value == 300);
      CHECK(last[Sensor::thumb_roll].value == 0);
      CHECK(to_seconds(last.arrival - first.arrival) == doctest::Approx(0.5));
      CHECK(first.sequence == 0);
      CHECK(last.sequence == 1);
      CHECK(table->info.side == Side::right);
      CHECK(table->info.sensors == mask_of(std::array{Sensor::index_mcp, Sensor::thumb_roll}));
      CHECK(table->info.counts.max_count == 4095); // the next converter that counts so far
      CHECK(table->info.kind == driver::SourceKind::recorded);
      CHECK(table->info.rate_hz == doctest::Approx(2.0));
    }
  }

  TEST_CASE("a mark of UTF-8 before the first column, as spreadsheets write it, is passed over") {
    const auto table = Table("\xEF\xBB\xBFtime_s,index_mcp\n0,7\n").read();
    REQUIRE_MESSAGE(table, (table ? "" : table.error().message));
    CHECK(table->samples[0][Sensor::index_mcp].value == 7);
  }

  TEST_CASE("a hand's rows are chosen, and its sequence is kept") {
    const Table both("time_s,hand,sequence,index_mcp\n0,left,5,1\n0,right,8,2\n1,left,9,3\n");
    const auto left = both.read({.side = Side::left});
    REQUIRE(left);
    REQUIRE(left->samples.size() == 2);
    CHECK(left->samples[1][Sensor::index_mcp].value == 3);
    CHECK(left->samples[1].sequence == 9);
    CHECK(both.read({.hand = Side::right, .side = Side::left})->samples.size() == 1);
    const Table one("time_s,hand,index_mcp\n0,left,1\n");
    CHECK(one.read({.side = Side::right})->info.side == Side::left); // there is no other
    CHECK(one.read({.hand = Side::right}).error().code == Errc::no_device);
    const Table none("time_s,index_mcp\n0,1\n");
    CHECK(none.read({.side = Side::left})->info.side == Side::left);
  }

  TEST_CASE("without times, these follow from the rate") {
    const Table table("index_mcp\n1\n2\n3\n");
    CHECK(says(table.complaint(), "rate"));
    const auto read = table.read({.rate_hz = 50.0});
    REQUIRE(read);
    CHECK(to_seconds(read->samples[2].arrival - read->samples[0].arrival) == doctest::Approx(0.04));
    CHECK(read->info.rate_hz == doctest::Approx(50.0));
  }

  TEST_CASE("times have any origin and unit, and their differences are exact") {
    const auto differences_us = [](const std::string& text) {
      const auto table = Table(text).read();
      REQUIRE_MESSAGE(table, (table ? "" : table.error().message));
      REQUIRE(table->samples.size() == 3);
      std::vector<double> us;
      for (const std::size_t at : {1U, 2U})
        us.push_back(1e6 * to_seconds(table->samples[at].arrival - table->samples[at - 1].arrival));
      return us;
    };
    const std::vector<double> expected{11100.0, 11101.0};
    CHECK(differences_us("time_s,index_mcp\n1700000000.0,1\n1700000000.0111,2\n"
                         "1700000000.022201,3\n") == expected);
    CHECK(differences_us("Time (ms);index_mcp\n-11,1;1\n0,0;2\n11,101;3\n") == expected);
    CHECK(differences_us("timestamp_us\tindex_mcp\n1700000000000000\t1\n1700000000011100\t2\n"
                         "1700000000022201\t3\n") == expected);
    CHECK(differences_us("# t_ns index_mcp\n1700000000000000000 1\n1700000000011100000 2\n"
                         "1700000000022201000 3\n") == expected);
    const auto epoch = Table("time_s,index_mcp\n1700000000.5,1\n").read();
    REQUIRE(epoch);
    CHECK(to_seconds(epoch->samples[0].arrival.time_since_epoch()) == 1700000000.5);
    CHECK(says(Table("time,index_mcp\n0,1\n").complaint(), "name it time_s, time_ms"));
    CHECK(Table("time,index_mcp\n0,1\n").read({.rate_hz = 50.0}));
    CHECK(says(Table("time_s,time_ms,index_mcp\n0,0,1\n").complaint(), "two columns of times"));
  }

  TEST_CASE("times fall between hands, but not within one") {
    const Table stacked("hand,time_s,index_mcp\n0,0,1\n0,1,2\n1,0,3\nRight,1,4\n");
    const auto right = stacked.read({.side = Side::right});
    REQUIRE_MESSAGE(right, (right ? "" : right.error().message));
    REQUIRE(right->samples.size() == 2);
    CHECK(right->samples[1][Sensor::index_mcp].value == 4);
    CHECK(says(Table("hand,time_s,index_mcp\nleft,1,1\nleft,0,2\n").complaint(),
               ":3: column 2 (time_s): '0' is less than in the row before"));
  }

  TEST_CASE("a count that is missing is none, other columns are named, but not our own") {
    const auto table = Table("time_s,index_mcp,index_pip,index_mcp_deg,measured_s,note\n"
                             "0,nan,4,,0,x\n1,N/A,nan,,0,y\n2,3,,,0,z\n")
                           .read();
    REQUIRE_MESSAGE(table, (table ? "" : table.error().message));
    REQUIRE(table->samples.size() == 2);
    CHECK_FALSE(table->samples[0].present.has(Sensor::index_mcp));
    CHECK(table->samples[1][Sensor::index_mcp].value == 3);
    REQUIRE(table->info.facts.size() == 1);
    CHECK(table->info.facts[0].name == columns_not_read_fact);
    CHECK(table->info.facts[0].value == "note");
  }

  TEST_CASE("what is wrong is reported with its line") {
    CHECK(says(Table("a,b\n1,2\n").complaint(), "thumb_roll"));
    CHECK(says(Table("time_s,index_mcp\n").complaint(), "no row"));
    CHECK(says(Table("").complaint(), "empty"));
    CHECK(says(Table("time_s,index_mcp\n0,1\n1\n").complaint(), ":3: "));
    CHECK(says(Table("time_s,index_mcp,index_mcp_count\n0,1,1\n").complaint(), "two columns"));
    for (const std::string count : {"-1", "65536", "nan", "inf", "x", "1e99", "1 2"})
      CHECK(says(Table("time_s,index_mcp\n0," + count + "\n").complaint(), ":2: "));
    for (const std::string time : {"", "x", "nan", "1e300"})
      CHECK(says(Table("time_s,index_mcp\n" + time + ",4\n").complaint(), ":2: "));
    CHECK(says(Table("time_s,index_mcp\n1,1\n0,1\n").complaint(), ":3: "));
    CHECK(says(Table("time_s,hand,index_mcp\n1,foot,1\n").complaint(), "foot"));
    CHECK(says(Table("time_s,sequence,index_mcp\n1,-4,1\n").complaint(), "-4"));
    CHECK(says(Table("time_s,sequence,index_mcp\n1,4,1\n1,4,1\n").complaint(), "sequence"));
    CHECK(read_sample_table("/nowhere/at/all.csv", {}).error().code == Errc::bad_input);
    CHECK(read_sample_table("/", {}).error().code == Errc::bad_input);
  }

  TEST_CASE("any bytes are a table or an error") {
    std::mt19937 random(77);
    const std::string letters = "time_s,index_mcp;\t\n0123456789.-e\"\r\x01\xff";
    for (int round = 0; round < 2000; ++round) {
      std::string text = round % 2 == 0 ? "time_s,index_mcp\n" : "";
      for (std::size_t left = random() % 60; left > 0; --left)
        text += letters[random() % letters.size()];
      const auto table = Table(text).read({.rate_hz = 90.0});
      if (table)
        CHECK_FALSE(table->samples.empty());
      else
        CHECK_FALSE(table.error().message.empty());
    }
  }

  TEST_CASE("a table is a glove like any other, as often as it is started") {
    const Table table("time_s,index_mcp\n0,1\n0.01,2\n0.02,3\n");
    const auto open = [&](const std::string& options) {
      return driver::open_glove("replay:" + table.path.string() + options, std::nullopt,
                                {.drivers = {replay_driver()}});
    };
    const auto glove = test::required(open("?end=hold"));
    for (int start = 0; start < 2; ++start) {
      SampleRing ring(16);
      REQUIRE(glove->start(ring));
      std::vector<int> counts;
      while (counts.size() < 3)
        ring.drain([&](const GloveSample& sample) {
          counts.push_back(sample[Sensor::index_mcp].value);
          CHECK(sample.is_replayed);
        });
      CHECK(counts == std::vector{1, 2, 3});
      glove->stop();
    }
    CHECK_FALSE(open("?rate=0"));
  }
}

} // namespace sample_table_test
