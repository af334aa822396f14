#include <nendo/deform/wendland.hpp>

#include <array>
#include <utility>

namespace nendo::deform {

namespace {
constexpr std::array<std::pair<Wendland, std::string_view>, 4> wendland_names{{
    {Wendland::c0, "wendland-c0"},
    {Wendland::c2, "wendland-c2"},
    {Wendland::c4, "wendland-c4"},
    {Wendland::c6, "wendland-c6"},
}};
}

std::string_view name_of(Wendland kernel) noexcept {
  for (const auto& [candidate, name] : wendland_names)
    if (candidate == kernel) return name;
  return {};
}

std::optional<Wendland> wendland_named(std::string_view name) noexcept {
  for (const auto& [kernel, candidate] : wendland_names)
    if (candidate == name) return kernel;
  return std::nullopt;
}

} // namespace nendo::deform
