#include "studio/glove_board.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/sculpting/find_wearer.hpp>

namespace nendo::studio {
namespace {

using State = DeviceCard::State;

constexpr double silent_after_s = 0.5;
constexpr double hands_apart_m = 0.26;

/// Upright, with its back to the viewer.
Eigen::Isometry3d wrist_of(Side side) {
  Eigen::Isometry3d wrist = Eigen::Isometry3d::Identity();
  wrist.rotate(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX()));
  wrist.pretranslate(Eigen::Vector3d((side == Side::left ? -0.5 : 0.5) * hands_apart_m, 0.03, 0.0));
  return wrist;
}

void ignore(std::string_view) {}

std::string calibration_in_words(const sculpting::FoundCalibration& found) {
  using Kind = sculpting::FoundCalibration::Kind;
  if (found.kind == Kind::stored) return "calibrated for " + printable(found.user);
  if (found.kind == Kind::learned) return "learned from " + printable(found.user);
  return found.kind == Kind::recorded ? "calibrated as recorded" : "";
}

} // namespace

GloveBoard::GloveBoard(std::vector<NamedGlove> named, gloves::CalibrationOptions calibration,
                       OpenWatcher open_watcher)
    : calibration_(std::move(calibration)), named_(std::move(named)),
      open_watcher_(std::move(open_watcher)), thread_([this] { watch(); }) {}

GloveBoard::~GloveBoard() {
  over_ = true;
  thread_.join();
  for (const auto& device : found_)
    if (device->hand) device->hand->glove->stop();
}

void GloveBoard::watch() {
  for (const NamedGlove& glove : named_)
    if (!over_) add(glove, {});
  if (!named_.empty()) return;
  const auto watcher = open_watcher_();
  if (!watcher) return; // the run, which looks for gloves itself, says why
  for (const driver::DeviceCandidate& candidate : (*watcher)->present())
    if (!over_) add({candidate.spec}, candidate);
  while (!over_) {
    const auto event = (*watcher)->next(std::chrono::milliseconds(100));
    if (event && event->attached) add({event->candidate.spec}, event->candidate);
    if (event && !event->attached) remove(event->candidate);
  }
}

/// Opens a glove, and shows a device that is not one, or that may not be opened.
void GloveBoard::add(NamedGlove named, const driver::DeviceCandidate& candidate) {
  const bool is_named = candidate.device.empty();
  if (!is_named && !candidate.identified) return;
  const auto device = std::make_shared<Device>();
  device->candidate = candidate;
  device->glove = std::move(named);
  {
    const std::lock_guard lock(mutex_);
    found_.push_back(device);
  }
  if (device->glove.spec.empty() || (!is_named && !candidate.may_open)) return;
  const auto side = device->glove.side;
  auto glove = driver::open_glove(device->glove.spec, side, gloves::glove_context());
  std::optional<gloves::OpenHand> hand;
  std::optional<Error> error;
  if (glove) {
    hand = sculpting::hand_of(*std::move(glove), side, nullptr, ignore);
    if (const auto started = hand->glove->start(*hand->ring); !started) error = started.error();
  } else {
    error = glove.error();
  }
  const std::lock_guard lock(mutex_);
  device->hand = std::move(hand);
  device->error = std::move(error);
}

/// An unplugged glove is closed, so that its port is free when it comes again.
void GloveBoard::remove(const driver::DeviceCandidate& candidate) {
  std::vector<gloves::OpenHand> closed; // without the lock, because closing waits for a thread
  const std::lock_guard lock(mutex_);
  for (const auto& device : found_) {
    if (device->candidate.device != candidate.device || device->is_gone) continue;
    device->is_gone = true;
    if (device->hand) closed.push_back(*std::exchange(device->hand, std::nullopt));
  }
}

void GloveBoard::take_found() {
  const std::lock_guard lock(mutex_);
  for (const auto& device : found_) {
    const bool is_known =
        std::ranges::any_of(live_, [&](const Live& live) { return live.device == device; });
    if (!is_known && !device->is_gone) live_.push_back({device, {}, {}});
  }
  std::erase_if(live_, [](const Live& live) { return live.device->is_gone; });
}

