#pragma once
// The kinds of gloves that can be emulated. Each is a line in the table of emulated_kinds.cpp.

#include <memory>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/emulator/emulator.hpp>

#include "units/emulated_unit.hpp"

namespace nendo::emulator {

struct EmulatedKind {
  std::string_view name;
  Result<std::unique_ptr<EmulatedUnit>> (*make)(const EmulatorOptions& options);
  bool takes_incidents; ///< its glove can be pulled and swapped
};

/// Returns the kind of that name. Error: usage, naming those there are.
Result<EmulatedKind> find_emulated_kind(std::string_view name);

} // namespace nendo::emulator
