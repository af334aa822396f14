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

/// Checks that the counts of a parser that was given `input` bytes add up.
template <class Parser>
void check_accounted(const Parser& parser, std::size_t input) {
  const auto& counters = parser.counters();
  CHECK(counters.bytes == input);
  CHECK(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
}

/// Checks that a parser makes the same of `stream` in one piece and in any two pieces. `make()`
/// returns a parser, `value_of` tells records apart, and less than `longest` bytes may be pending.
template <class Make, class ValueOf>
void cut_makes_no_difference(const StreamBytes& stream, std::size_t longest, const Make& make,
                             const ValueOf& value_of) {
  auto uncut = make();
  std::vector<int> whole;
  uncut.push(std::span<const std::byte>(stream), value_of(whole));
  for (std::size_t first = 0; first <= stream.size(); ++first) {
    auto parser = make();
    std::vector<int> values;
    const auto sink = value_of(values);
    parser.push(std::span(stream).first(first), sink);
    CHECK(parser.pending() < longest);
    parser.push(std::span(stream).subspan(first), sink);
    CHECK(values == whole);
    CHECK(parser.counters().discarded_bytes == uncut.counters().discarded_bytes);
    CHECK(parser.counters().bad_records == uncut.counters().bad_records);
  }
}

} // namespace nendo::test
