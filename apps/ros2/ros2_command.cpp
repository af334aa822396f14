#include "ros2/ros2_command.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include <nendo/base/shared_name.hpp>
#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>
#include <nendo/base/utc.hpp>

#include "cli/cli.hpp"
#include "ros/hand_messages.hpp"
#include "ros2/dds_network.hpp"
#include "ros2/glove_status.hpp"
#include "ros2/participant.hpp"
#include "ros2/segment_reader.hpp"
#include "ros2/this_machine.hpp"

namespace nendo::ros2 {
namespace {

constexpr std::chrono::microseconds between_looks{
    500}; ///< the pause between two looks for a record
constexpr std::int64_t between_tests_ns =
    100'000'000; ///< the pause between two tests whether a run lives
constexpr std::int64_t between_statuses_ns = 1'000'000'000;
constexpr std::size_t max_prefix_length = 64;

struct Ros2Options {
  std::string segment = "run";
  std::optional<double> rate_hz;
  std::string prefix;
};

std::int64_t monotonic_ns() noexcept {
  return std::chrono::nanoseconds(HostClock::now().time_since_epoch()).count();
}

ros::StagePose pose_of(const nendo_publish_joint& joint) {
  const auto& at = joint.position;
  const auto& turn = joint.orientation;
  return {Eigen::Vector3f(at[0], at[1], at[2]).cast<double>(),
          Eigen::Quaternionf(turn[3], turn[0], turn[1], turn[2]).cast<double>()};
}

/// The hands of a record that gloves drive, the left one first.
class RecordHands {
public:
  explicit RecordHands(const HandsRecord& from) {
    for (const Side side : {Side::left, Side::right}) {
      const auto at = static_cast<std::size_t>(side);
      const nendo_publish_hand& hand = from.record.hands[at];
      if ((hand.flags & NENDO_PUBLISH_PRESENT) == 0) continue;
      ros::HandState& out = hands_[count_++];
      out.side = side;
      std::transform(std::begin(hand.joints), std::end(hand.joints), out.joints.begin(), pose_of);
      const nendo_publish_hand_state& state = from.states.hands[at];
      out.measured = state.measured;
      std::copy(std::begin(state.angles), std::end(state.angles), out.angles_rad.begin());
      const bool has_states = from.states.stage != 0;
      out.forearm =
          has_states ? pose_of(state.forearm) : out.joints[hand::index_of(hand::Joint::wrist)];
    }
  }
  std::span<const ros::HandState> all() const noexcept { return {hands_.data(), count_}; }

private:
  std::array<ros::HandState, 2> hands_;
  std::size_t count_ = 0;
};

class Follower {
public:
  Follower(const Ros2Options& options, Participant& participant)
      : name_(options.segment), participant_(participant), hands_(options.prefix),
        pace_(options.rate_hz), status_(options.segment) {
    participant_.static_transforms(hands_.static_transforms(utc_ns(HostClock::now())));
  }

