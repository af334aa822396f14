#include "web/foxglove_words.hpp"

#include <limits>

#include <nlohmann/json.hpp>

namespace nendo::web {
namespace {

using Json = nlohmann::json;

std::optional<std::uint32_t> whole_number(const Json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto number = value.get<std::uint64_t>();
  if (number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

std::optional<std::uint32_t> number_at(const Json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  return found == object.end() ? std::nullopt : whole_number(*found);
}

Error bad_words(const char* what) {
  return {Errc::bad_input, what};
}

Result<FoxgloveRequest> subscriptions_in(const Json& message) {
  const auto list = message.find("subscriptions");
  if (list == message.end() || !list->is_array())
    return bad_words("subscribe: \"subscriptions\" is a list");
  FoxgloveRequest request;
  for (const Json& one : *list) {
    const auto id = number_at(one, "id");
    const auto channel = number_at(one, "channelId");
    if (!id || !channel) return bad_words("subscribe: \"id\" and \"channelId\" are whole numbers");
    request.subscribe.push_back({*id, *channel});
  }
  return request;
}

Result<FoxgloveRequest> ends_in(const Json& message) {
  const auto list = message.find("subscriptionIds");
  if (list == message.end() || !list->is_array())
    return bad_words("unsubscribe: \"subscriptionIds\" is a list");
  FoxgloveRequest request;
  for (const Json& one : *list) {
    const auto id = whole_number(one);
    if (!id) return bad_words("unsubscribe: each of \"subscriptionIds\" is a whole number");
    request.unsubscribe.push_back(*id);
  }
  return request;
}

std::string text_of(const Json& message) {
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace

Result<FoxgloveRequest> parse_foxglove(std::string_view text) {
  constexpr bool throws = false;
  const Json message = Json::parse(text, nullptr, throws);
  if (!message.is_object()) return bad_words("a message is a JSON object with an \"op\"");
  const auto op = message.find("op");
  if (op == message.end() || !op->is_string())
    return bad_words("a message is a JSON object with an \"op\"");
  if (*op == "subscribe") return subscriptions_in(message);
  if (*op == "unsubscribe") return ends_in(message);
  return FoxgloveRequest{};
}

std::string foxglove_server_info(std::string_view name, std::string_view session) {
  return text_of({{"op", "serverInfo"},
                  {"name", name},
                  {"capabilities", Json::array()},
                  {"metadata", Json::object()},
                  {"sessionId", session}});
}

std::string foxglove_advertisement(std::span<const FoxgloveChannel> channels) {
  Json list = Json::array();
  for (const FoxgloveChannel& channel : channels)
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.type},
                    {"schema", channel.schema},
                    {"schemaEncoding", "ros2msg"}});
  return text_of({{"op", "advertise"}, {"channels", list}});
}

std::string foxglove_warning(std::string_view message) {
  return text_of({{"op", "status"}, {"level", 1}, {"message", message}});
}

} // namespace nendo::web
