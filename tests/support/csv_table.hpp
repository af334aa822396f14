#pragma once
// Reads the tables that nendo writes.

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

namespace nendo::test {

inline std::vector<std::string> csv_cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line + ","); // getline() gives no empty one at an end
  for (std::string cell; std::getline(stream, cell, ',');)
    cells.push_back(cell);
  return cells;
}

/// Returns the cells by column, then row. All rows must be as long as the head.
inline std::map<std::string, std::vector<std::string>> csv_columns(const std::string& text) {
  std::map<std::string, std::vector<std::string>> table;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const auto head = csv_cells(line);
  while (std::getline(lines, line)) {
    const auto cells = csv_cells(line);
    REQUIRE(cells.size() == head.size());
    for (std::size_t at = 0; at < head.size(); ++at)
      table[head[at]].push_back(cells[at]);
  }
  return table;
}

} // namespace nendo::test
