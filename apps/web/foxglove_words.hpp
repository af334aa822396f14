#pragma once
// The text messages of Foxglove's WebSocket protocol: a strict parser for those of clients, and the
// server's. Pure.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::web {

/// The subprotocols, which differ in nothing that is used here. The first is that of Foxglove's
/// SDK, the second that of older applications.
inline constexpr std::array<std::string_view, 2> foxglove_protocols{"foxglove.sdk.v1",
                                                                    "foxglove.websocket.v1"};

/// A client gets the messages of a channel under the number that it has chosen.
struct FoxgloveSubscription {
  std::uint32_t id = 0;
  std::uint32_t channel = 0;
  friend bool operator==(const FoxgloveSubscription&, const FoxgloveSubscription&) = default;
};

/// The request of a message. Both lists are empty if it is about something that this server does
/// not offer, such as parameters; applications also introduce themselves.
struct FoxgloveRequest {
  std::vector<FoxgloveSubscription> subscribe;
  std::vector<std::uint32_t> unsubscribe; ///< numbers of subscriptions
};

/// Parses a message. Error: bad_input (not a JSON object with an "op", or a subscription without
/// its whole numbers from 0 to 2^32 - 1), in at most max_close_reason bytes.
Result<FoxgloveRequest> parse_foxglove(std::string_view text);

/// A channel as clients see it. Messages are CDR, and schemas `ros2msg`.
struct FoxgloveChannel {
  std::uint32_t id = 0;
  std::string topic, type, schema;
};

/// The server's first message. session: another one makes applications forget the data before.
std::string foxglove_server_info(std::string_view name, std::string_view session);
std::string foxglove_advertisement(std::span<const FoxgloveChannel> channels);
/// A warning, which applications list among problems.
std::string foxglove_warning(std::string_view message);

} // namespace nendo::web
