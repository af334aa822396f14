#pragma once
// The commands that decide whether the hands hold the model, and which shape is its rest shape.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo::flow {

/// Recordings keep the numbers, so new values are added at the end.
enum class Request : std::uint8_t {
  grab,   ///< the hands grab the model
  let_go, ///< and release it; what they have shaped stays
  commit, ///< the shape so far becomes the rest shape, and the hands hold it again
  undo,   ///< back to the rest shape before the last commit (deform::HistoryMove)
  redo,   ///< undoes the last undo, if nothing was committed since
  reset,  ///< back to the model as it was loaded, which an undo undoes
  /// The hands that hold the model re-grab where they are, without a commit
  /// (Shaping::ask()).
  take_hold,
};

inline constexpr std::array requests{Request::grab,     Request::let_go, Request::commit,
                                     Request::undo,     Request::redo,   Request::reset,
                                     Request::take_hold};

/// Returns whether a request undoes, redoes or resets: Shaping does these one after another.
constexpr bool goes_through_history(Request request) noexcept {
  return request == Request::undo || request == Request::redo || request == Request::reset;
}

NENDO_API std::string_view name_of(Request request) noexcept;
NENDO_API std::optional<Request> request_named(std::string_view name) noexcept;

} // namespace nendo::flow
