// nendo-ros2 as a user runs it, beside nendo serve, and what another participant of DDS receives.

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <dds/dds.h>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <nendo_publish.h>
#include <ros_messages.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/hand/joints.hpp>

#include "support/eventually.hpp"
#include "support/program.hpp"
#include "support/runtime_folder.hpp"
#include "support/shell.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace ros2_program_test {

using namespace nendo;
using namespace nendo::test;
using JointState = sensor_msgs_msg_dds__JointState_;
using TFMessage = tf2_msgs_msg_dds__TFMessage_;
using PoseArray = geometry_msgs_msg_dds__PoseArray_;
using DiagnosticArray = diagnostic_msgs_msg_dds__DiagnosticArray_;

namespace {

/// A domain of this process. Ports of greater ones may be those of other programs.
int domain_id() {
  return 1 + ::getpid() % 90;
}

std::string segment_name(const std::string& what) {
  return "test-" + std::to_string(::getpid()) + "-ros2-" + what;
}

/// A running nendo-ros2, which the destructor kills.
class Ros2Program {
public:
  explicit Ros2Program(const std::string& arguments) {
    const std::string command = "ROS_DOMAIN_ID=" + std::to_string(domain_id()) +
                                " exec " NENDO_ROS2_PROGRAM " " + arguments;
    const std::string out = out_path().string();
    id_ = ::fork();
    if (id_ != 0) return;
    // Between fork and exec, only calls are made that are safe in a child of a threaded program.
    const int file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
    ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  ~Ros2Program() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    ::waitpid(id_, nullptr, 0);
  }
  Ros2Program(const Ros2Program&) = delete;
  Ros2Program& operator=(const Ros2Program&) = delete;

  std::string out() const { return contents(out_path()); }
  /// Ends it as Ctrl-C does. Returns its exit code, or -1.
  int interrupt() {
    ::kill(id_, SIGINT);
    int status = -1;
    if (!eventually([&] { return ::waitpid(id_, &status, WNOHANG) != 0; })) return -1;
    id_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

private:
  std::filesystem::path out_path() const { return folder_.path() / "out"; }

  TemporaryFolder folder_;
  pid_t id_ = 0;
};

std::vector<std::string> serve_arguments(const std::string& name) {
  return {"serve", "sim:grasp?hand=left", "sim:pinch?hand=right", "--right-wrist", "sim:orbit",
          "--to",  "shm:" + name};
}

/// A participant as those of ROS 2 with ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST.
class Listener {
public:
  Listener() {
    constexpr const char* config =
        "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General><Discovery>"
        "<ParticipantIndex>auto</ParticipantIndex><Peers><Peer address=\"localhost\"/></Peers>"
        "</Discovery></Domain></CycloneDDS>";
    domain_ = dds_create_domain(static_cast<dds_domainid_t>(domain_id()), config);
    REQUIRE(domain_ > 0);
    participant_ =
        dds_create_participant(static_cast<dds_domainid_t>(domain_id()), nullptr, nullptr);
    REQUIRE(participant_ > 0);
  }
  ~Listener() { dds_delete(domain_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  dds_entity_t participant() const { return participant_; }

private:
  dds_entity_t domain_ = 0;
  dds_entity_t participant_ = 0;
};

template <class Message>
class Topic {
public:
  Topic(const Listener& listener, const dds_topic_descriptor_t& descriptor, const char* name,
        bool is_transient_local = false) {
    const std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)> qos(dds_create_qos(),
                                                                    &dds_delete_qos);
    dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_INFINITY);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    if (is_transient_local) dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    const dds_entity_t topic =
        dds_create_topic(listener.participant(), &descriptor, name, nullptr, nullptr);
    reader_ = dds_create_reader(listener.participant(), topic, qos.get(), nullptr);
    REQUIRE(reader_ > 0);
  }

