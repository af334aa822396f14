#include <nendo/flow/request.hpp>

#include <algorithm>

namespace nendo::flow {
namespace {

constexpr std::array<std::string_view, requests.size()> names{"grab", "let go", "commit",   "undo",
                                                              "redo", "reset",  "take hold"};

} // namespace

std::string_view name_of(Request request) noexcept {
  return names[static_cast<std::size_t>(request)];
}

std::optional<Request> request_named(std::string_view name) noexcept {
  const auto* const found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return requests[static_cast<std::size_t>(found - names.begin())];
}

} // namespace nendo::flow
