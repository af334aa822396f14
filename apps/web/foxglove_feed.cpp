#include "web/foxglove_feed.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include <nendo/base/byte_writer.hpp>

#include "ros/cdr.hpp"
#include "ros/types.hpp"
#include "web/wire.hpp"

namespace nendo::web {
namespace {

constexpr std::array foxglove_topic_table{ros::joint_states_topic, ros::tf_topic,
                                          ros::tf_static_topic, ros::model_topic};
constexpr std::byte message_data{1}; ///< the kind of a binary message
constexpr std::size_t subscription_at = 1;
constexpr std::array<double, 4> clay_colour{0.78, 0.6, 0.48, 1.0};

} // namespace

FoxgloveMessages::FoxgloveMessages() {
  model_.frame_id = hand_messages_.stage();
  model_.id = "model";
  model_.colour = clay_colour;
}

template <class Message>
void FoxgloveMessages::set(FoxgloveTopic topic, const Message& message, std::int64_t utc_ns) {
  Latest& latest = latest_[static_cast<std::size_t>(topic) - 1];
  latest.bytes.clear();
  latest.bytes.push_back(message_data);
  ByteWriter head(latest.bytes);
  head.u32_le(0); // of the subscription, which message() writes
  head.u64_le(static_cast<std::uint64_t>(std::max(utc_ns, std::int64_t{0})));
  ros::append_cdr(message, latest.bytes);
  ++latest.version;
}

void FoxgloveMessages::begin(std::span<const std::byte> model_message, std::int64_t utc_ns) {
  for (Latest& latest : latest_)
    latest = {};
  model_.corners.clear();
  shape_.clear();
  set(FoxgloveTopic::tf_static, hand_messages_.static_transforms(utc_ns), utc_ns);
  ModelHead head;
  std::memcpy(&head, model_message.data(), sizeof head);
  if (head.vertices == 0 || head.triangles == 0 || head.vertices > max_model_vertices) return;
  const std::size_t bones = ((head.flags & 1U) + (head.flags >> 1U & 1U)) * bones_bytes;
  const std::size_t corners_at = sizeof head + bones + 16 * std::size_t{head.vertices};
  model_.corners.resize(3 * std::size_t{head.triangles});
  std::memcpy(model_.corners.data(), model_message.data() + corners_at, 4 * model_.corners.size());
  model_.points.resize(head.vertices);
  unit_m_ = head.unit / head.units_per_metre;
  for (std::size_t axis = 0; axis < 3; ++axis)
    origin_m_[axis] = head.origin[axis] / head.units_per_metre;
}

bool FoxgloveMessages::has(std::uint32_t channel) const noexcept {
  return channel >= 1 && channel <= foxglove_topics &&
         (has_model() || channel != static_cast<std::uint32_t>(FoxgloveTopic::model));
}

std::vector<FoxgloveChannel> FoxgloveMessages::channels() const {
  std::vector<FoxgloveChannel> channels;
  for (std::uint32_t id = 1; id <= foxglove_topics; ++id) {
    const ros::Topic& topic = foxglove_topic_table[id - 1];
    if (has(id))
      channels.push_back(
          {id, std::string(topic.name), std::string(topic.type.name), ros::schema_of(topic.type)});
  }
  return channels;
}

void FoxgloveMessages::set_hands(std::span<const ros::HandState> hands, std::int64_t utc_ns) {
  hand_messages_.joint_states(hands, utc_ns, joints_);
  set(FoxgloveTopic::joint_states, joints_, utc_ns);
  hand_messages_.transforms(hands, utc_ns, tf_);
  set(FoxgloveTopic::tf, tf_, utc_ns);
}

void FoxgloveMessages::set_shape(std::span<const float> xyz, std::int64_t utc_ns) {
  if (!has_model() || xyz.size() != 3 * model_.points.size()) return;
  if (std::equal(xyz.begin(), xyz.end(), shape_.begin(), shape_.end())) return;
  shape_.assign(xyz.begin(), xyz.end());
  const auto metres = [&](std::size_t at, std::size_t axis) {
    return origin_m_[axis] + unit_m_ * static_cast<double>(xyz[3 * at + axis]);
  };
  // In the axes of the frame `stage`.
  for (std::size_t at = 0; at < model_.points.size(); ++at)
    model_.points[at] = {-metres(at, 2), -metres(at, 0), metres(at, 1)};
  model_.stamp = ros::time_of(utc_ns);
  set(FoxgloveTopic::model, model_, utc_ns);
}

std::vector<std::byte> FoxgloveMessages::message(FoxgloveTopic topic,
                                                 std::uint32_t subscription) const {
  std::vector<std::byte> bytes = latest(topic).bytes;
  for (std::size_t at = 0; at < sizeof subscription; ++at, subscription >>= 8U)
    bytes[subscription_at + at] = static_cast<std::byte>(subscription & 0xFFU);
  return bytes;
}

std::vector<std::string> FoxgloveFeed::take(const FoxgloveRequest& request,
                                            const FoxgloveMessages& messages) {
  std::vector<std::string> warnings;
  const auto with_id = [this](std::uint32_t id) {
    return std::ranges::find(subscribed_, id, &Subscribed::id);
  };
  for (const auto& [id, channel] : request.subscribe) {
    if (!messages.has(channel))
      warnings.push_back("there is no channel " + std::to_string(channel));
    else if (with_id(id) != subscribed_.end())
      warnings.push_back("subscription " + std::to_string(id) + " is used already");
    else if (subscribed_.size() == max_subscriptions)
      warnings.push_back("a client has at most " + std::to_string(max_subscriptions) +
                         " subscriptions");
    else
      subscribe(id, static_cast<FoxgloveTopic>(channel), messages);
  }
  for (const std::uint32_t id : request.unsubscribe)
    if (const auto found = with_id(id); found != subscribed_.end()) subscribed_.erase(found);
  return warnings;
}

// The last hands before a subscription may be old. The others are as they were.
void FoxgloveFeed::subscribe(std::uint32_t id, FoxgloveTopic topic,
                             const FoxgloveMessages& messages) {
  const bool is_lasting = topic == FoxgloveTopic::tf_static || topic == FoxgloveTopic::model;
  subscribed_.push_back({id, topic, is_lasting ? 0 : messages.version(topic)});
}

bool FoxgloveFeed::has(FoxgloveTopic topic) const noexcept {
  return std::ranges::find(subscribed_, topic, &Subscribed::topic) != subscribed_.end();
}

std::optional<FoxgloveFeed::Due> FoxgloveFeed::next_due(const FoxgloveMessages& messages,
                                                        bool with_model) noexcept {
  for (Subscribed& one : subscribed_) {
    if (one.topic == FoxgloveTopic::model && !with_model) continue;
    const std::uint64_t newest = messages.version(one.topic);
    if (std::exchange(one.sent, newest) != newest) return Due{one.topic, one.id};
  }
  return std::nullopt;
}

} // namespace nendo::web