  /// Calls `visit` with each new message. Returns their number.
  template <class Visit>
  int take(Visit visit) {
    std::array<void*, 16> samples{};
    std::array<dds_sample_info_t, 16> infos{};
    const int count = dds_take(reader_, samples.data(), infos.data(), samples.size(),
                               static_cast<std::uint32_t>(samples.size()));
    for (int at = 0; at < count; ++at)
      if (infos[static_cast<std::size_t>(at)].valid_data)
        visit(*static_cast<const Message*>(samples[static_cast<std::size_t>(at)]));
    if (count > 0) dds_return_loan(reader_, samples.data(), count);
    return std::max(count, 0);
  }
  int take() {
    return take([](const Message&) {});
  }

private:
  dds_entity_t reader_ = 0;
};

/// All records of a segment while it lives, by nendo_publish.h alone.
class Records {
public:
  explicit Records(const std::string& name) {
    const std::string path = "/dev/shm/nendo-" + name;
    REQUIRE(eventually([&] {
      file_ = UniqueFd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
      return file_.is_open();
    }));
    struct stat status{};
    REQUIRE(::fstat(file_.get(), &status) == 0);
    bytes_ = static_cast<std::size_t>(status.st_size);
    base_ = ::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, file_.get(), 0);
    REQUIRE(base_ != MAP_FAILED);
    REQUIRE(nendo_publish_is_usable(base_, bytes_));
  }
  ~Records() { ::munmap(base_, bytes_); }
  Records(const Records&) = delete;
  Records& operator=(const Records&) = delete;

