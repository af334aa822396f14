#include "units/emulated_kinds.hpp"

#include <array>
#include <string>

#include "units/cyberglove_unit.hpp"
#include "units/fivedt_unit.hpp"
#include "units/forte_unit.hpp"
#include "units/lucidgloves_unit.hpp"

namespace nendo::emulator {
namespace {

/// Makes a unit of the options that every kind has.
template <class Unit, class UnitOptions>
Result<std::unique_ptr<EmulatedUnit>> make_unit(const EmulatorOptions& options) {
  const auto motion = driver::find_motion(options.motion);
  if (!motion) return motion.error();
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= Unit::most_rate_hz)) {
    return Error{Errc::usage, "rate: a " + options.glove + " glove sends 1 to " +
                                  std::to_string(static_cast<int>(Unit::most_rate_hz)) +
                                  " records a second"};
  }
  UnitOptions unit;
  unit.side = options.side;
  unit.motion = *motion;
  unit.rate_hz = options.rate_hz;
  unit.seed = options.seed;
  return std::unique_ptr<EmulatedUnit>(std::make_unique<Unit>(unit));
}

constexpr std::array kinds{
    EmulatedKind{"cyberglove", make_cyberglove_unit, true},
    EmulatedKind{"lucidgloves", make_unit<LucidGlovesUnit, LucidGlovesUnitOptions>, false},
    EmulatedKind{"5dt", make_unit<FiveDtUnit, FiveDtUnitOptions>, false},
    EmulatedKind{"forte", make_unit<ForteUnit, ForteUnitOptions>, false},
};

} // namespace

std::vector<std::string_view> emulated_glove_names() {
  std::vector<std::string_view> names;
  for (const EmulatedKind& kind : kinds)
    names.push_back(kind.name);
  return names;
}

Result<EmulatedKind> find_emulated_kind(std::string_view name) {
  std::string names;
  for (const EmulatedKind& kind : kinds) {
    if (kind.name == name) return kind;
    names.append(names.empty() ? "" : ", ").append(kind.name);
  }
  return Error{Errc::usage,
               "glove \"" + std::string(name) + "\" cannot be emulated; there is " + names};
}

} // namespace nendo::emulator
