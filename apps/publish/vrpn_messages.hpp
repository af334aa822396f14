#pragma once
// Hands as messages of a VRPN server, which apps/publish/VRPN.md lists. Pure.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "publish/hands_record.hpp"

namespace nendo::publish::vrpn {

using Bytes = std::vector<std::byte>;

/// The server's senders. The index is the number that clients get.
inline constexpr std::array<std::string_view, 5> sender_names{"VRPN Control", "Hand0", "Hand1",
                                                              "Glove0", "Glove1"};
inline constexpr std::size_t first_hand = 1, first_glove = 3; ///< left; the right one follows

/// Returns the names of senders and types, which a client gets after its cookie.
Bytes names();

/// Appends poses of joints and joint angles of both hands. Poses of a hand whose glove is silent or
/// whose tracker is lost are left out, and angles of a silent glove.
void append_hands(Bytes& out, const HandsRecord& record, std::int64_t time_us);

/// Returns whether the wrist switch of a hand is on; nothing if there is none.
std::optional<bool> switch_of(const HandsRecord& record, std::size_t side) noexcept;
void append_switch(Bytes& out, std::size_t side, bool is_on, std::int64_t time_us);

/// Appends the answer to a ping. sender: an index of sender_names.
void append_pong(Bytes& out, std::size_t sender);

} // namespace nendo::publish::vrpn
