#include "units/emulated_kinds.hpp"

#include <array>
#include <string>

#include "units/cyberglove_unit.hpp"
#include "units/fivedt_unit.hpp"
#include "units/forte_unit.hpp"
#include "units/lucidgloves_unit.hpp"

namespace nendo::emulator {
namespace {

/// The options that every kind has; `Options` is its own set of them.
template <class Options>
Result<Options> common_options(const EmulatorOptions& options, double most_rate_hz) {
  const auto motion = driver::find_motion(options.motion);
  if (!motion) return motion.error();
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= most_rate_hz)) {
    return Error{Errc::usage, "rate: a " + options.glove + " glove sends 1 to " +
                                  std::to_string(static_cast<int>(most_rate_hz)) +
                                  " records a second"};
  }
  Options unit;
  unit.side = options.side;
  unit.motion = *motion;
  unit.rate_hz = options.rate_hz;
  unit.seed = options.seed;
  return unit;
}

Result<std::unique_ptr<EmulatedUnit>> make_lucidgloves(const EmulatorOptions& options) {
  const auto unit = common_options<LucidGlovesUnitOptions>(options, LucidGlovesUnit::most_rate_hz);
  if (!unit) return unit.error();
  return make_lucidgloves_unit(*unit);
}

Result<std::unique_ptr<EmulatedUnit>> make_fivedt(const EmulatorOptions& options) {
  const auto unit = common_options<FiveDtUnitOptions>(options, FiveDtUnit::most_rate_hz);
  if (!unit) return unit.error();
  return make_fivedt_unit(*unit);
}

Result<std::unique_ptr<EmulatedUnit>> make_forte(const EmulatorOptions& options) {
  const auto unit = common_options<ForteUnitOptions>(options, ForteUnit::most_rate_hz);
  if (!unit) return unit.error();
  return make_forte_unit(*unit);
}

constexpr std::array kinds{
    EmulatedKind{"cyberglove", make_cyberglove_unit, true},
    EmulatedKind{"lucidgloves", make_lucidgloves, false},
    EmulatedKind{"5dt", make_fivedt, false},
    EmulatedKind{"forte", make_forte, false},
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
