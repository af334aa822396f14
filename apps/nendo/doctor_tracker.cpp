// The checks of `nendo doctor TRACKER`: whether it answers, and what a second of its poses is like.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/text.hpp>
#include <nendo/hand/pose_gate.hpp>

#include "cli/cli.hpp"
#include "gloves/open_tracker.hpp"
#include "gloves/tracker_text.hpp"
#include "nendo/tracker_commands.hpp"

namespace nendo::app {
namespace {

using std::chrono::milliseconds;

/// What a moment of a station's poses shows.
struct SeenMoment {
  std::uint64_t poses = 0;
  std::uint64_t refused = 0; ///< the poses that hand::PoseGate refused
  std::uint64_t flips = 0;
  char error = ' '; ///< the last letter
  HostTime first{}, last{};
  double max_distance_m = 0.0; ///< the largest distance of a good pose from the tracker's origin

  double rate_hz() const noexcept {
    return last > first ? static_cast<double>(poses - 1) / to_seconds(last - first) : 0.0;
  }
};

/// Looks at the poses of the first station for a second from its first pose on, for which it waits
/// two seconds. Recordings may end before.
SeenMoment look_at(gloves::StationPoses& poses) {
  constexpr milliseconds patience{2000};
  constexpr milliseconds moment{1000};
  SeenMoment seen;
  hand::PoseGate gate;
  const HostTime begin = HostClock::now();
  bool ended = false;
  const auto goes_on = [&] {
    const HostTime now = HostClock::now();
    return !ended && !cli::stop_requested() &&
           (seen.poses == 0 ? now < begin + patience : now < seen.first + moment);
  };
  while (goes_on()) {
    ended = poses.have_ended();
    poses.drain(0, [&](const PoseSample& pose) {
      if (seen.poses++ == 0) seen.first = pose.arrival;
      seen.last = pose.arrival;
      if (pose.error != ' ') seen.error = pose.error;
      const auto passed = gate.pass(pose);
      if (!passed) return;
      const auto& [x, y, z] = passed->position_m;
      seen.max_distance_m = std::max(seen.max_distance_m, std::hypot(x, y, z));
    });
    std::this_thread::sleep_for(milliseconds(2));
  }
  seen.refused = gate.refused();
  seen.flips = gate.flips();
  return seen;
}

/// Returns whether the tracker measures from a transmitter, whose field gets weaker with the
/// distance.
bool has_transmitter(const driver::TrackerInfo& info) noexcept {
  return info.stage_from_tracker_xyzw == driver::stage_from_z_down_xyzw;
}

class Findings {
public:
  explicit Findings(std::string subject) : subject_(std::move(subject)) {}
  void add(doctor::Severity severity, std::string_view check, std::string what,
           std::string remedy) {
    found_.push_back({severity, check, subject_, std::move(what), std::move(remedy)});
  }
  void warn(std::string_view check, std::string what, std::string remedy) {
    add(doctor::Severity::warning, check, std::move(what), std::move(remedy));
  }
  std::vector<doctor::Finding> take() { return std::move(found_); }

private:
  std::string subject_;
  std::vector<doctor::Finding> found_;
};

void check_rate(const driver::TrackerInfo& info, const SeenMoment& seen, Findings& findings) {
  constexpr double tolerance = 0.05;
  if (info.kind == driver::SourceKind::recorded) return; // whose poses may be of two stations
  if (info.rate_hz <= 0.0 || seen.rate_hz() >= (1.0 - tolerance) * info.rate_hz) return;
  findings.warn("rate",
                fmt::format("{:.1f} poses per second of the {:.1f} that it can send",
                            seen.rate_hz(), info.rate_hz),
                "use a higher baud rate and a shorter cable; a station that is not used takes "
                "time, too");
}

void check_poses(const driver::TrackerInfo& info, const SeenMoment& seen, Findings& findings) {
  // Makers state their accuracy up to 0.76 m (FASTRAK) and 0.91 m (Flock of Birds); the noise grows
  // with about the fourth power of the distance.
  constexpr double max_accurate_m = 0.76;
  if (seen.refused > 0)
    findings.warn("refused_poses",
                  fmt::format("{} of {} poses are where no hand can have moved: they are refused",
                              seen.refused, seen.poses),
                  "check the cable, and take metal, screens and power supplies away from receiver "
                  "and transmitter");
  if (seen.flips > 0)
    findings.warn("hemisphere",
                  fmt::format("{} of {} poses are in the wrong hemisphere", seen.flips, seen.poses),
                  gloves::hemisphere_advice);
  if (has_transmitter(info) && seen.max_distance_m > max_accurate_m)
    findings.warn("distance",
                  fmt::format("the receiver is {:.0f} cm from the transmitter; poses are accurate "
                              "up to {:.0f} cm",
                              100.0 * seen.max_distance_m, 100.0 * max_accurate_m),
                  "put the transmitter nearer to the hands");
  if (seen.error != ' ')
    findings.warn("error_letter",
                  "its poses have the error letter " + printable(std::string(1, seen.error)),
                  "look it up in the tracker's manual; the letter can be that of an earlier error");
}

} // namespace

Result<doctor::Examination> check_tracker(const std::string& spec) {
  auto stations = gloves::open_trackers({&spec, 1});
  if (!stations) return stations.error();
  gloves::StationPoses poses(*std::move(stations));
  if (const auto started = poses.start(); !started) return started.error();
  const SeenMoment seen = look_at(poses);
  poses.stop();
  const driver::TrackerInfo& info = poses[0].tracker->info();
  Findings findings(spec);
  if (seen.poses == 0) {
    findings.add(doctor::Severity::failure, "no_poses",
                 "it answered as " + printable(info.model) + ", but no pose came within 2 s",
                 gloves::no_pose_advice(poses[0]) + "; `nendo info " + shell_word(spec) +
                     "` shows what the tracker reports");
    return doctor::Examination{findings.take(), {spec}};
  }
  check_rate(info, seen, findings);
  check_poses(info, seen, findings);
  return doctor::Examination{
      findings.take(),
      {fmt::format(
          "{} ({} poses, {:.1f} per second, {} refused, at most {:.0f} mm from its origin)", spec,
          seen.poses, seen.rate_hz(), seen.refused, 1000.0 * seen.max_distance_m)}};
}

} // namespace nendo::app
