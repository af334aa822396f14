#include <nendo/flow/command.hpp>

#include <algorithm>
#include <cmath>

#include <nendo/base/text.hpp>
#include <nendo/flow/setting.hpp>

namespace nendo::flow {
namespace {

constexpr std::array<std::string_view, 4> mask_edit_names{"hold", "free", "clear", "invert"};
constexpr std::array<std::string_view, requests.size()> request_names{
    "grab", "let go", "commit", "undo", "redo", "reset", "take hold"};
constexpr double largest = 1e9; // of lengths, model units, as in a puppet's file

} // namespace

std::string_view name_of(Request request) noexcept {
  return request_names[static_cast<std::size_t>(request)];
}

std::optional<Request> request_named(std::string_view name) noexcept {
  const auto* const found = std::find(request_names.begin(), request_names.end(), name);
  if (found == request_names.end()) return std::nullopt;
  return requests[static_cast<std::size_t>(found - request_names.begin())];
}

std::string_view name_of(MaskEdit edit) noexcept {
  return mask_edit_names[static_cast<std::size_t>(edit)];
}

std::optional<MaskEdit> mask_edit_named(std::string_view name) noexcept {
  return enumerator_named<MaskEdit>(mask_edit_names, name);
}

bool SetMask::is_usable() const noexcept {
  if (edit == MaskEdit::clear || edit == MaskEdit::invert) return true;
  return radius > 0.0 && radius <= largest && // false for NaN
         std::all_of(at.begin(), at.end(), [](double one) { return std::abs(one) <= largest; });
}

bool PendingSettings::follow(const LoopSettings& in_effect) noexcept {
  if (in_effect == now || HostClock::now() - asked_at_ < patience) return false;
  now = asked_ = in_effect;
  return true;
}

std::optional<Command> PendingSettings::ask() noexcept {
  if (now == asked_) return std::nullopt;
  asked_ = now;
  asked_at_ = HostClock::now();
  return ChangeSettings{now};
}

void PendingSettings::next_mode(bool is_puppet) noexcept {
  do
    now.mode = static_cast<Mode>((static_cast<unsigned>(now.mode) + 1U) % mode_count);
  while (is_puppet && is_by_hands(now.mode));
}

void PendingSettings::next_volume() noexcept {
  const double more = std::floor(4.0 * now.keep_volume + 1.0) / 4.0;
  now.keep_volume = more > 1.0 ? 0.0 : more;
}

void PendingSettings::next_kernel() noexcept {
  const auto* const at = std::find(kernels.begin(), kernels.end(), now.kernel);
  now.kernel = kernels[static_cast<std::size_t>(at - kernels.begin() + 1) % kernels.size()];
}

void PendingSettings::next_brush() noexcept {
  auto brush =
      static_cast<std::uint8_t>((static_cast<int>(now.brushes[1]) + 1) % deform::brush_count);
  if (static_cast<deform::Brush>(brush) == deform::Brush::none) ++brush;
  now.brushes.fill(static_cast<deform::Brush>(brush));
  now.mode = Mode::type2;
}

/// In whole tenths, so that it comes back to where it was.
void PendingSettings::add_strength(double more) noexcept {
  now.brush_strength =
      setting::brush_strength.range.nearest(std::round(10.0 * (now.brush_strength + more)) / 10.0);
}

void PendingSettings::scale_radii(double factor) noexcept {
  for (double& radius_m : now.radius_m)
    radius_m = setting::radius.handy.nearest(factor * radius_m);
}

} // namespace nendo::flow
