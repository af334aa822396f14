#include <nendo/flow/finger_supports.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <nendo/base/text.hpp>

namespace nendo::flow {
namespace {

constexpr Eigen::Index fingertips_of_hand = 5;
constexpr Eigen::Index fingertips_of_two = 2 * fingertips_of_hand;

/// Returns the text with lengths on the stage in model units. Weights, after a colon, have no
/// unit.
std::string in_model_units(std::string_view text, double units_per_metre) {
  std::string plain;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(",+:"), text.size());
    const std::string_view part = text.substr(0, end);
    const bool is_radius = !plain.ends_with(':');
    const auto length_m = is_radius ? to_metres(part) : std::nullopt;
    const double length = length_m.value_or(0.0) * units_per_metre;
    plain += length_m && std::isfinite(length) ? decimal_text(length) : std::string(part);
    if (end < text.size()) plain += text[end];
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return plain;
}

} // namespace

Result<deform::Supports> parse_finger_supports(std::string_view text, double units_per_metre) {
  auto supports =
      deform::parse_supports_by_point(in_model_units(text, units_per_metre), fingertips_of_two);
  if (supports) return *std::move(supports);
  return Error{Errc::usage, std::string(text) +
                                ": use a length > 0 in the model's units, as 0.25, or on the "
                                "stage, as 3cm, or five with commas between (or ten, left hand "
                                "first)"};
}

Result<deform::Supports> supports_of_hands(const deform::Supports& of_two, int hands) {
  if (hands == 2) return of_two;
  deform::Supports of_one{of_two.shared, {}};
  std::vector<deform::OwnSupport> of_other;
  for (deform::OwnSupport own : of_two.own) {
    const bool is_other = own.point >= fingertips_of_hand;
    own.point %= fingertips_of_hand;
    (is_other ? of_other : of_one.own).push_back(own);
  }
  if (of_other != of_one.own)
    return Error{Errc::usage, "there is one hand, and the radii of two differ; use one radius, or "
                              "five with commas between"};
  return of_one;
}

deform::Supports of_both_sides(deform::Supports supports, Eigen::Index tips) {
  const std::vector<deform::OwnSupport> own = supports.own;
  for (deform::OwnSupport image : own) {
    image.point += tips;
    supports.own.push_back(image);
  }
  return supports;
}

deform::Supports of_one_side(deform::Supports supports, Eigen::Index tips) {
  std::erase_if(supports.own, [&](const deform::OwnSupport& own) { return own.point >= tips; });
  return supports;
}

std::string radius_text(const std::array<double, 5>& radius_m, double units_per_metre) {
  const auto [least, most] = std::minmax_element(radius_m.begin(), radius_m.end());
  const auto in_units = [least = *least, most = *most](double units) {
    const auto one = [units](double radius) {
      char text[32];
      return std::string(text, std::to_chars(text, text + sizeof text, units * radius,
                                             std::chars_format::general, 3)
                                   .ptr);
    };
    return least == most ? one(least) : one(least) + " to " + one(most);
  };
  return in_units(100.0) + " cm (" + in_units(units_per_metre) + ")";
}

deform::Supports supports_on_model(const std::array<double, 5>& radius_m, double units_per_metre) {
  std::vector<deform::OwnSupport> own;
  for (Eigen::Index point = 0; point < fingertips_of_two; ++point)
    own.push_back(
        {point, {radius_m[static_cast<std::size_t>(point) % radius_m.size()] * units_per_metre}});
  return deform::with_common(std::move(own));
}

std::array<double, 5> radii_on_stage(const deform::Supports& supports, double units_per_metre) {
  std::array<double, 5> radii{};
  for (const auto& own : supports.own) {
    auto& radius = radii[static_cast<std::size_t>(own.point) % radii.size()];
    radius = std::max(radius, own.support.radius / units_per_metre);
  }
  double largest_shared = 0.0;
  for (const auto& shared : supports.shared)
    largest_shared = std::max(largest_shared, shared.radius / units_per_metre);
  for (auto& radius : radii)
    if (radius == 0.0) radius = largest_shared; // beside own ones the shared one but joins them
  return radii;
}

} // namespace nendo::flow