void GloveBoard::read(Live& live) {
  gloves::OpenHand& open = *live.device->hand;
  GloveSample sample;
  while (open.ring->try_pop(sample)) {
    if (!live.hand) {
      sculpting::FoundCalibration found;
      auto wearer =
          sculpting::find_wearer(open.glove->info(), sample.side, calibration_, ignore, &found);
      if (!wearer) { // the run says why; an average hand shows that the glove works
        wearer = sculpting::find_wearer(open.glove->info(), sample.side, {}, ignore, &found);
        if (!wearer) return;
      }
      open.wearer = *std::move(wearer);
      open.uncalibrated = sculpting::is_uncalibrated(open.glove->info(), open.wearer, sample.side);
      live.calibration = calibration_in_words(found);
      flow::HandInput input;
      input.side = open.side;
      input.wearer = open.wearer;
      input.first = sample;
      live.hand.emplace(input, flow::place_without_model(), false);
      live.hand->T_stage_wrist = wrist_of(open.side);
    }
    live.hand->update(sample);
  }
}

DeviceCard GloveBoard::card_of(Live& live) const {
  const Device& device = *live.device;
  DeviceCard card;
  card.glove = device.glove;
  card.title =
      device.candidate.description.empty() ? device.glove.spec : device.candidate.description;
  if (device.glove.spec.empty() && !device.candidate.tracker_spec.empty()) {
    card.state = State::tracker;
    card.words = "A tracker: `--left-wrist " + device.candidate.tracker_spec + "` moves a hand.";
    return card;
  }
  if (!device.candidate.device.empty() && !device.candidate.may_open) {
    card.state = State::refused;
    card.words = "You have no permission to open it.";
    card.remedy = device.candidate.remedy;
    return card;
  }
  if (device.error) {
    card.state = State::refused;
    card.words = device.error->message;
    return card;
  }
  if (!device.hand) {
    card.words = "Opening...";
    return card;
  }
  const driver::GloveInfo& info = device.hand->glove->info();
  card.side = device.hand->side;
  const std::string side(name_of(device.hand->side));
  const bool says_side = info.model.find(side) != std::string::npos;
  card.title = says_side ? info.model : info.model + ", " + side + " hand";
  card.is_simulated = info.kind == driver::SourceKind::simulated;
  const double age_s =
      live.hand ? to_seconds(HostClock::now() - live.hand->latest.arrival) : silent_after_s;
  if (age_s >= silent_after_s) {
    card.state = State::silent;
    card.words = "Silent: no sample comes.";
    card.remedy = "Is it switched on, and is its cable in?";
    return card;
  }
  card.state = State::streaming;
  card.is_uncalibrated = device.hand->uncalibrated;
  card.words =
      std::to_string(std::lround(device.hand->glove->stats().rate_hz)) + " samples per second";
  if (!live.calibration.empty()) card.words += ", " + live.calibration;
  const SensorMask stuck = live.hand->left_out();
  if (stuck.bits != 0)
    card.remedy = sculpting::sensors_in_words(stuck) +
                  (sculpting::is_one(stuck) ? " is stuck" : " are stuck") +
                  ", and estimated from the sensors beside.";
  if (card.is_uncalibrated) card.remedy = "Not calibrated: the fingers are an average hand's.";
  return card;
}

void GloveBoard::update() {
  take_found();
  cards_.clear();
  const std::lock_guard lock(mutex_); // a device's hand may just be opening
  for (Live& live : live_) {
    if (live.device->hand && !live.device->error) read(live);
    cards_.push_back(card_of(live));
  }
}

bool GloveBoard::has_gloves() const noexcept {
  return std::ranges::any_of(
      cards_, [](const DeviceCard& card) { return card.side && !card.is_simulated; });
}

void GloveBoard::pose(render::SceneFrame& scene_frame) const {
  for (const Live& live : live_) {
    if (!live.hand) continue;
    const flow::GloveHand& hand = *live.hand;
    const hand::HandPose pose = hand.skeleton().pose(hand.angles, hand.T_stage_wrist);
    scene_frame.hands[hand.slot] = render::SceneHand{pose, pose.fingertip_positions(), false};
  }
}

} // namespace nendo::studio
