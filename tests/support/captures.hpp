#pragma once
// Files of tests/driver/captures/, with the bytes that a device sends and what is to be read from
// them.

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>

#include "support/parser_laws.hpp"

namespace nendo::test {

inline std::string read_capture(const std::string& name) {
  const auto path = std::filesystem::path(NENDO_CAPTURES) / name;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Capture {
  std::filesystem::path stream; ///< its name
  std::size_t longest_record = 0;
};

/// Checks that a parser makes of a captured stream what was worked out for it by hand, a
/// `line_of(record)` each.
template <class Record, class Parser, class LineOf>
void reads_as_expected(Parser parser, const Capture& capture, const LineOf& line_of) {
  CAPTURE(capture.stream);
  const std::string input = read_capture(capture.stream);
  std::string lines;
  parser.push(std::as_bytes(std::span(input)),
              [&](const Record& record) { lines += line_of(record) + "\n"; });
  check_accounted(parser, input.size(), capture.longest_record);
  CHECK(lines ==
        read_capture(std::filesystem::path(capture.stream).replace_extension(".expected")));
}

/// Returns the line of a tracker's record: station, error letter, position and quaternion.
template <class Record>
std::string pose_line(const Record& record) {
  std::array<char, 120> line{};
  const auto& [x, y, z] = record.position_m;
  const auto& [qx, qy, qz, qw] = record.turn_xyzw;
  std::snprintf(line.data(), line.size(), "%d %c %.4f %.4f %.4f  %.4f %.4f %.4f %.4f",
                record.station, record.error, x, y, z, qx, qy, qz, qw);
  return line.data();
}

/// Checks each line `bytes in hexadecimal => text` of a file of reports, of which there are so many
/// at least: that is what `text_of(bytes)` must be.
template <class TextOf>
void reports_read_as_meant(const std::string& name, int least, const TextOf& text_of) {
  std::istringstream file(read_capture(name));
  int cases = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    CAPTURE(line);
    const std::size_t arrow = line.find(" => ");
    REQUIRE(arrow != std::string::npos);
    std::istringstream words(line.substr(0, arrow));
    StreamBytes report;
    for (std::string word; words >> word;)
      report.push_back(static_cast<std::byte>(std::stoul(word, nullptr, 16)));
    CHECK(text_of(report) == line.substr(arrow + 4));
    ++cases;
  }
  CHECK(cases >= least);
}

} // namespace nendo::test
