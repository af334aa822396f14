#pragma once
// The properties of gloves, which open gloves, recordings and sessions have.

#include <cstdint>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>

#include "python/bind.hpp"

namespace nendo::python {

/// Returns {name: value} of the properties that a device reports.
inline py::dict facts_of(const std::vector<driver::DeviceFact>& facts) {
  py::dict all;
  for (const driver::DeviceFact& fact : facts)
    all[to_str(fact.name)] = to_str(fact.value);
  return all;
}
inline std::size_t capacity_of(std::int64_t capacity) {
  constexpr std::int64_t most = 1'000'000'000;
  if (capacity < 1 || capacity > most)
    throw py::value_error("capacity: use 1 to " + std::to_string(most));
  return static_cast<std::size_t>(capacity);
}

} // namespace nendo::python
