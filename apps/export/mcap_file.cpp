#include "export/mcap_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <nendo/base/files.hpp>

#include "commands/command_text.hpp"
#include "export/mcap_writer.hpp"
#include "ros/cdr.hpp"
#include "ros/frame_hands.hpp"
#include "ros/hand_messages.hpp"
#include "ros/types.hpp"

namespace nendo::exporting {
namespace {

enum Channel : std::uint16_t { joints_channel, tf_channel, tf_static_channel, commands_channel };

constexpr std::array mcap_topics{ros::joint_states_topic, ros::tf_topic, ros::tf_static_topic,
                                 ros::commands_topic}; // index: Channel

std::vector<McapChannel> mcap_channels() {
  std::vector<McapChannel> channels;
  for (const ros::Topic& topic : mcap_topics)
    channels.push_back({std::string(topic.name),
                        std::string(topic.type.name),
                        ros::schema_of(topic.type),
                        {{"offered_qos_profiles", ros::offered_qos_profiles(topic.qos)},
                         {"topic_type_hash", std::string(topic.type.hash)}}});
  return channels;
}

bool is_finite(const ros::StagePose& pose) {
  return pose.position_m.allFinite() && pose.orientation.coeffs().allFinite();
}
bool is_finite(const ros::HandState& hand) {
  return is_finite(hand.forearm) &&
         std::ranges::all_of(hand.joints, [](const auto& joint) { return is_finite(joint); }) &&
         std::ranges::all_of(hand.angles_rad, [](double angle) { return std::isfinite(angle); });
}

/// Rounds by less than 1e-13, in metres. The last bits of relative poses are rounding errors, also
/// where bones do not move, and would double the size of the compressed file.
void drop_rounding_errors(ros::TFMessage& message) {
  constexpr double per_unit = 0x1p44;
  for (auto& one : message.transforms) {
    auto& [x, y, z] = one.transform.translation;
    auto& [qx, qy, qz, qw] = one.transform.rotation;
    for (double* const number : {&x, &y, &z, &qx, &qy, &qz, &qw})
      *number = std::nearbyint(*number * per_unit) / per_unit + 0.0; // no -0
  }
}

class TakeMessages {
public:
  TakeMessages(std::span<const timeline::Event> commands, const McapOptions& options)
      : commands_(commands), begun_utc_ns_(options.begun_utc_ns),
        writer_(options.library, mcap_channels()) {}

  Result<void> add(const ChosenFrames& frames) {
    const double time_s = frames.time_s();
    const std::int64_t utc_ns = utc_of(time_s);
    ros::FrameHands hands(frames.frame());
    if (hands.all().empty()) return bad("there is no hand in the take");
    if (!std::ranges::all_of(hands.all(), [](const auto& hand) { return is_finite(hand); }))
      return bad("a pose at " + std::to_string(time_s) + " s is not finite");
    if (frames.made() == 1) {
      add(tf_static_channel, utc_ns, messages_.static_transforms(utc_ns));
      while (!commands_.empty() && commands_.front().time_s < time_s)
        commands_ = commands_.subspan(1);
    }
    add_commands_until(time_s);
    messages_.joint_states(hands.all(), utc_ns, joints_);
    add(joints_channel, utc_ns, joints_);
    messages_.transforms(hands.all(), utc_ns, tf_);
    drop_rounding_errors(tf_);
    add(tf_channel, utc_ns, tf_);
    return {};
  }

  McapWriter& writer() noexcept { return writer_; }

private:
  static Error bad(const std::string& what) { return {Errc::bad_input, what}; }

  std::int64_t utc_of(double time_s) const noexcept {
    // Takes last up to 1e7 s, and begin between -2^61 and 2^61 ns.
    return begun_utc_ns_ + static_cast<std::int64_t>(std::llround(1e9 * time_s));
  }

  template <class Message>
  void add(Channel channel, std::int64_t utc_ns, const Message& message) {
    bytes_.clear();
    ros::append_cdr(message, bytes_);
    writer_.add(channel, static_cast<std::uint64_t>(std::max(utc_ns, std::int64_t{0})), bytes_);
  }

  void add_commands_until(double time_s) {
    for (; !commands_.empty() && commands_.front().time_s <= time_s;
         commands_ = commands_.subspan(1))
      add(commands_channel, utc_of(commands_.front().time_s),
          ros::String{commands::text_of(commands_.front().command)});
  }

  std::span<const timeline::Event> commands_; ///< those that are not written yet
  std::int64_t begun_utc_ns_;
  McapWriter writer_;
  ros::HandMessages messages_;
  ros::JointState joints_;
  ros::TFMessage tf_;
  std::vector<std::byte> bytes_;
};

} // namespace

Result<Exported> export_mcap(ChosenFrames& frames, std::span<const timeline::Event> commands,
                             const McapOptions& options, const std::filesystem::path& path) {
  TakeMessages messages(commands, options);
  const auto put_new = [&](FileReplacement& file) -> Result<void> {
    const auto bytes = messages.writer().take();
    return bytes.empty() ? Result<void>{} : file.write(bytes);
  };
  const auto put = [&](FileReplacement& file) -> Result<void> {
    if (auto added = messages.add(frames); !added)
      return Error{added.error().code, path.string() + ": " + added.error().message};
    return put_new(file);
  };
  return export_to_one_file(frames, path, put, [&](FileReplacement& file) {
    messages.writer().finish();
    return put_new(file);
  });
}

} // namespace nendo::exporting
