#include <nendo/flow/command.hpp>

#include <algorithm>
#include <cmath>

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
  const auto* const found = std::find(mask_edit_names.begin(), mask_edit_names.end(), name);
  if (found == mask_edit_names.end()) return std::nullopt;
  return static_cast<MaskEdit>(found - mask_edit_names.begin());
}

bool SetMask::is_usable() const noexcept {
  if (edit == MaskEdit::clear || edit == MaskEdit::invert) return true;
  return radius > 0.0 && radius <= largest && // false for NaN
         std::all_of(at.begin(), at.end(), [](double one) { return std::abs(one) <= largest; });
}

} // namespace nendo::flow
