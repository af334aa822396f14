#include "emulator/emulated_kinds.hpp"

#include <array>
#include <string>

#include "emulator/cyberglove_unit.hpp"

namespace nendo::driver {
namespace {

constexpr std::array kinds{
    EmulatedKind{"cyberglove", make_cyberglove_unit, true},
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

} // namespace nendo::driver
