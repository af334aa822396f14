#include <array>
#include <utility>

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

namespace {
constexpr std::array<std::pair<Polynomial, std::string_view>, 3> polynomial_names{{
    {Polynomial::none, "none"},
    {Polynomial::constant, "constant"},
    {Polynomial::linear, "linear"},
}};
}

std::string_view name_of(Polynomial polynomial) noexcept {
  for (const auto& [candidate, name] : polynomial_names)
    if (candidate == polynomial) return name;
  return {};
}

std::optional<Polynomial> polynomial_named(std::string_view name) noexcept {
  for (const auto& [polynomial, candidate] : polynomial_names)
    if (candidate == name) return polynomial;
  return std::nullopt;
}

std::string_view describe(FieldStatus status) noexcept {
  switch (status) {
  case FieldStatus::ok:
    return "ok";
  case FieldStatus::merged:
    return "some control points are so close together that they share their displacements";
  case FieldStatus::singular:
    return "these control points and radii have no usable solution";
  case FieldStatus::too_dense:
    return "too many control points lie within each other's radii to be solved for at once; use "
           "smaller radii or fewer points";
  case FieldStatus::not_finite:
    return "a control point, displacement, radius or weight is not finite, too large, or not "
           "positive";
  }
  return {};
}

} // namespace nendo::deform
