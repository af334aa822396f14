#pragma once
// An emulated unit without a terminal, and a host that talks to it.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "units/emulated_unit.hpp"

namespace nendo::test {

using Bytes = std::vector<std::uint8_t>;

inline std::string text_of(const Bytes& bytes) {
  return {bytes.begin(), bytes.end()};
}

template <class Unit, class Options>
struct UnitBench {
  explicit UnitBench(const Options& options = {}) : unit(options) {}

  void send(const Bytes& bytes) { unit.receive(std::as_bytes(std::span(bytes)), now); }
  Bytes receive() {
    const auto output = unit.output();
    Bytes bytes;
    for (const std::byte byte : output)
      bytes.push_back(std::to_integer<std::uint8_t>(byte));
    unit.take(output.size());
    return bytes;
  }
  Bytes ask(const Bytes& bytes) {
    send(bytes);
    return receive();
  }
  Bytes ask(std::string_view text) { return ask(Bytes(text.begin(), text.end())); }
  Bytes after(emulator::EmulatedUnit::Time time) {
    now += time;
    unit.advance(now);
    return receive();
  }

  Unit unit;
  emulator::EmulatedUnit::Time now =
      std::chrono::hours(1); // not 0: a unit has usually been on for a while
};

/// A bench whose unit has been advanced to `now`, so that nothing is overdue.
template <class Unit, class Options>
struct AdvancedBench : UnitBench<Unit, Options> {
  explicit AdvancedBench(const Options& options = {}) : UnitBench<Unit, Options>(options) {
    this->unit.advance(this->now);
  }
};

/// Splits a stream of records after each NUL. The NULs stay.
inline std::vector<Bytes> split(const Bytes& stream) {
  std::vector<Bytes> records(1);
  for (const std::uint8_t byte : stream) {
    records.back().push_back(byte);
    if (byte == 0) records.emplace_back();
  }
  CHECK(records.back().empty());
  records.pop_back();
  return records;
}

} // namespace nendo::test
