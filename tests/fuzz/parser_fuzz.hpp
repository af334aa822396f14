#pragma once
// What the fuzz targets of parsers have in common. The first byte of an input chooses; the rest is
// what a glove sends.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "laws.hpp"

inline std::span<const std::byte> rest_of(std::span<const std::uint8_t> input) {
  return std::as_bytes(input).subspan(1);
}

struct Stream {
  std::span<const std::byte> bytes;
  std::size_t longest_chunk = 1;
  std::size_t longest_record = 1;
};

/// Calls `push(chunk)`, which gives the parser a chunk, for one after another. After each of them
/// every byte is accounted for, and the parser holds less than one longest record.
template <class Parser, class Push>
void push_stream(const Parser& parser, const Stream& stream, const Push& push) {
  for (std::size_t pushed = 0; pushed < stream.bytes.size();) {
    const auto rest = stream.bytes.subspan(pushed);
    const auto chunk = rest.first(std::min(stream.longest_chunk, rest.size()));
    push(chunk);
    pushed += chunk.size();
    const auto& counters = parser.counters();
    require(counters.bytes == pushed);
    require(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
    require(parser.pending() < stream.longest_record);
  }
}

/// Pushes a stream of records of one length, which is Stream::longest_record. Calls `check` with
/// each. In one piece, the stream gives as many. `make` makes a parser. Returns the counts.
template <class Record, class Make, class Check>
auto push_records(const Stream& stream, const Make& make, const Check& check) {
  auto parser = make();
  std::uint64_t records = 0;
  push_stream(parser, stream, [&](auto chunk) {
    parser.push(chunk, [&](const Record& record) {
      ++records;
      check(record);
    });
    require(parser.counters().records == records);
    require(parser.counters().record_bytes == records * stream.longest_record);
  });
  auto uncut = make();
  uncut.push(stream.bytes, [](const Record&) {});
  require(uncut.counters().records == records);
  require(uncut.counters().bad_records == parser.counters().bad_records);
  return parser.counters();
}

/// Checks the pose that a record of a tracker contains: how far from the origin its coordinates may
/// be, and how far from 1 the length of its quaternion.
template <class Record>
void require_pose(const Record& record, double max_coordinate_m, double max_length_error) {
  for (const double coordinate_m : record.position_m)
    require(std::abs(coordinate_m) <= max_coordinate_m);
  double squares = 0.0;
  for (const double component : record.turn_xyzw)
    squares += component * component;
  require(std::abs(std::sqrt(squares) - 1.0) <= max_length_error);
}

/// Cuts an input into reports. Calls `check` with each that `Parser` takes, which are those of
/// `report_bytes` bytes only.
template <class Parser, class Check>
void push_reports(std::span<const std::uint8_t> input, std::size_t report_bytes,
                  const Check& check) {
  if (input.empty()) return;
  Parser parser;
  const std::size_t length = 1 + input[0] % 80U;
  auto rest = rest_of(input);
  for (std::uint64_t pushed = 0; !rest.empty();) {
    const auto report = rest.first(std::min(length, rest.size()));
    rest = rest.subspan(report.size());
    if (const auto record = parser.push(report)) check(*record);
    pushed += report.size();
    const auto& counters = parser.counters();
    require(counters.bytes == pushed);
    require(counters.bytes == counters.record_bytes + counters.discarded_bytes);
    require(counters.record_bytes == counters.records * report_bytes);
  }
}