  Result<void> run() {
    while (!cli::stop_requested().load(std::memory_order_relaxed)) {
      const std::int64_t now_ns = monotonic_ns();
      if (now_ns >= next_test_ns_) {
        next_test_ns_ = now_ns + between_tests_ns;
        if (const auto fine = segment_ ? leave() : attach(); !fine) return fine.error();
      }
      if (segment_) publish_new();
      if (now_ns >= next_status_ns_) publish_status(now_ns);
      std::this_thread::sleep_for(segment_ ? between_looks : std::chrono::microseconds(10'000));
    }
    cli::note("published " + std::to_string(published_) + " ticks, missed " +
              std::to_string(missed_) + "; DDS refused " + std::to_string(participant_.refused()) +
              " messages");
    return {};
  }

private:
  Result<void> attach() {
    auto found = ros2::attach(name_);
    if (!found) return found.error();
    if (*found) {
      segment_.emplace(*std::move(*found));
      // Earlier records are too old.
      next_ = std::max<std::uint64_t>(segment_->contents().newest(), 1);
      next_status_ns_ = 0;
      cli::note("follows shm:" + name_);
    } else if (!is_waiting_) {
      is_waiting_ = true;
      cli::note("waits for a run that publishes to shm:" + name_ +
                ", such as: nendo run --to shm:" + name_);
    }
    return {};
  }

  Result<void> leave() {
    if (!segment_->has_ended()) return {};
    publish_new(); // its last ticks
    segment_.reset();
    has_record_ = is_waiting_ = false;
    next_status_ns_ = 0;
    return attach();
  }

  void publish_new() {
    const publish::CheckedSegment& segment = segment_->contents();
    const std::uint64_t newest = segment.newest();
    if (newest < next_) return;
    if (newest - next_ >= segment.header().record_slots) {
      missed_ += newest - next_;
      next_ = newest;
    }
    for (std::uint64_t left = newest - next_ + 1; left > 0; --left, ++next_) {
      if (!read(segment, next_, reading_)) {
        ++missed_;
        continue;
      }
      record_ = reading_;
      has_record_ = true;
      const std::int64_t woke_ns = record_.record.woke_ns;
      if (pace_.is_due(woke_ns)) publish(utc_ns(HostTime(std::chrono::nanoseconds(woke_ns))));
    }
  }

  void publish(std::int64_t utc_ns) {
    const RecordHands hands(record_);
    ++published_;
    if (hands.all().empty()) return;
    hands_.joint_states(hands.all(), utc_ns, joint_state_);
    participant_.joint_states(joint_state_);
    hands_.transforms(hands.all(), utc_ns, transforms_);
    participant_.transforms(transforms_);
    for (const ros::HandState& hand : hands.all()) {
      hands_.poses(hand, utc_ns, poses_);
      participant_.poses(hand.side, poses_);
    }
  }

  void publish_status(std::int64_t now_ns) {
    next_status_ns_ = now_ns + between_statuses_ns;
    const std::int64_t stamp_ns = utc_ns(HostClock::now());
    if (segment_ && has_record_)
      status_.of_run(record_, now_ns, stamp_ns, diagnostics_);
    else
      status_.of_no_run(stamp_ns, diagnostics_);
    participant_.diagnostics(diagnostics_);
  }

  std::string name_;
  Participant& participant_;
  ros::HandMessages hands_;
  publish::Pace pace_;
  GloveStatus status_;
  std::optional<publish::MappedSegment> segment_;
  std::uint64_t next_ = 1, published_ = 0, missed_ = 0;
  bool is_waiting_ = false, has_record_ = false;
  std::int64_t next_test_ns_ = 0, next_status_ns_ = 0;
  HandsRecord reading_; ///< may be torn
  HandsRecord record_;  ///< the newest whole one
  ros::JointState joint_state_;
  ros::TFMessage transforms_;
  ros::PoseArray poses_;
  ros::DiagnosticArray diagnostics_;
};

Result<void> check(Ros2Options& options) {
  constexpr std::string_view kind = "shm:";
  if (options.segment.starts_with(kind)) options.segment.erase(0, kind.size());
  if (!is_shared_name(options.segment))
    return Error{Errc::usage,
                 "--segment " + in_quotes(options.segment) + ": " + std::string(shared_name_rule)};
  if (options.rate_hz && !(*options.rate_hz >= 0.1 && *options.rate_hz <= 10'000.0))
    return Error{Errc::usage, "--rate: use 0.1 to 10000 Hz"};
  const std::string& prefix = options.prefix;
  const bool is_name = std::ranges::all_of(prefix, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
           c == '/';
  });
  if (!is_name || prefix.starts_with('/') || prefix.size() > max_prefix_length)
    return Error{Errc::usage,
                 "--prefix " + in_quotes(prefix) +
                     ": use letters, digits, '_' and '/', at most 64, and no '/' first"};
  return {};
}

Result<void> run(Ros2Options& options) {
  if (const auto fine = check(options); !fine) return fine.error();
  const auto network = network_of(environment(), has_multicast());
  if (!network) return network.error();
  auto participant = Participant::open(*network);
  if (!participant) return participant.error();
  cli::note("publishes in the domain " + std::to_string(network->domain_id) +
            (network->is_this_machine_only ? " of this machine"
                                           : " of this machine and of others that reach it"));
  return Follower(options, **participant).run();
}

} // namespace

void add_command(cli::Command& program) {
  cli::Command command = program.add_command(
      command_name, "Publishes the hands of a run to programs of ROS 2, until Ctrl-C");
  Ros2Options& options = command.on_chosen<Ros2Options>(&run);
  command.add_option("--segment", options.segment,
                     "NAME of nendo run --to shm:NAME, or of nendo serve --to shm:NAME");
  command.add_rate("--rate", options.rate_hz, "Most messages per second; without it, every tick");
  command.add_option("--prefix", options.prefix,
                     "Begins each name of a joint and of a frame, such as operator_1/");
  command.set_footer("The network is that of ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, "
                     "ROS_STATIC_PEERS, ROS_LOCALHOST_ONLY\nand CYCLONEDDS_URI. Without them, "
                     "DDS stays on this machine.");
}

} // namespace nendo::ros2
