#include <nendo/sculpting/open_hand.hpp>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/driver/devices.hpp>
#include <nendo/hand/tracker_mount.hpp>

namespace nendo::sculpting {
namespace {

using std::chrono::milliseconds;

/// Returns what to check, as far as the glove's bytes show why no sample came.
std::string silence_advice(const driver::Glove& glove) {
  const driver::StreamStats stats = glove.stats();
  if (glove.info().kind == driver::SourceKind::recorded)
    return "does its recording begin with a pause?";
  if (stats.unplugged > 0) return "plug the glove into its interface unit";
  if (stats.bytes > 0)
    return "the " + std::to_string(stats.bytes) +
           " bytes that came are no records of this kind of glove; check its kind and its cable";
  return "check that it is switched on, and its cable";
}

Result<void> wait_for_sample(OpenHand& hand, const std::function<bool()>& is_stopped) {
  const double rate_hz = hand.glove->info().rate_hz;
  // A glove whose rate is not known may send one record per second.
  const double patience_s = rate_hz > 0.0 ? std::clamp(3.0 / rate_hz, 2.0, 60.0) : 4.0;
  const HostTime end = HostClock::now() + from_seconds(patience_s);
  const auto stops = [&] { return is_stopped && is_stopped(); };
  while (HostClock::now() < end && !stops()) {
    if (hand.ring->try_pop(hand.first)) return {};
    std::this_thread::sleep_for(milliseconds(5));
  }
  if (stops()) return Error{Errc::failed, "stopped before the first sample came"};
  return Error{Errc::no_device, hand.glove->info().source + ": opened, but no sample came within " +
                                    std::to_string(static_cast<int>(patience_s)) + " s; " +
                                    silence_advice(*hand.glove)};
}

/// Notes why gloves that are plugged in do not take part.
void note_silent(const std::vector<std::string>& why, std::size_t opened, const Note& note) {
  const auto candidates = driver::find_devices();
  const auto plugged_in =
      std::count_if(candidates.begin(), candidates.end(), [](const auto& candidate) {
        return candidate.identified && !candidate.spec.empty();
      });
  if (static_cast<std::size_t>(plugged_in) <= opened) return;
  for (const auto& reason : why)
    note(reason);
}

} // namespace

flow::HandInput input_of(const OpenHand& hand) {
  return {.ring = hand.ring.get(), .side = hand.side, .wearer = hand.wearer, .first = hand.first};
}

OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                 EventCount* event_count, const Note& note) {
  const Side own_side = glove->info().side;
  if (side && own_side != *side) {
    note(glove->info().source + " says that it is a " + std::string(name_of(own_side)) +
         "-hand glove; it shapes as the " + std::string(name_of(*side)) + " hand, as you asked");
  }
  OpenHand hand;
  hand.side = side.value_or(own_side);
  hand.ring = std::make_unique<SampleRing>(1024, event_count);
  hand.glove = std::move(glove);
  return hand;
}

Result<std::vector<OpenHand>> open_found(std::span<const Side> sides, const std::string& simulated,
                                         const OpenNamed& open, const Note& note) {
  std::vector<OpenHand> hands;
  std::vector<std::string> why;
  for (const Side side : sides) {
    auto hand = open("auto:" + std::string(name_of(side)), side);
    if (hand) {
      hands.push_back(*std::move(hand));
    } else if (hand.error().code != Errc::no_device) {
      return hand.error();
    } else {
      why.push_back(hand.error().message);
    }
  }
  note_silent(why, hands.size(), note);
  if (!hands.empty()) return hands;
  note("no glove found, so " + std::string(sides.size() > 1 ? "both hands are" : "the hand is") +
       " simulated (" + simulated +
       "); to use a glove name its port, "
       "e.g. --right serial:/dev/ttyUSB0 (`nendo devices` lists them)");
  for (const Side side : sides) {
    auto hand = open(simulated, side);
    if (!hand) return hand.error();
    hands.push_back(*std::move(hand));
  }
  return hands;
}

hand::TrackingOptions usual_tracking(const driver::TrackerInfo& info) noexcept {
  hand::TrackingOptions tracking;
  const auto& turn = info.stage_from_tracker_xyzw;
  tracking.mount = hand::usual_mount(Eigen::Quaterniond(turn.data()).normalized());
  const bool is_noisy = info.kind == driver::SourceKind::device && !info.is_filtered;
  tracking.filter.kind = is_noisy ? hand::FilterKind::one_euro : hand::FilterKind::off;
  return tracking;
}

