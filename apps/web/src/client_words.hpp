#pragma once
// What a client may say (PROTOCOL.md), strictly: who says anything else is not understood, and does
// not get what it did not mean. Pure, and without allocation.

#include <optional>
#include <string_view>
#include <variant>

#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/save_request.hpp>
#include <nendo/flow/wrist_move.hpp>

namespace nendo::web {

using ClientWish =
    std::variant<flow::Request, flow::LoopChange, flow::SaveRequest, flow::WristMove>;

/// A radius that may be asked for: far beyond what fingers shape with, and no loop's end.
inline constexpr double least_radius_m = 0.001;
inline constexpr double most_radius_m = 10.0;
/// How far a quaternion's length may be from 1: six decimals of each part are enough.
inline constexpr double most_off_unit = 0.01;

/// Nothing if it is none. The radii of settings and the length of a quaternion are in those ranges,
/// the latter made 1; a place is within WristMove::farthest_m.
std::optional<ClientWish> parse_words(std::string_view text) noexcept;

} // namespace nendo::web
