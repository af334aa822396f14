#include <nendo/deform/brush.hpp>

#include <algorithm>
#include <array>

#include <nendo/base/figures.hpp>
#include <nendo/base/text.hpp>

namespace nendo::deform {

namespace {

constexpr std::array<std::string_view, brush_count> brush_names{
    "pull", "none", "push", "inflate", "smooth", "flatten", "twist", "scale", "pinch"};

} // namespace

std::string_view name_of(Brush brush) noexcept {
  return brush_names[static_cast<std::size_t>(brush)];
}

std::optional<Brush> brush_named(std::string_view name) noexcept {
  return enumerator_named<Brush>(brush_names, name);
}

std::string brush_words() {
  return alternatives(brush_names);
}

bool are_all_pull(std::span<const Brush> brushes) noexcept {
  return std::all_of(brushes.begin(), brushes.end(),
                     [](Brush brush) { return brush == Brush::pull; });
}

} // namespace nendo::deform
