#pragma once
// What clients of Foxglove's protocol get: the newest messages of each channel, made once for all
// clients, and the subscriptions of each. Independent of sockets.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ros/hand_messages.hpp"
#include "ros/scene.hpp"
#include "web/foxglove_words.hpp"

namespace nendo::web {

/// The numbers of the channels.
enum class FoxgloveTopic : std::uint32_t { joint_states = 1, tf = 2, tf_static = 3, model = 4 };
inline constexpr std::size_t foxglove_topics = 4;

/// The newest message of each channel. For one thread.
class FoxgloveMessages {
public:
  /// Models with more vertices are not shown: a message would have more than 14 MB.
  static constexpr std::size_t max_model_vertices = 300'000;

  FoxgloveMessages();

  /// Begins with another loop, whose model_message() this is. Forgets all messages but that of
  /// /tf_static. A message without vertices, or with more than max_model_vertices, has no model.
  void begin(std::span<const std::byte> model_message, std::int64_t utc_ns);
  bool has_model() const noexcept { return !model_.corners.empty(); }
  /// The channels that there are.
  std::vector<FoxgloveChannel> channels() const;
  bool has(std::uint32_t channel) const noexcept;

  /// Make messages of the newest hands and of the newest shape, which is 3 floats per vertex as in
  /// the model message. A shape that equals the previous one makes none.
  void set_hands(std::span<const ros::HandState> hands, std::int64_t utc_ns);
  void set_shape(std::span<const float> xyz, std::int64_t utc_ns);

  /// Counts the messages of a channel; 0: there was none.
  std::uint64_t version(FoxgloveTopic topic) const noexcept { return latest(topic).version; }
  /// Returns the newest message of a channel for a subscription, as a binary message of the
  /// protocol.
  std::vector<std::byte> message(FoxgloveTopic topic, std::uint32_t subscription) const;

private:
  struct Latest {
    std::uint64_t version = 0;
    std::vector<std::byte> bytes; ///< with space for the subscription
  };
  const Latest& latest(FoxgloveTopic topic) const noexcept {
    return latest_[static_cast<std::size_t>(topic) - 1];
  }
  template <class Message>
  void set(FoxgloveTopic topic, const Message& message, std::int64_t utc_ns);

  ros::HandMessages hand_messages_;
  ros::JointState joints_;
  ros::TFMessage tf_;
  ros::SceneSurface model_;
  std::vector<float> shape_; ///< the shape of the newest message
  double unit_m_ = 1.0;      ///< length of a shape's unit on the stage
  std::array<double, 3> origin_m_{};
  std::array<Latest, foxglove_topics> latest_;
};

/// The subscriptions of a client.
class FoxgloveFeed {
public:
  static constexpr std::size_t max_subscriptions = 16;

  /// Changes the subscriptions. Returns warnings about those that are not possible:
  /// channels that do not exist, numbers that are used already, and more than max_subscriptions.
  std::vector<std::string> take(const FoxgloveRequest& request, const FoxgloveMessages& messages);
  bool has(FoxgloveTopic topic) const noexcept;
  bool has_hands() const noexcept {
    return has(FoxgloveTopic::joint_states) || has(FoxgloveTopic::tf);
  }
  /// Returns the next subscription whose newest message has not been sent, and marks it as sent;
  /// nothing if there is none. Skips the model if `with_model` is false.
  struct Due {
    FoxgloveTopic topic{};
    std::uint32_t subscription = 0;
  };
  std::optional<Due> next_due(const FoxgloveMessages& messages, bool with_model) noexcept;

private:
  void subscribe(std::uint32_t id, FoxgloveTopic topic, const FoxgloveMessages& messages);

  struct Subscribed {
    std::uint32_t id = 0;
    FoxgloveTopic topic{};
    std::uint64_t sent = 0; ///< FoxgloveMessages::version()
  };
  std::vector<Subscribed> subscribed_;
};

} // namespace nendo::web
