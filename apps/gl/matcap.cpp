#include "gl/matcap.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::gl {

using Eigen::Vector3f;

namespace {

// From the eye. The key light is that of the lit material (render/lights.hpp), so that the shadow
// on the ground fits.
const Vector3f key = Vector3f(-0.55F, 0.75F, 0.55F).normalized();
const Vector3f fill = Vector3f(0.85F, 0.10F, 0.45F).normalized();
const Vector3f back = Vector3f(0.60F, 0.25F, -0.75F).normalized();

/// How a material answers to light. Colours are linear.
struct Substance {
  Vector3f own;   ///< the colour in white light
  Vector3f below; ///< added where light that entered beside comes out again, at the terminator
  float wrap;     ///< how far light goes round: 0 as on stone ... 1 to the whole surface
  float sky;      ///< light from everywhere
  float gloss;    ///< the highlight's strength
  float power;    ///< the highlight's exponent: larger is smaller
  float edge;     ///< how much darker the surface is where it turns away; below 0: lighter
};

const Substance& substance_of(Material material) {
  static const std::array substances{
      Substance{{0.32F, 0.235F, 0.18F}, {0.0F, 0.0F, 0.0F}, 0.15F, 0.20F, 0.10F, 14.0F, 0.50F},
      Substance{{0.70F, 0.69F, 0.665F}, {0.0F, 0.0F, 0.0F}, 0.12F, 0.22F, 0.0F, 1.0F, 0.45F},
      Substance{{0.74F, 0.52F, 0.21F}, {0.16F, 0.085F, 0.012F}, 0.60F, 0.16F, 0.26F, 40.0F, 0.15F},
      Substance{
          {0.66F, 0.375F, 0.285F}, {0.15F, 0.018F, 0.012F}, 0.30F, 0.18F, 0.13F, 18.0F, 0.30F}};
  return substances[static_cast<std::size_t>(material) - 1];
}

float wrapped(float cosine, float wrap) {
  return std::max(0.0F, (cosine + wrap) / (1.0F + wrap));
}

float of_screen(float linear) {
  // Bright parts approach white without reaching it, so that they keep their form.
  const float soft =
      linear <= 0.7F ? linear : 0.7F + (linear - 0.7F) / (1.0F + (linear - 0.7F) / 0.3F);
  return std::pow(std::clamp(soft, 0.0F, 1.0F), 1.0F / 2.2F);
}

} // namespace

Vector3f matcap_colour(Material material, const Vector3f& normal) {
  const Substance& of = substance_of(material);
  const float away = 1.0F - std::clamp(normal.z(), 0.0F, 1.0F);
  const float toward_key = normal.dot(key);
  Vector3f light = Vector3f::Constant(of.sky * (0.75F + 0.25F * normal.y()));
  light += wrapped(toward_key, of.wrap) * Vector3f(1.08F, 1.04F, 0.98F);
  light += wrapped(normal.dot(fill), of.wrap) * Vector3f(0.15F, 0.16F, 0.18F);
  Vector3f colour = of.own.cwiseProduct(light);
  // Where the key light grazes, it has gone a long way below the surface.
  const float from_terminator = (toward_key + 0.05F) / 0.45F;
  colour += std::exp(-from_terminator * from_terminator) * of.below;
  colour *= 1.0F - of.edge * away * away;
  colour += away * away * wrapped(normal.dot(back), 0.2F) * Vector3f(0.30F, 0.31F, 0.33F);
  const Vector3f half = (key + Vector3f::UnitZ()).normalized();
  colour += of.gloss * std::pow(std::max(0.0F, normal.dot(half)), of.power) * Vector3f::Ones();
  return colour.unaryExpr(&of_screen);
}

render::Image matcap(Material material, int side_px) {
  render::Image image({side_px, side_px});
  const float radius = static_cast<float>(side_px) / 2.0F;
  for (int row = 0; row < side_px; ++row)
    for (int column = 0; column < side_px; ++column) {
      Eigen::Vector2f place(static_cast<float>(column) + 0.5F - radius,
                            radius - static_cast<float>(row) - 0.5F);
      place /= std::max(radius, place.norm());
      const float depth = std::sqrt(std::max(0.0F, 1.0F - place.squaredNorm()));
      const Vector3f colour = matcap_colour(material, {place.x(), place.y(), depth});
      for (std::size_t channel = 0; channel < 3; ++channel)
        image.at(column, row)[channel] = static_cast<std::uint8_t>(
            std::lround(255.0F * colour[static_cast<Eigen::Index>(channel)]));
    }
  return image;
}

} // namespace nendo::gl
