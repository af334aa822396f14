#include "ros2/glove_status.hpp"

#include <bit>
#include <cstddef>
#include <cstdio>
#include <utility>

#include <nendo/base/side.hpp>

namespace nendo::ros2 {
namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;
constexpr std::int64_t silent_run_ns = ns_per_s;

std::string short_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

/// Returns the growth per second. Another run begins again from 0.
double rate(std::uint64_t before, std::uint64_t now, std::int64_t time_ns) noexcept {
  if (time_ns <= 0 || now < before) return 0.0;
  return static_cast<double>(now - before) * static_cast<double>(ns_per_s) /
         static_cast<double>(time_ns);
}

void judge(ros::DiagnosticStatus& status, ros::DiagnosticLevel level, std::string message) {
  status.level = level;
  status.message = std::move(message);
}

std::string tracker_word(std::uint32_t flags) {
  if ((flags & NENDO_PUBLISH_LOST) != 0) return "lost";
  return (flags & NENDO_PUBLISH_TRACKED) != 0 ? "moves the wrist" : "none";
}

void judge_glove(const nendo_publish_hand& hand, const nendo_publish_hand_state& state,
                 ros::DiagnosticStatus& status) {
  if ((hand.flags & NENDO_PUBLISH_PRESENT) == 0)
    judge(status, ros::DiagnosticLevel::ok, "no glove");
  else if ((hand.flags & NENDO_PUBLISH_SILENT) != 0)
    judge(status, ros::DiagnosticLevel::error, "the glove is silent, and the pose frozen");
  else if ((state.flags & NENDO_PUBLISH_LOST) != 0)
    judge(status, ros::DiagnosticLevel::warn,
          "the tracker has no good pose, and the wrist is frozen");
  else
    judge(status, ros::DiagnosticLevel::ok, "the glove delivers");
}

void describe_glove(const nendo_publish_hand& hand, const nendo_publish_hand_state& state,
                    double samples_per_s, std::int64_t now_ns, ros::DiagnosticStatus& status) {
  if ((hand.flags & NENDO_PUBLISH_PRESENT) == 0) return;
  auto& values = status.values;
  values.push_back({"samples", std::to_string(hand.samples)});
  values.push_back({"samples per second", short_number(samples_per_s)});
  if (state.sampled_ns > 0)
    values.push_back({"age of the newest sample in ms",
                      short_number(static_cast<double>(now_ns - state.sampled_ns) / 1e6)});
  values.push_back({"measured angles", std::to_string(std::popcount(state.measured))});
  values.push_back({"tracker", tracker_word(state.flags)});
  if ((state.flags & NENDO_PUBLISH_HAS_SWITCH) != 0)
    values.push_back({"wrist switch", (state.flags & NENDO_PUBLISH_SWITCH_ON) != 0 ? "on" : "off"});
}

} // namespace

void GloveStatus::begin(std::int64_t utc_ns, ros::DiagnosticArray& out) const {
  out.header.stamp = ros::time_of(utc_ns);
  out.status.assign(3, {});
  out.status[0].name = "nendo-ros2: run";
  out.status[0].hardware_id = "shm:" + segment_;
  for (const Side side : {Side::left, Side::right}) {
    ros::DiagnosticStatus& status = out.status[1 + static_cast<std::size_t>(side)];
    status.name = "nendo-ros2: " + std::string(name_of(side)) + " glove";
    status.hardware_id = name_of(side);
  }
}

void GloveStatus::of_run(const HandsRecord& newest, std::int64_t now_ns, std::int64_t utc_ns,
                         ros::DiagnosticArray& out) {
  begin(utc_ns, out);
  const nendo_publish_record& record = newest.record;
  const std::int64_t since_ns = before_.now_ns == 0 ? 0 : now_ns - before_.now_ns;
  ros::DiagnosticStatus& run = out.status[0];
  if (now_ns - record.woke_ns > silent_run_ns)
    judge(run, ros::DiagnosticLevel::error, "the run has stopped, or the machine is overloaded");
  else
    judge(run, ros::DiagnosticLevel::ok, "the run continues");
  run.values = {{"ticks", std::to_string(record.ticks)},
                {"ticks per second", short_number(rate(before_.ticks, record.ticks, since_ns))},
                {"missed deadlines", std::to_string(record.missed)}};
  Counts counts{now_ns, record.ticks, {}};
  for (std::size_t side = 0; side < 2; ++side) {
    const nendo_publish_hand& hand = record.hands[side];
    counts.samples[side] = hand.samples;
    judge_glove(hand, newest.states.hands[side], out.status[1 + side]);
    describe_glove(hand, newest.states.hands[side],
                   rate(before_.samples[side], hand.samples, since_ns), now_ns,
                   out.status[1 + side]);
  }
  before_ = counts;
}

void GloveStatus::of_no_run(std::int64_t utc_ns, ros::DiagnosticArray& out) {
  begin(utc_ns, out);
  for (ros::DiagnosticStatus& status : out.status)
    judge(status, ros::DiagnosticLevel::stale, "no run publishes to shm:" + segment_);
  before_ = {};
}

} // namespace nendo::ros2