  struct Entry {
    nendo_publish_record record;
    nendo_publish_states states;
  };
  void collect() {
    for (const std::uint64_t newest = nendo_publish_newest(base_); next_ <= newest; ++next_) {
      Entry entry;
      if (nendo_publish_read(base_, next_, &entry.record, nullptr, 0) != 0 &&
          nendo_publish_read_states(base_, next_, &entry.states) != 0)
        entries_.push_back(entry);
      else
        ++missed_;
    }
  }
  const std::vector<Entry>& all() const { return entries_; }
  /// Returns the number of records that were overwritten before this read them.
  std::size_t missed() const { return missed_; }

private:
  UniqueFd file_;
  void* base_ = nullptr;
  std::size_t bytes_ = 0;
  std::uint64_t next_ = 1;
  std::size_t missed_ = 0;
  std::vector<Entry> entries_;
};

/// Waits longer than other tests: participants repeat their announcements after 8 s and 30 s, if
/// one was lost on a busy machine.
template <class Condition>
bool is_received(const Condition& condition) {
  return eventually(condition) || eventually(condition);
}

using Pose = std::array<double, 7>; ///< x y z, then x y z w

/// A joint of the segment, whose axes are right, up and back, in the axes of REP-103.
Pose ros_pose(const nendo_publish_joint& joint) {
  const std::array<double, 3> at{double{joint.position[0]}, double{joint.position[1]},
                                 double{joint.position[2]}};
  const std::array<double, 4> turn{double{joint.orientation[0]}, double{joint.orientation[1]},
                                   double{joint.orientation[2]}, double{joint.orientation[3]}};
  return {-at[2], -at[0], at[1], -turn[2], -turn[0], turn[1], turn[3]};
}

std::vector<Pose> poses_of(const nendo_publish_hand& hand) {
  std::vector<Pose> poses;
  for (const nendo_publish_joint& joint : hand.joints)
    poses.push_back(ros_pose(joint));
  return poses;
}

Pose joined(const Pose& a, const Pose& b) {
  const auto rotated = [&a](double x, double y, double z) {
    // v + 2 w (q x v) + 2 q x (q x v)
    const double cx = a[4] * z - a[5] * y, cy = a[5] * x - a[3] * z, cz = a[3] * y - a[4] * x;
    return std::array{x + 2 * (a[6] * cx + a[4] * cz - a[5] * cy),
                      y + 2 * (a[6] * cy + a[5] * cx - a[3] * cz),
                      z + 2 * (a[6] * cz + a[3] * cy - a[4] * cx)};
  };
  const auto at = rotated(b[0], b[1], b[2]);
  return {a[0] + at[0],
          a[1] + at[1],
          a[2] + at[2],
          a[6] * b[3] + a[3] * b[6] + a[4] * b[5] - a[5] * b[4],
          a[6] * b[4] - a[3] * b[5] + a[4] * b[6] + a[5] * b[3],
          a[6] * b[5] + a[3] * b[4] - a[4] * b[3] + a[5] * b[6],
          a[6] * b[6] - a[3] * b[3] - a[4] * b[4] - a[5] * b[5]};
}

/// The largest difference; q and -q are the same rotation.
double difference(const Pose& a, const Pose& b) {
  double most = 0.0, same = 0.0, opposite = 0.0;
  for (std::size_t at = 0; at < 3; ++at)
    most = std::max(most, std::abs(a[at] - b[at]));
  for (std::size_t at = 3; at < 7; ++at) {
    same = std::max(same, std::abs(a[at] - b[at]));
    opposite = std::max(opposite, std::abs(a[at] + b[at]));
  }
  return std::max(most, std::min(same, opposite));
}

Pose pose_of(const geometry_msgs_msg_dds__Transform_& transform) {
  const auto& at = transform.translation_;
  const auto& turn = transform.rotation_;
  return {at.x_, at.y_, at.z_, turn.x_, turn.y_, turn.z_, turn.w_};
}

/// Returns the pose of each frame in the root. Frames may come before their parents.
std::map<std::string, Pose> frames_of(const TFMessage& message, const std::string& root) {
  std::map<std::string, std::pair<std::string, Pose>> in_parent;
  for (std::uint32_t at = 0; at < message.transforms_._length; ++at) {
    const auto& one = message.transforms_._buffer[at];
    in_parent[one.child_frame_id_] = {one.header_.frame_id_, pose_of(one.transform_)};
  }
  std::map<std::string, Pose> frames{{root, {0, 0, 0, 0, 0, 0, 1}}};
  for (std::size_t depth = 0; depth < in_parent.size() && frames.size() <= in_parent.size();
       ++depth)
    for (const auto& [frame, own] : in_parent) {
      const auto parent = frames.find(own.first);
      if (parent != frames.end()) frames[frame] = joined(parent->second, own.second);
    }
  return frames;
}

/// Returns whether the frames of both hands are where the record has them.
bool are_of(const Records::Entry& entry, const std::map<std::string, Pose>& frames,
            const std::string& prefix) {
  constexpr double rounding = 1e-5; // of the segment's floats, along a chain of joints
  for (const std::size_t side : {0U, 1U}) {
    const std::string hand = prefix + (side == 0 ? "left_" : "right_");
    const auto is_far = [&](const std::string& name, const nendo_publish_joint& joint) {
      return difference(frames.at(hand + name), ros_pose(joint)) > rounding;
    };
    if (is_far("forearm", entry.states.hands[side].forearm)) return false;
    for (std::size_t joint = 0; joint < NENDO_PUBLISH_JOINTS; ++joint)
      if (is_far(std::string(hand::name_of(static_cast<hand::Joint>(joint))),
                 entry.record.hands[side].joints[joint]))
        return false;
  }
  return true;
}

using Angles = std::map<std::string, double>;

Angles measured_angles(const nendo_publish_states& states, const std::string& prefix) {
  Angles angles;
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t at = 0; at < NENDO_PUBLISH_ANGLES; ++at)
      if ((states.hands[side].measured >> at & 1U) != 0)
        angles[prefix + (side == 0 ? "left_" : "right_") + std::string(hand::angle_names[at])] =
            states.hands[side].angles[at];
  return angles;
}

} // namespace