namespace {

Error without_hand(Side side, const std::string& spec) {
  const std::string name(name_of(side));
  return {Errc::usage,
          "--" + name + "-wrist " + spec + ": there is no " + name + " hand; name its glove also"};
}

/// Returns the tracking by the stored mount, or else the usual one.
Result<hand::TrackingOptions> find_tracking(const driver::TrackerStation& station, Side side,
                                            const Note& note) {
  const driver::TrackerInfo& info = station.tracker->info();
  hand::TrackingOptions tracking = usual_tracking(info);
  if (info.kind != driver::SourceKind::device) return tracking;
  const auto mount = hand::find_mount(station.mount_source(), station.mount_station(), side);
  if (!mount) return mount.error();
  const std::string name =
      printable(station.source) + ", " + std::string(name_of(side)) + " hand: ";
  if (*mount) {
    tracking.mount = hand::wrist_mount(**mount);
    note(name + "mount as calibrated");
  } else {
    note(name + "the mount is not calibrated, so the wrist counts as being at the receiver; `nendo "
                "calibrate tracker` finds where it is");
  }
  return tracking;
}

} // namespace

Result<void> open_wrists(std::span<OpenHand> hands, const WristOptions& options, const Note& note,
                         std::span<const driver::TrackerDriver> more) {
  std::vector<std::string> wanted;
  std::vector<OpenHand*> moved;
  for (const Side side : {Side::left, Side::right}) {
    const std::string& spec = options.trackers[flow::Placement::index_of(side)];
    if (spec.empty()) continue;
    const auto hand =
        std::ranges::find_if(hands, [side](const OpenHand& one) { return one.side == side; });
    if (hand == hands.end()) return without_hand(side, spec);
    wanted.push_back(spec);
    moved.push_back(&*hand);
  }
  auto stations = driver::open_trackers(wanted, more);
  if (!stations) return stations.error();
  if (stations->size() == 2 && (*stations)[0].tracker == (*stations)[1].tracker &&
      (*stations)[0].station == (*stations)[1].station)
    return Error{Errc::usage, "--left-wrist and --right-wrist: both are " + wanted[0] +
                                  "; give each hand a station of its own, e.g. with station="};
  for (std::size_t at = 0; at < moved.size(); ++at) {
    auto tracking = find_tracking((*stations)[at], moved[at]->side, note);
    if (!tracking) return tracking.error();
    tracking->movement_scale = options.movement_scale;
    moved[at]->wrist = OpenWrist{std::make_unique<PoseRing>(1024, options.event_count),
                                 (*stations)[at], *std::move(tracking)};
  }
  return {};
}

namespace {

Result<void> start_wrists(std::span<const OpenHand> hands) {
  std::vector<driver::TrackerStation> stations;
  std::vector<PoseRing*> rings;
  for (const OpenHand& hand : hands) {
    if (!hand.wrist) continue;
    stations.push_back(hand.wrist->station);
    rings.push_back(hand.wrist->ring.get());
  }
  return driver::start_trackers(stations, rings);
}

} // namespace

Result<void> start(std::span<OpenHand> hands) {
  for (OpenHand& hand : hands) {
    if (auto started = hand.glove->start(*hand.ring); !started) return started;
  }
  return start_wrists(hands);
}

void stop(std::span<OpenHand> hands) noexcept {
  for (OpenHand& hand : hands) {
    hand.glove->stop();
    if (hand.wrist) hand.wrist->station.tracker->stop();
  }
}

Result<void> begin_again(std::span<OpenHand> hands) {
  const auto is_worn = [](const OpenHand& hand) {
    return hand.glove->info().kind == driver::SourceKind::device;
  };
  // A tracker may move both hands, so it is stopped before its rings are emptied.
  for (OpenHand& hand : hands) {
    if (!is_worn(hand)) hand.glove->stop();
    if (hand.wrist) hand.wrist->station.tracker->stop();
  }
  for (OpenHand& hand : hands) {
    if (hand.wrist) hand.wrist->ring->drain([](const PoseSample&) noexcept {});
    if (is_worn(hand)) continue;
    hand.ring->drain([](const GloveSample&) noexcept {});
    if (auto started = hand.glove->start(*hand.ring); !started) return started;
  }
  return start_wrists(hands);
}

bool have_ended(std::span<const OpenHand> hands) noexcept {
  return std::all_of(hands.begin(), hands.end(),
                     [](const OpenHand& hand) { return hand.glove->has_ended(); });
}

Result<void> wait_for_samples(std::span<OpenHand> hands, const std::function<bool()>& is_stopped) {
  for (OpenHand& hand : hands)
    if (auto came = wait_for_sample(hand, is_stopped); !came) return came;
  return {};
}

Result<void> find_wearers(std::span<OpenHand> hands, const CalibrationOptions& options,
                          const Note& note) {
  for (OpenHand& hand : hands) {
    // A sample has the side of the glove that sent it, which need not be the identified one.
    auto wearer = find_wearer(hand.glove->info(), hand.first.side, options, note);
    if (!wearer) return wearer.error();
    hand.wearer = *std::move(wearer);
    hand.uncalibrated = is_uncalibrated(hand.glove->info(), hand.wearer, hand.first.side);
  }
  return {};
}

} // namespace nendo::sculpting
