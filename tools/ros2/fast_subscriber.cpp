// Prints what nendo-ros2 publishes, as Fast DDS receives it, for judge.py. The lines are those of
// cyclone_subscriber.c, and for each writer that is discovered:
//   U TOPIC TYPE USER_DATA
// usage: fast_subscriber   until SIGTERM. ROS_DOMAIN_ID is the domain.

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#if __has_include("ros_messagesPubSubTypes.hpp") // since Fast DDS 3
#include "ros_messagesPubSubTypes.hpp"
#define NENDO_FAST_DDS 3
#else
#include "ros_messagesPubSubTypes.h"
#define NENDO_FAST_DDS 2
#endif

namespace {

using namespace eprosima::fastdds::dds;

volatile std::sig_atomic_t stop = 0;
std::mutex output;

long long now_ns() {
  timespec time{};
  clock_gettime(CLOCK_REALTIME, &time);
  return 1'000'000'000LL * time.tv_sec + time.tv_nsec;
}

class Discovery : public DomainParticipantListener {
public:
#if NENDO_FAST_DDS == 3
  void on_data_writer_discovery(DomainParticipant*, eprosima::fastdds::rtps::WriterDiscoveryStatus,
                                const PublicationBuiltinTopicData& info, bool&) override {
    print(info.topic_name.to_string(), info.type_name.to_string(), info.user_data);
  }
#else
  void on_publisher_discovery(DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& found) override {
    print(found.info.topicName().to_string(), found.info.typeName().to_string(),
          found.info.m_qos.m_userData);
  }
#endif

private:
  template <class Bytes>
  static void print(const std::string& topic, const std::string& type, const Bytes& data) {
    const std::lock_guard lock(output);
    std::printf("U %s %s %s\n", topic.c_str(), type.c_str(),
                std::string(data.begin(), data.end()).c_str());
  }
};

void begin(char kind, long long received, const std_msgs::msg::dds_::Header_& header) {
  std::printf("%c %lld %lld", kind, received,
              1'000'000'000LL * header.stamp_().sec_() + header.stamp_().nanosec_());
}

void print(const std::string&, const sensor_msgs::msg::dds_::JointState_& message,
           long long received) {
  begin('J', received, message.header_());
  for (std::size_t at = 0; at < message.name_().size(); ++at)
    std::printf(" %s=%.17g", message.name_()[at].c_str(), message.position_()[at]);
}
void print(const std::string& topic, const geometry_msgs::msg::dds_::PoseArray_& message,
           long long received) {
  begin('P', received, message.header_());
  std::printf(" %s %s", topic.c_str(), message.header_().frame_id_().c_str());
  for (const auto& pose : message.poses_()) {
    const auto& at = pose.position_();
    const auto& turn = pose.orientation_();
    std::printf(" %.17g %.17g %.17g %.17g %.17g %.17g %.17g", at.x_(), at.y_(), at.z_(), turn.x_(),
                turn.y_(), turn.z_(), turn.w_());
  }
}
void print(const std::string& topic, const tf2_msgs::msg::dds_::TFMessage_& message,
           long long received) {
  if (message.transforms_().empty()) return;
  begin('T', received, message.transforms_()[0].header_());
  std::printf(" %s", topic.c_str());
  for (const auto& one : message.transforms_()) {
    const auto& at = one.transform_().translation_();
    const auto& turn = one.transform_().rotation_();
    std::printf(" %s>%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g",
                one.header_().frame_id_().c_str(), one.child_frame_id_().c_str(), at.x_(), at.y_(),
                at.z_(), turn.x_(), turn.y_(), turn.z_(), turn.w_());
  }
}
void print(const std::string&, const diagnostic_msgs::msg::dds_::DiagnosticArray_& message,
           long long received) {
  begin('D', received, message.header_());
  for (const auto& status : message.status_())
    std::printf("\t%d|%s|%s", static_cast<int>(status.level_()), status.name_().c_str(),
                status.message_().c_str());
}

template <class Message, class Type>
class Reader {
public:
  Reader(DomainParticipant& participant, std::string topic) : topic_(std::move(topic)) {
    const TypeSupport type(new Type());
    type.register_type(&participant);
    auto* const own = participant.create_topic(topic_, type.get_type_name(), TOPIC_QOS_DEFAULT);
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.history().kind = KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 100;
    if (topic_ == "rt/tf_static") qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
    reader_ = participant.create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(own, qos);
    if (reader_ == nullptr) std::exit(1);
  }

  void take() {
    SampleInfo info;
    while (reader_->take_next_sample(&message_, &info) == ok()) {
      if (!info.valid_data) continue;
      const long long received = now_ns();
      const std::lock_guard lock(output);
      print(topic_, message_, received);
      std::printf("\n");
    }
  }

private:
  static auto ok() {
#if NENDO_FAST_DDS == 3
    return RETCODE_OK;
#else
    return ReturnCode_t::RETCODE_OK;
#endif
  }

  std::string topic_;
  DataReader* reader_ = nullptr;
  Message message_;
};

} // namespace

int main() {
  using diagnostic_msgs::msg::dds_::DiagnosticArray_;
  using diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType;
  using geometry_msgs::msg::dds_::PoseArray_;
  using geometry_msgs::msg::dds_::PoseArray_PubSubType;
  using sensor_msgs::msg::dds_::JointState_;
  using sensor_msgs::msg::dds_::JointState_PubSubType;
  using tf2_msgs::msg::dds_::TFMessage_;
  using tf2_msgs::msg::dds_::TFMessage_PubSubType;
  std::signal(SIGTERM, [](int) { stop = 1; });
  const char* const domain = std::getenv("ROS_DOMAIN_ID");
  Discovery discovery;
  auto* const participant = DomainParticipantFactory::get_instance()->create_participant(
      domain == nullptr ? 0 : static_cast<DomainId_t>(std::atoi(domain)), PARTICIPANT_QOS_DEFAULT,
      &discovery, StatusMask::none());
  if (participant == nullptr) return 1;
  Reader<JointState_, JointState_PubSubType> joint_states(*participant, "rt/joint_states");
  Reader<PoseArray_, PoseArray_PubSubType> left(*participant, "rt/nendo/left/joints");
  Reader<PoseArray_, PoseArray_PubSubType> right(*participant, "rt/nendo/right/joints");
  Reader<TFMessage_, TFMessage_PubSubType> tf(*participant, "rt/tf");
  Reader<TFMessage_, TFMessage_PubSubType> tf_static(*participant, "rt/tf_static");
  Reader<DiagnosticArray_, DiagnosticArray_PubSubType> diagnostics(*participant, "rt/diagnostics");
  while (stop == 0) {
    joint_states.take();
    left.take();
    right.take();
    tf.take();
    tf_static.take();
    diagnostics.take();
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  std::fflush(stdout);
  return 0;
}
