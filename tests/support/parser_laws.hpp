#pragma once
// Byte streams for the tests of parsers, and checks that every parser of a stream must pass.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "stream/stream_parser.hpp"

namespace nendo::test {

using StreamBytes = std::vector<std::byte>;

inline StreamBytes bytes_of(std::initializer_list<int> values) {
  StreamBytes bytes;
  for (const int value : values)
    bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

inline StreamBytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

inline StreamBytes joined(std::initializer_list<StreamBytes> parts) {
  StreamBytes all;
  for (const StreamBytes& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Changes, removes or adds a random byte, `times` times.
template <class Random>
void mutilate(StreamBytes& stream, std::uint64_t times, Random& random) {
  for (; times > 0; --times) {
    const auto at = stream.begin() + static_cast<std::ptrdiff_t>(random() % stream.size());
    switch (random() % 3) {
    case 0:
      *at = static_cast<std::byte>(random());
      break;
    case 1:
      stream.erase(at);
      break;
    default:
      stream.insert(at, static_cast<std::byte>(random()));
    }
  }
}

/// Checks that the counts of a parser that was given `input` bytes add up, and that it holds less
/// than one longest record.
template <class Parser>
void check_accounted(const Parser& parser, std::size_t input, std::size_t longest_record) {
  const auto& counters = parser.counters();
  CHECK(counters.bytes == input);
  CHECK(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
  CHECK(parser.pending() < longest_record);
}

/// What a parser made of a stream.
template <class Record>
struct Outcome {
  std::vector<Record> records;
  driver::StreamCounters counters;
  std::size_t pending = 0;

  /// The value of each record's first sensor, where records have `flexion`.
  std::vector<int> firsts() const {
    std::vector<int> values;
    for (const Record& record : records)
      values.push_back(record.flexion[0]);
    return values;
  }
};

/// Gives a new parser the stream in one piece.
template <class Record, class Parser>
Outcome<Record> parse(Parser parser, std::span<const std::byte> stream,
                      std::size_t longest_record) {
  Outcome<Record> outcome;
  parser.push(stream, [&](const Record& record) { outcome.records.push_back(record); });
  outcome.counters = parser.counters();
  outcome.pending = parser.pending();
  check_accounted(parser, stream.size(), longest_record);
  CHECK(outcome.counters.records == outcome.records.size());
  return outcome;
}

struct CutStream {
  StreamBytes bytes;
  std::size_t longest_record = 0;
};

/// Checks that parsers make the same of a stream in one piece and in any two pieces. Returns
/// `value_of(record)` of each record. `fresh` is a parser that was given nothing yet.
template <class Record, class Parser, class ValueOf>
std::vector<int> values_however_cut(const Parser& fresh, const CutStream& stream,
                                    const ValueOf& value_of) {
  const std::span<const std::byte> bytes(stream.bytes);
  std::vector<int> values;
  const auto sink = [&](const Record& record) { values.push_back(value_of(record)); };
  Parser uncut = fresh;
  uncut.push(bytes, sink);
  check_accounted(uncut, bytes.size(), stream.longest_record);
  const std::vector<int> whole = values;
  for (std::size_t first = 0; first <= bytes.size(); ++first) {
    Parser parser = fresh;
    values.clear();
    parser.push(bytes.first(first), sink);
    check_accounted(parser, first, stream.longest_record);
    parser.push(bytes.subspan(first), sink);
    check_accounted(parser, bytes.size(), stream.longest_record);
    CHECK(values == whole);
    CHECK(parser.counters().discarded_bytes == uncut.counters().discarded_bytes);
    CHECK(parser.counters().bad_records == uncut.counters().bad_records);
  }
  return whole;
}

} // namespace nendo::test
