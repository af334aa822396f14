/* Prints what nendo-ros2 publishes, as Cyclone DDS receives it, for judge.py:
 *   J RECEIVED STAMP NAME=RADIANS ...   /joint_states; times in nanoseconds since 1970
 *   P RECEIVED STAMP TOPIC FRAME 7 numbers per joint ...
 *   T RECEIVED STAMP TOPIC PARENT>CHILD,7 numbers ...
 *   D RECEIVED STAMP LEVEL|NAME|MESSAGE ...
 * usage: cyclone_subscriber   until SIGTERM */
#define _POSIX_C_SOURCE 200809L
#include <dds/dds.h>
#include <ros_messages.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { TOPICS = 6, AT_ONCE = 16 };
static volatile sig_atomic_t stop = 0;
static void on_signal(int number) {
  (void)number;
  stop = 1;
}

static long long now_ns(void) {
  struct timespec time;
  clock_gettime(CLOCK_REALTIME, &time);
  return 1000000000LL * time.tv_sec + time.tv_nsec;
}
static void begin(char kind, long long received, const std_msgs_msg_dds__Header_* header) {
  printf("%c %lld %lld", kind, received,
         1000000000LL * header->stamp_.sec_ + header->stamp_.nanosec_);
}
static void print_joint_state(const char* topic, const void* sample, long long received) {
  const sensor_msgs_msg_dds__JointState_* message = sample;
  uint32_t at;
  (void)topic;
  begin('J', received, &message->header_);
  for (at = 0; at < message->name_._length; ++at)
    printf(" %s=%.17g", message->name_._buffer[at], message->position_._buffer[at]);
}
static void print_poses(const char* topic, const void* sample, long long received) {
  const geometry_msgs_msg_dds__PoseArray_* message = sample;
  uint32_t at;
  begin('P', received, &message->header_);
  printf(" %s %s", topic, message->header_.frame_id_);
  for (at = 0; at < message->poses_._length; ++at) {
    const geometry_msgs_msg_dds__Pose_* pose = &message->poses_._buffer[at];
    printf(" %.17g %.17g %.17g %.17g %.17g %.17g %.17g", pose->position_.x_, pose->position_.y_,
           pose->position_.z_, pose->orientation_.x_, pose->orientation_.y_, pose->orientation_.z_,
           pose->orientation_.w_);
  }
}
static void print_transforms(const char* topic, const void* sample, long long received) {
  const tf2_msgs_msg_dds__TFMessage_* message = sample;
  uint32_t at;
  if (message->transforms_._length == 0) return;
  begin('T', received, &message->transforms_._buffer[0].header_);
  printf(" %s", topic);
  for (at = 0; at < message->transforms_._length; ++at) {
    const geometry_msgs_msg_dds__TransformStamped_* one = &message->transforms_._buffer[at];
    printf(" %s>%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", one->header_.frame_id_,
           one->child_frame_id_, one->transform_.translation_.x_, one->transform_.translation_.y_,
           one->transform_.translation_.z_, one->transform_.rotation_.x_,
           one->transform_.rotation_.y_, one->transform_.rotation_.z_,
           one->transform_.rotation_.w_);
  }
}
static void print_diagnostics(const char* topic, const void* sample, long long received) {
  const diagnostic_msgs_msg_dds__DiagnosticArray_* message = sample;
  uint32_t at;
  (void)topic;
  begin('D', received, &message->header_);
  for (at = 0; at < message->status_._length; ++at)
    printf("\t%d|%s|%s", message->status_._buffer[at].level_, message->status_._buffer[at].name_,
           message->status_._buffer[at].message_);
}

static const struct {
  const char* name;
  const dds_topic_descriptor_t* descriptor;
  void (*print)(const char* topic, const void* sample, long long received);
} topics[TOPICS] = {
    {"rt/joint_states", &sensor_msgs_msg_dds__JointState__desc, print_joint_state},
    {"rt/nendo/left/joints", &geometry_msgs_msg_dds__PoseArray__desc, print_poses},
    {"rt/nendo/right/joints", &geometry_msgs_msg_dds__PoseArray__desc, print_poses},
    {"rt/tf", &tf2_msgs_msg_dds__TFMessage__desc, print_transforms},
    {"rt/tf_static", &tf2_msgs_msg_dds__TFMessage__desc, print_transforms},
    {"rt/diagnostics", &diagnostic_msgs_msg_dds__DiagnosticArray__desc, print_diagnostics},
};

/* The domain is that of ROS_DOMAIN_ID; CYCLONEDDS_URI may have settings. */
int main(void) {
  const char* domain = getenv("ROS_DOMAIN_ID");
  const struct timespec pause = {0, 200000};
  const struct sigaction action = {.sa_handler = on_signal};
  dds_entity_t participant, readers[TOPICS];
  dds_qos_t* qos = dds_create_qos();
  int at, sample;
  sigaction(SIGTERM, &action, NULL);
  participant =
      dds_create_participant(domain == NULL ? 0 : (dds_domainid_t)atoi(domain), NULL, NULL);
  if (participant < 0) return fprintf(stderr, "%s\n", dds_strretcode(participant)), 1;
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_INFINITY);
  for (at = 0; at < TOPICS; ++at) {
    const dds_entity_t topic =
        dds_create_topic(participant, topics[at].descriptor, topics[at].name, NULL, NULL);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 100);
    dds_qset_durability(qos, at == 4 ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    readers[at] = dds_create_reader(participant, topic, qos, NULL);
    if (readers[at] < 0) return fprintf(stderr, "%s\n", dds_strretcode(readers[at])), 1;
  }
  while (!stop) {
    for (at = 0; at < TOPICS; ++at) {
      void* samples[AT_ONCE] = {NULL};
      dds_sample_info_t infos[AT_ONCE];
      const int count = dds_take(readers[at], samples, infos, AT_ONCE, AT_ONCE);
      const long long received = now_ns();
      for (sample = 0; sample < count; ++sample)
        if (infos[sample].valid_data) {
          topics[at].print(topics[at].name, samples[sample], received);
          printf("\n");
        }
      if (count > 0) dds_return_loan(readers[at], samples, count);
    }
    nanosleep(&pause, NULL);
  }
  fflush(stdout);
  dds_delete(participant);
  return 0;
}