TEST_SUITE("ros2_program") {
  TEST_CASE("each message has the values of a record of the segment, bit for bit") {
    const RuntimeFolder folder;
    const std::string name = segment_name("values");
    const Listener listener;
    Topic<JointState> joint_states(listener, sensor_msgs_msg_dds__JointState__desc,
                                   "rt/joint_states");
    Topic<TFMessage> tf(listener, tf2_msgs_msg_dds__TFMessage__desc, "rt/tf");
    Topic<PoseArray> poses(listener, geometry_msgs_msg_dds__PoseArray__desc,
                           "rt/nendo/right/joints");
    const Program run(serve_arguments(name));
    Records records(name);
    Ros2Program program("--segment " + name + " --prefix op/");
    std::vector<Angles> received_angles;
    std::vector<std::vector<Pose>> received_poses;
    std::vector<std::map<std::string, Pose>> received_frames; // in the stage
    const auto collect = [&] {
      records.collect();
      joint_states.take([&](const JointState& message) {
        REQUIRE(message.name_._length == message.position_._length);
        Angles angles;
        for (std::uint32_t at = 0; at < message.name_._length; ++at)
          angles[message.name_._buffer[at]] = message.position_._buffer[at];
        received_angles.push_back(angles);
      });
      poses.take([&](const PoseArray& message) {
        CHECK(std::string(message.header_.frame_id_) == "op/stage");
        auto& all = received_poses.emplace_back();
        for (std::uint32_t at = 0; at < message.poses_._length; ++at) {
          const auto& pose = message.poses_._buffer[at];
          all.push_back({pose.position_.x_, pose.position_.y_, pose.position_.z_,
                         pose.orientation_.x_, pose.orientation_.y_, pose.orientation_.z_,
                         pose.orientation_.w_});
        }
      });
      tf.take([&](const TFMessage& message) {
        received_frames.push_back(frames_of(message, "op/stage"));
      });
      return received_angles.size() > 200 && received_poses.size() > 200 &&
             received_frames.size() > 200;
    };
    const bool is_complete = is_received(collect);
    REQUIRE(is_complete);
    records.collect();
    REQUIRE(program.interrupt() == 0);

    const auto is_recorded = [&](const auto& fits) {
      return std::ranges::any_of(records.all(), fits);
    };
    std::size_t known_angles = 0, known_poses = 0, known_frames = 0;
    for (const Angles& angles : received_angles)
      known_angles += is_recorded([&](const Records::Entry& entry) {
        return measured_angles(entry.states, "op/") == angles;
      });
    for (const std::vector<Pose>& joints : received_poses)
      known_poses += is_recorded(
          [&](const Records::Entry& entry) { return poses_of(entry.record.hands[1]) == joints; });
    for (const auto& frames : received_frames)
      known_frames +=
          is_recorded([&](const Records::Entry& entry) { return are_of(entry, frames, "op/"); });
    CHECK(received_angles.front().size() > 30);
    CHECK(received_frames.front().size() == 1 + 2 * (1 + NENDO_PUBLISH_JOINTS));
    // On a busy machine, this test may be too late for some records.
    const std::size_t missed = records.missed();
    CHECK(std::min({known_angles, known_poses, known_frames}) > 20);
    CHECK(known_angles + missed >= received_angles.size());
    CHECK(known_poses + missed >= received_poses.size());
    CHECK(known_frames + missed >= received_frames.size());
  }

  TEST_CASE("topics have the types, hashes and profiles of ROS 2") {
    const RuntimeFolder folder;
    const Listener listener;
    const dds_entity_t writers = dds_create_reader(
        listener.participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
    REQUIRE(writers > 0);
    const Ros2Program program("--segment " + segment_name("none"));
    struct Expected {
      std::string type, hash;
      bool is_transient_local;
    };
    const std::string tf_hash = "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087";
    const std::string poses_hash =
        "af0cc36d190e104d546d168d6b39df04fa4b4ccecf59cb4c9ed328d3d5004aa0";
    std::map<std::string, Expected> expected{
        {"rt/joint_states",
         {"sensor_msgs::msg::dds_::JointState_",
          "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e", false}},
        {"rt/tf", {"tf2_msgs::msg::dds_::TFMessage_", tf_hash, false}},
        {"rt/tf_static", {"tf2_msgs::msg::dds_::TFMessage_", tf_hash, true}},
        {"rt/nendo/left/joints", {"geometry_msgs::msg::dds_::PoseArray_", poses_hash, false}},
        {"rt/nendo/right/joints", {"geometry_msgs::msg::dds_::PoseArray_", poses_hash, false}},
        {"rt/diagnostics",
         {"diagnostic_msgs::msg::dds_::DiagnosticArray_",
          "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e", false}}};
    const auto judge = [&](const dds_builtintopic_endpoint_t& writer) {
      const auto found = expected.find(writer.topic_name);
      if (found == expected.end()) return;
      CAPTURE(found->first);
      const Expected own = found->second;
      expected.erase(found);
      CHECK(std::string(writer.type_name) == own.type);
      void* data = nullptr;
      std::size_t size = 0;
      REQUIRE(dds_qget_userdata(writer.qos, &data, &size));
      CHECK(std::string(static_cast<const char*>(data), size) ==
            "typehash=RIHS01_" + own.hash + ";");
      dds_free(data);
      dds_reliability_kind_t reliability{};
      REQUIRE(dds_qget_reliability(writer.qos, &reliability, nullptr));
      CHECK(reliability == DDS_RELIABILITY_RELIABLE);
      dds_durability_kind_t durability{};
      REQUIRE(dds_qget_durability(writer.qos, &durability));
      CHECK((durability == DDS_DURABILITY_TRANSIENT_LOCAL) == own.is_transient_local);
      if (!own.is_transient_local) CHECK(durability == DDS_DURABILITY_VOLATILE);
    };
    CHECK(is_received([&] {
      void* sample = nullptr;
      dds_sample_info_t info{};
      while (dds_take(writers, &sample, &info, 1, 1) == 1) {
        if (info.valid_data) judge(*static_cast<const dds_builtintopic_endpoint_t*>(sample));
        dds_return_loan(writers, &sample, 1);
        sample = nullptr;
      }
      return expected.empty();
    }));
  }

  TEST_CASE("a reader that comes later gets the static transform") {
    const RuntimeFolder folder;
    const Ros2Program program("--segment " + segment_name("none"));
    const Listener listener;
    { // another one, which has found the program and its message
      Topic<TFMessage> first(listener, tf2_msgs_msg_dds__TFMessage__desc, "rt/tf_static", true);
      REQUIRE(is_received([&] { return first.take() > 0; }));
    }
    Topic<TFMessage> later(listener, tf2_msgs_msg_dds__TFMessage__desc, "rt/tf_static", true);
    bool is_right = false;
    CHECK(is_received([&] {
      return later.take([&](const TFMessage& message) {
        REQUIRE(message.transforms_._length == 1);
        const auto& one = message.transforms_._buffer[0];
        CHECK(std::string(one.header_.frame_id_) == "stage");
        CHECK(std::string(one.child_frame_id_) == "stage_y_up");
        // x right, y up, z back: right is ROS's -y
        const Pose right{1, 0, 0, 0, 0, 0, 1};
        is_right = difference(joined(pose_of(one.transform_), right),
                              joined({0, -1, 0, 0, 0, 0, 1}, pose_of(one.transform_))) < 1e-12;
      }) > 0;
    }));
    CHECK(is_right);
  }

  TEST_CASE("a run that is killed and started again is followed, and /diagnostics reports both") {
    const RuntimeFolder folder;
    const std::string name = segment_name("again");
    const Listener listener;
    Topic<JointState> joint_states(listener, sensor_msgs_msg_dds__JointState__desc,
                                   "rt/joint_states");
    Topic<DiagnosticArray> diagnostics(listener, diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                                       "rt/diagnostics");
    Ros2Program program("--segment shm:" + name + " --rate 50");
    const auto reports = [&](int level, const std::string& text) {
      return is_received([&] {
        bool found = false;
        diagnostics.take([&](const DiagnosticArray& message) {
          REQUIRE(message.status_._length == 3);
          const auto& run = message.status_._buffer[0];
          found = found || (run.level_ == level &&
                            std::string(run.message_).find(text) != std::string::npos);
        });
        return found;
      });
    };
    CHECK(reports(3, "no run publishes"));
    for (int round = 0; round < 2; ++round) {
      CAPTURE(round);
      const Program run(serve_arguments(name));
      int received = 0;
      CHECK(is_received([&] { return (received += joint_states.take()) > 50; }));
      CHECK(reports(0, "continues"));
      run.signal(SIGKILL);
      CHECK(reports(3, "no run publishes"));
      joint_states.take();
    }
    CHECK(program.interrupt() == 0);
    const std::string out = program.out();
    CHECK(out.find("waits for a run") != std::string::npos);
    CHECK(out.find("published ") != std::string::npos);
    CHECK(out.find("DDS refused 0 messages") != std::string::npos);
  }

  TEST_CASE("what cannot be done is an error of one line, with a remedy") {
    const std::string junk = segment_name("junk");
    write_file("/dev/shm/nendo-" + junk, std::string(4096, 'x'));
    struct Case {
      std::string environment, arguments;
      int exit_code;
      std::string remedy;
    };
    for (const Case& wrong :
         {Case{"ROS_DOMAIN_ID=300", "", 2, "0 to 232"},
          Case{"ROS_DOMAIN_ID='</Domain>'", "", 2, "ROS_DOMAIN_ID"},
          Case{"ROS_AUTOMATIC_DISCOVERY_RANGE=OFF", "", 2, "LOCALHOST or SUBNET"},
          Case{"ROS_STATIC_PEERS='a b'", "", 2, "ROS_STATIC_PEERS"},
          Case{"CYCLONEDDS_URI='<nonsense>'", "", 2, "CYCLONEDDS_URI"},
          Case{"CYCLONEDDS_URI=file:///nowhere/at.all", "", 2, "CYCLONEDDS_URI"},
          Case{"CYCLONEDDS_URI='<CycloneDDS><Domain><General><Transport>tcp</Transport></General>"
               "</Domain></CycloneDDS>'",
               "", 2, "only UDP over IPv4"},
          Case{"A=", "--segment a/b", 2, "--segment"}, Case{"A=", "--rate 0", 2, "--rate"},
          Case{"A=", "--rate nan", 2, "--rate"}, Case{"A=", "--prefix /a", 2, "--prefix"},
          Case{"A=", "--prefix 'a b'", 2, "--prefix"},
          Case{"A=", "--segments a", 2, "--segment"}}) {
      CAPTURE(wrong.environment);
      CAPTURE(wrong.arguments);
      const auto done =
          shell("env " + wrong.environment + " " NENDO_ROS2_PROGRAM " " + wrong.arguments);
      CAPTURE(done.out);
      CHECK(done.exit_code == wrong.exit_code);
      CHECK(done.out.starts_with("nendo-ros2: "));
      CHECK(done.out.find("see nendo ") == std::string::npos); // which is another program
      CHECK(done.out.find(wrong.remedy) != std::string::npos);
      CHECK(std::ranges::count(done.out, '\n') == 1);
    }
    const auto done = shell("ROS_DOMAIN_ID=" + std::to_string(domain_id()) +
                            " " NENDO_ROS2_PROGRAM " --segment " + junk);
    std::filesystem::remove("/dev/shm/nendo-" + junk);
    CHECK(done.exit_code == 5);
    CHECK(done.out.find("is no segment of nendo") != std::string::npos);
  }
}

} // namespace ros2_program_test
