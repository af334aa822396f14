#include "render/shading.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::render {

using Eigen::Vector3f;

namespace {

constexpr float ambient = 0.54F;
constexpr float wrapped = 0.12F; // clay scatters a little beyond the terminator
constexpr float shadow_slack_m = 0.004F;
constexpr int shadow_reach = 6;

Vector3f toward_eye(const ShadedPlace& at, const Vector3f& eye) {
  return (eye - at.place).normalized();
}

// The side that is looked at.
Vector3f facing_normal(const ShadedPlace& at, const Vector3f& sight) {
  const float length = at.normal.norm();
  if (!(length > 0.0F)) return sight;
  const Vector3f normal = at.normal / length;
  return normal.dot(sight) < 0.0F ? Vector3f(-normal) : normal;
}

float power(float base, int doublings) noexcept {
  for (int k = 0; k < doublings; ++k)
    base *= base;
  return base;
}

float key_part(const ShadedPlace& at, const Vector3f& normal, const Lighting::Maps& maps) noexcept {
  if (!at.shadowed) return 1.0F;
  return maps.key_shadow.lit_part(at.place + shadow_slack_m * normal, shadow_slack_m, shadow_reach);
}

} // namespace

Vector3f shade(const ShadedPlace& at, const Material& material, const Vector3f& eye,
               const Lighting::Maps& maps) noexcept {
  const Vector3f sight = toward_eye(at, eye);
  const Vector3f normal = facing_normal(at, sight);
  const auto diffuse = [&](const Light& light, float wrap) -> Vector3f {
    const float facing = (normal.dot(light.toward) + wrap) / (1.0F + wrap);
    return std::max(0.0F, facing) * light.colour;
  };
  const float lit = normal.dot(maps.key.toward) > -wrapped ? key_part(at, normal, maps) : 0.0F;
  const float open = 0.35F + 0.65F * at.sky; // lights that have no shadows of their own
  Vector3f light = Vector3f::Constant(ambient * at.sky) + lit * diffuse(maps.key, wrapped) +
                   open * diffuse(maps.fill, 0.3F);
  const float edge = power(1.0F - std::clamp(normal.dot(sight), 0.0F, 1.0F), 1);
  light += open * edge * diffuse(maps.rim, 0.2F);
  const Vector3f half = (maps.key.toward + sight).normalized();
  const float highlight = power(std::max(0.0F, normal.dot(half)), 5);
  return material.colour.cwiseProduct(light) + (material.gloss * lit * highlight) * maps.key.colour;
}

float opacity_of(const ShadedPlace& at, const Material& material, const Vector3f& eye) noexcept {
  const Vector3f sight = toward_eye(at, eye);
  const float across = 1.0F - std::clamp(facing_normal(at, sight).dot(sight), 0.0F, 1.0F);
  return material.opacity + (material.rim_opacity - material.opacity) * across * across * across;
}

float ground_brightness(const ShadedPlace& at, const Material& material, float footprint_m,
                        const Lighting::Maps& maps) noexcept {
  const float away = std::sqrt(at.place.x() * at.place.x() + at.place.z() * at.place.z());
  const float fade = std::clamp(1.25F - 1.25F * away / material.fade_m, 0.0F, 1.0F);
  if (!(fade > 0.0F)) return 1.0F;
  const float lit = key_part(at, Vector3f::UnitY(), maps);
  float brightness = (0.45F + 0.55F * at.sky) * (0.68F + 0.32F * lit);
  // A line as wide as 1.5 mm or a sample, whichever is more; fainter where it was widened.
  constexpr float line_m = 0.0015F;
  const float width = std::max(line_m, footprint_m);
  const auto line = [&](float coordinate) {
    const float cells = coordinate / material.grid_m;
    const float off = std::abs(cells - std::floor(cells + 0.5F)) * material.grid_m;
    return std::clamp((width - off) / width + 0.5F, 0.0F, 1.0F) * line_m / width;
  };
  const float drawn = std::max(line(at.place.x()), line(at.place.z()));
  brightness *= 1.0F - 0.30F * drawn;
  return 1.0F + fade * (brightness - 1.0F);
}

Vector3f background(float height) noexcept {
  const Vector3f top(0.86F, 0.885F, 0.91F);
  const Vector3f bottom(0.70F, 0.70F, 0.695F);
  const float t = height * height * (3.0F - 2.0F * height);
  return top + t * (bottom - top);
}

Pixel encoded(const Vector3f& colour) noexcept {
  Pixel pixel{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    float value = std::max(0.0F, colour[static_cast<Eigen::Index>(channel)]);
    if (value > 0.8F) value = 0.8F + (value - 0.8F) / (1.0F + (value - 0.8F) / 0.2F);
    // sRGB's curve by square roots alone, which every processor rounds alike; within half a step.
    const float root = std::sqrt(value);
    const float root4 = std::sqrt(root);
    const float root8 = std::sqrt(root4);
    const float shown = 0.585122381F * root + 0.783140355F * root4 - 0.368262736F * root8;
    pixel[channel] = static_cast<std::uint8_t>(std::clamp(shown, 0.0F, 1.0F) * 255.0F + 0.5F);
  }
  return pixel;
}

} // namespace nendo::render
