#pragma once
// The kinds of devices that can be emulated.

#include <initializer_list>
#include <memory>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/emulator/emulator.hpp>

#include "units/emulated_unit.hpp"

namespace nendo::emulator {

/// A set of kinds of incidents.
class IncidentSet {
public:
  constexpr IncidentSet(std::initializer_list<Incident::Kind> kinds) noexcept {
    for (const Incident::Kind kind : kinds)
      bits_ |= 1U << static_cast<unsigned>(kind);
  }
  constexpr bool has(Incident::Kind kind) const noexcept {
    return ((bits_ >> static_cast<unsigned>(kind)) & 1U) != 0;
  }

private:
  unsigned bits_ = 0;
};

/// A kind of device that can be emulated: a line in the table of emulated_kinds.cpp.
struct EmulatedKind {
  std::string_view name;
  DeviceType type;
  Result<std::unique_ptr<EmulatedUnit>> (*make)(const EmulatorOptions& options);
  IncidentSet incidents; ///< that can happen to it
};

/// Returns the kind of that name. Error: usage, naming those there are.
Result<EmulatedKind> find_emulated_kind(std::string_view name);

} // namespace nendo::emulator
