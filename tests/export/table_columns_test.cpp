// The page of exports describes each column of the tables, and no other; and all cells are numbers.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/angle.hpp>
#include <nendo/hand/joints.hpp>
#include <nendo/recording/recorder.hpp>

#include "export/motion_files.hpp"
#include "support/csv_table.hpp"
#include "support/recorded_motion.hpp"
#include "support/takes.hpp"

namespace table_columns_test {

using namespace nendo;
using namespace nendo::exporting;

namespace {

/// The names in the first cells of the page's tables: of the motion, then of the samples.
std::vector<std::vector<std::string>> described_names() {
  std::istringstream page(test::file_bytes(NENDO_EXPORT_PAGE));
  std::vector<std::vector<std::string>> tables;
  bool is_table = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| column |")) tables.emplace_back();
    is_table = line.starts_with("| column |") || (is_table && line.starts_with("|"));
    if (!is_table || !line.starts_with("| `")) continue;
    const std::string cell = line.substr(2, line.find(" | ") - 2);
    for (std::size_t at = cell.find('`'); at != std::string::npos;) {
      const std::size_t end = cell.find('`', at + 1);
      tables.back().push_back(cell.substr(at + 1, end - at - 1));
      at = cell.find('`', end + 1);
    }
  }
  return tables;
}

/// All names that a described one stands for.
std::vector<std::string> expanded(const std::string& name) {
  std::map<std::string, std::vector<std::string>> words{{"HAND", {"left", "right"}}};
  for (const auto angle : hand::angle_names)
    words["ANGLE"].emplace_back(angle);
  for (const hand::Joint tip : hand::fingertips)
    words["TIP"].emplace_back(name_of(tip));
  for (const auto sensor : sensor_names)
    words["SENSOR"].emplace_back(sensor);
  std::vector<std::string> names{name};
  for (const auto& [word, values] : words) {
    std::vector<std::string> next;
    for (const std::string& one : names) {
      const std::size_t at = one.find(word);
      if (at == std::string::npos) next.push_back(one);
      for (std::size_t k = 0; at != std::string::npos && k < values.size(); ++k)
        next.push_back(std::string(one).replace(at, word.size(), values[k]));
    }
    names = std::move(next);
  }
  return names;
}

void check_columns(const std::string& file, const std::vector<std::string>& described) {
  std::istringstream lines(test::file_bytes(file));
  std::string head;
  std::getline(lines, head);
  std::set<std::string> unexplained;
  for (const std::string& name : test::csv_cells(head))
    CHECK_MESSAGE(unexplained.insert(name).second, name, " is there twice");
  for (const std::string& name : described) {
    std::size_t matches = 0;
    for (const std::string& one : expanded(name))
      matches += unexplained.erase(one);
    CHECK_MESSAGE(matches > 0, name, " is described, but not written");
  }
  for (const std::string& name : unexplained)
    FAIL_CHECK(name, " is written, but not described");
  // As a reader of numbers sees it: each cell is one, and nan is the only one that is not finite.
  std::size_t numbers = 0;
  const std::size_t columns = test::csv_cells(head).size();
  for (std::string line; std::getline(lines, line);) {
    const auto cells = test::csv_cells(line);
    REQUIRE(cells.size() == columns);
    for (const std::string& cell : cells) {
      double number = 0.0;
      const char* const end = cell.data() + cell.size();
      const auto [stopped, error] = std::from_chars(cell.data(), end, number);
      CHECK_MESSAGE((error == std::errc{} && stopped == end), cell);
      CHECK_MESSAGE((std::isfinite(number) || cell == "nan"), cell);
      ++numbers;
    }
  }
  CHECK(numbers > 0);
}

} // namespace

TEST_SUITE("table_columns") {
  TEST_CASE("the page describes each column of the motion, and no other") {
    const test::RecordedMotion motion(test::Motion{.ticks = 5});
    const auto source = motion.frames();
    auto frames = ChosenFrames::make(*source, {});
    REQUIRE(frames);
    REQUIRE(export_motion_csv(*frames, motion.path("take.csv")));
    const auto described = described_names();
    REQUIRE(described.size() == 2);
    check_columns(motion.path("take.csv").string(), described[0]);
  }

  TEST_CASE("the page describes each column of the samples, and no other") {
    const test::TemporaryFolder folder;
    recording::Setup setup = recording::begin_setup("test 1.0");
    driver::GloveInfo glove;
    glove.sensors = sensors_18;
    setup.gloves.push_back(glove);
    flow::HandInput hand;
    hand.first.arrival = setup.begun_host;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      if (sensors_18.has(static_cast<Sensor>(slot)))
        hand.first.set(static_cast<Sensor>(slot), RawCount{static_cast<std::uint16_t>(slot)});
    setup.hands.push_back(hand);
    flow::InputLog input_log;
    recording::RecorderOptions options;
    options.file = folder.path() / "a.nendo";
    auto recorder = recording::Recorder::begin(setup, input_log, std::move(options));
    REQUIRE(recorder);
    input_log.sample(0, hand.first);
    REQUIRE((*recorder)->end());
    const std::string table = (folder.path() / "a.csv").string();
    REQUIRE(export_samples_csv(folder.path() / "a.nendo", {}, table));
    check_columns(table, described_names()[1]);
  }
}

} // namespace table_columns_test
