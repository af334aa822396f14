#include "ros2/participant.hpp"

#include <array>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <dds/dds.h>

#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "ros/types.hpp"
#include "ros2/dds_messages.hpp"
#include "ros2/this_machine.hpp"

namespace nendo::ros2 {
namespace {

enum class Channel : std::uint8_t { joint_states, tf, tf_static, left, right, diagnostics };
constexpr std::size_t channel_count = 6;

struct TopicOf {
  ros::Topic topic;
  const dds_topic_descriptor_t* descriptor;
};

TopicOf topic_of(Channel channel) noexcept {
  switch (channel) {
  case Channel::joint_states:
    return {ros::joint_states_topic, &sensor_msgs_msg_dds__JointState__desc};
  case Channel::tf:
    return {ros::tf_topic, &tf2_msgs_msg_dds__TFMessage__desc};
  case Channel::tf_static:
    return {ros::tf_static_topic, &tf2_msgs_msg_dds__TFMessage__desc};
  case Channel::left:
    return {ros::joints_topic(Side::left), &geometry_msgs_msg_dds__PoseArray__desc};
  case Channel::right:
    return {ros::joints_topic(Side::right), &geometry_msgs_msg_dds__PoseArray__desc};
  case Channel::diagnostics:
    break;
  }
  return {ros::diagnostics_topic, &diagnostic_msgs_msg_dds__DiagnosticArray__desc};
}

/// Keeps what DDS logs while it opens, for the error; later lines are notes. Thread-safe.
class DdsLog {
public:
  DdsLog() { dds_set_log_sink(&DdsLog::take, this); }
  ~DdsLog() { dds_set_log_sink(nullptr, nullptr); }
  DdsLog(const DdsLog&) = delete;
  DdsLog& operator=(const DdsLog&) = delete;

  std::string first() {
    const std::lock_guard lock(mutex_);
    return first_;
  }
  void has_opened() {
    const std::lock_guard lock(mutex_);
    is_open_ = true;
  }

private:
  static void take(void* self, const dds_log_data_t* data) {
    constexpr int max_lines = 20; // of a network that fails in each write
    auto& log = *static_cast<DdsLog*>(self);
    const std::string line = printable(
        trimmed(std::string_view(data->message, data->size)
                    .substr(0, std::string_view(data->message, data->size).find_first_of("\n\0"))));
    const std::lock_guard lock(log.mutex_);
    if (log.first_.empty()) log.first_ = line;
    if (log.is_open_ && log.lines_++ < max_lines) cli::note("DDS: " + line);
  }

  std::mutex mutex_;
  std::string first_;
  bool is_open_ = false;
  int lines_ = 0;
};

using QosPointer = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

QosPointer qos_of(const ros::Topic& topic) {
  QosPointer qos(dds_create_qos(), &dds_delete_qos);
  const auto depth = static_cast<std::int32_t>(topic.qos.depth);
  const std::string hash = "typehash=" + std::string(topic.type.hash) + ";";
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, 0); // a write never waits
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  if (topic.qos.is_transient_local) {
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  dds_qset_writer_data_lifecycle(qos.get(), false); // as ROS: its end disposes of no message
  dds_qset_userdata(qos.get(), hash.data(), hash.size());
  return qos;
}

} // namespace

struct Participant::State {
  DdsLog log; // the first member, so that it sees the end of the domain
  dds_entity_t domain = 0;
  std::array<dds_entity_t, channel_count> writers{};
  DdsMessages messages;
  std::uint64_t refused = 0;

  ~State() {
    if (domain > 0) dds_delete(domain); // with all that is in it
  }

  /// Returns the error for this return code. The reason is only in the log of DDS.
  Error failed(const std::string& what, dds_return_t code) {
    std::string line = log.first();
    if (line.empty()) line = dds_strretcode(code);
    if (line.find("config") != std::string::npos) // "config: ..." or "... configuration file ..."
      return {Errc::usage, "CYCLONEDDS_URI: " + line};
    return {Errc::failed, "DDS: " + what + ": " + line};
  }

  Result<void> open(const DdsNetwork& network) {
    const std::vector<int> others = open_sockets();
    const auto hold = [&]() -> Result<void> {
      return network.is_this_machine_only ? hold_to_this_machine(others) : Result<void>();
    };
    domain = dds_create_domain(network.domain_id, network.config.c_str());
    if (domain < 0)
      return failed("no network (is an interface up?) for domain " +
                        std::to_string(network.domain_id),
                    domain);
    if (const auto held = hold(); !held) return held.error();
    const dds_entity_t participant = dds_create_participant(network.domain_id, nullptr, nullptr);
    if (participant < 0) return failed("no participant", participant);
    if (const auto held = hold(); !held) return held.error(); // it may have sockets of its own
    for (std::size_t at = 0; at < channel_count; ++at) {
      const TopicOf of = topic_of(static_cast<Channel>(at));
      const std::string name = "rt" + std::string(of.topic.name);
      const dds_entity_t topic =
          dds_create_topic(participant, of.descriptor, name.c_str(), nullptr, nullptr);
      if (topic < 0) return failed(name, topic);
      writers[at] = dds_create_writer(participant, topic, qos_of(of.topic).get(), nullptr);
      if (writers[at] < 0) return failed(name, writers[at]);
    }
    log.has_opened();
    return {};
  }

  template <class Message>
  void write(Channel channel, const Message& message) {
    if (dds_write(writers[static_cast<std::size_t>(channel)], &message) < 0) ++refused;
  }
};

Participant::Participant(std::unique_ptr<State> state) : state_(std::move(state)) {}
Participant::~Participant() = default;

Result<std::unique_ptr<Participant>> Participant::open(const DdsNetwork& network) {
  auto state = std::make_unique<State>();
  if (const auto opened = state->open(network); !opened) return opened.error();
  return std::unique_ptr<Participant>(new Participant(std::move(state)));
}

void Participant::joint_states(const ros::JointState& message) {
  state_->write(Channel::joint_states, state_->messages.of(message));
}
void Participant::transforms(const ros::TFMessage& message) {
  state_->write(Channel::tf, state_->messages.of(message));
}
void Participant::static_transforms(const ros::TFMessage& message) {
  state_->write(Channel::tf_static, state_->messages.of(message));
}
void Participant::poses(Side side, const ros::PoseArray& message) {
  state_->write(side == Side::left ? Channel::left : Channel::right, state_->messages.of(message));
}
void Participant::diagnostics(const ros::DiagnosticArray& message) {
  state_->write(Channel::diagnostics, state_->messages.of(message));
}

std::uint64_t Participant::refused() const noexcept {
  return state_->refused;
}

} // namespace nendo::ros2
