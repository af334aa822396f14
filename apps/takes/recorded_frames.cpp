#include "takes/recorded_frames.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <utility>
#include <variant>

#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::takes {
namespace {

bool is_of_simulated(std::string_view source) {
  const auto spec = driver::parse_device_spec(source);
  return spec && spec->kind == "sim";
}

/// Recognises it by the source of a glove's samples, because a recording keeps no more of that.
bool was_simulated(const driver::GloveInfo& glove) {
  return is_of_simulated(glove.source) ||
         std::any_of(glove.facts.begin(), glove.facts.end(), [](const auto& fact) {
           return fact.name == "recorded_from" && is_of_simulated(fact.value);
         });
}

// Returns the time of a tick. Times do not fall, whatever the recording says.
double time_after(double before_s, const recording::Setup& setup, const flow::LoggedTick& tick) {
  return std::max(before_s, seconds_between(setup.begun_host, tick.woke));
}

struct Extent {
  std::uint64_t ticks = 0;
  double first_s = 0.0;
  double last_s = 0.0;
  bool has_one_model = true;
};

Extent extent_of(recording::TakeReader reader) {
  Extent extent;
  while (const auto entry = reader.next()) {
    if (std::holds_alternative<flow::ChangeModel>(*entry)) extent.has_one_model = false;
    const auto* const tick = std::get_if<flow::LoggedTick>(&*entry);
    if (tick == nullptr) continue;
    extent.last_s = time_after(extent.last_s, reader.setup(), *tick);
    if (extent.ticks++ == 0) extent.first_s = extent.last_s;
  }
  return extent;
}

double rate_of(const flow::LoopOptions& options, const Extent& extent) {
  if (options.policy != flow::OverrunPolicy::sample) return options.rate_hz;
  const double length_s = extent.last_s - extent.first_s;
  return length_s > 0.0 ? static_cast<double>(extent.ticks - 1) / length_s : options.rate_hz;
}

} // namespace

bool is_calibrated(const recording::Setup& setup, std::size_t glove) {
  const flow::HandInput& hand = setup.hands[glove];
  if (hand.wearer.adapt) return true;
  if (glove >= setup.gloves.size()) return false; // its description is damaged
  const driver::GloveInfo& info = setup.gloves[glove];
  return was_simulated(info) ||
         !(hand.wearer.of(hand.first.side).calibration == hand::default_calibration(info.counts));
}

std::optional<bool> is_calibrated(const recording::Setup& setup, Side side) {
  for (std::size_t glove = 0; glove < setup.hands.size(); ++glove)
    if (setup.hands[glove].side == side) return is_calibrated(setup, glove);
  return std::nullopt;
}

Result<GloveSamples> GloveSamples::open(const std::filesystem::path& path) {
  auto reader = recording::TakeReader::open(path);
  if (!reader) return reader.error();
  return GloveSamples(*std::move(reader));
}

GloveSamples::GloveSamples(recording::TakeReader reader) : reader_(std::move(reader)) {
  const recording::Setup& setup = reader_.setup();
  for (std::size_t glove = 0; glove < setup.hands.size(); ++glove)
    gloves_.push_back(
        {hand::ActiveCalibration(setup.hands[glove].wearer), takes::is_calibrated(setup, glove)});
}

SensorMask GloveSamples::sensors() const {
  SensorMask sensors;
  for (const auto& glove : reader_.setup().gloves)
    sensors.bits |= glove.sensors.bits;
  for (const auto& hand : reader_.setup().hands)
    sensors.bits |= hand.first.present.bits;
  return sensors;
}

bool GloveSamples::next() {
  while (const auto entry = reader_.next()) {
    if (std::holds_alternative<recording::Gap>(*entry)) exact_ = false;
    const auto* const recorded = std::get_if<recording::RecordedSample>(&*entry);
    if (recorded == nullptr) continue;
    sample_ = recorded->sample;
    glove_ = recorded->glove;
    calibration_ = glove_ < gloves_.size() ? &gloves_[glove_].calibration.follow(sample_) : nullptr;
    return true;
  }
  return false;
}

Result<std::unique_ptr<RecordedFrames>> RecordedFrames::open(const std::filesystem::path& path,
                                                             const deform::Mesh& model) {
  auto scanned = recording::TakeReader::open(path);
  if (!scanned) return scanned.error();
  const Extent extent = extent_of(*std::move(scanned));
  auto reader = recording::TakeReader::open(path);
  if (!reader) return reader.error();
  std::unique_ptr<RecordedFrames> frames(new RecordedFrames(*std::move(reader)));
  auto replay = recording::LoopReplay::make(frames->setup(), model);
  if (!replay) return Error{replay.error().code, path.string() + ": " + replay.error().message};
  if (extent.ticks == 0)
    return Error{Errc::bad_input, path.string() + ": there is no tick of a loop in it"};
  frames->replay_ = *std::move(replay);
  frames->rate_hz_ = rate_of(frames->setup().loop->options, extent);
  frames->duration_s_ = extent.last_s;
  frames->has_one_model_ = extent.has_one_model;
  return frames;
}

std::optional<PlayedPuppet> RecordedFrames::puppet() const {
  flow::DeformLoop& loop = replay_->loop();
  const auto& rig = loop.changes().puppet(loop.frames().front().puppet);
  if (!flow::is_played(rig.get())) return std::nullopt;
  return PlayedPuppet{rig, loop.changes().sculptor_options()};
}

bool RecordedFrames::next() {
  while (const auto entry = reader_.next()) {
    if (!replay_->feed(*entry)) continue;
    time_s_ = time_after(time_s_, setup(), std::get<flow::LoggedTick>(*entry));
    replay_->loop().frames().update();
    return true;
  }
  return false;
}

namespace {

constexpr HostClock::duration silent_after = std::chrono::milliseconds(500); // as of a run

struct GloveExtent {
  std::uint64_t samples = 0;
  HostTime first{};
  HostTime last{};

  double rate_hz() const {
    const double length_s = seconds_between(first, last);
    return samples > 1 && length_s > 0.0 ? static_cast<double>(samples - 1) / length_s : 0.0;
  }
};

std::vector<GloveExtent> extents_of(recording::TakeReader reader) {
  std::vector<GloveExtent> gloves(reader.setup().hands.size());
  while (const auto entry = reader.next()) {
    const auto* const recorded = std::get_if<recording::RecordedSample>(&*entry);
    if (recorded == nullptr || recorded->glove >= gloves.size()) continue;
    GloveExtent& glove = gloves[recorded->glove];
    glove.last = recorded->sample.arrival;
    if (glove.samples++ == 0) glove.first = glove.last;
  }
  return gloves;
}

Eigen::Isometry3d wrist_of(Side side) {
  Eigen::Isometry3d wrist = Eigen::Isometry3d::Identity();
  wrist.translation().x() =
      side == Side::left ? -GloveFrames::wrist_aside_m : GloveFrames::wrist_aside_m;
  return wrist;
}

} // namespace

Result<std::unique_ptr<GloveFrames>> GloveFrames::open(const std::filesystem::path& path) {
  auto scanned = recording::TakeReader::open(path);
  if (!scanned) return scanned.error();
  const auto gloves = extents_of(*std::move(scanned));
  auto reader = recording::TakeReader::open(path);
  if (!reader) return reader.error();
  std::unique_ptr<GloveFrames> frames(new GloveFrames(*std::move(reader)));
  const HostTime begun = frames->reader_.setup().begun_host;
  std::uint64_t samples = 0;
  for (const GloveExtent& glove : gloves) {
    samples += glove.samples;
    frames->rate_hz_ = std::max(frames->rate_hz_, glove.rate_hz());
    if (glove.samples > 0)
      frames->duration_s_ = std::max(frames->duration_s_, seconds_between(begun, glove.last));
  }
  if (samples == 0)
    return Error{Errc::bad_input, path.string() + ": there is no sample of a glove in it"};
  if (!(frames->rate_hz_ > 0.0)) frames->rate_hz_ = 1.0; // one moment has no rate
  return frames;
}

GloveFrames::GloveFrames(recording::TakeReader reader)
    : reader_(std::move(reader)), layout_(deform::Points(3, 0)) {
  for (auto& hand : frame_.hands)
    hand.pose.joints.fill(Eigen::Isometry3d::Identity());
  frame_.held = false;
  flow::Placement placement;
  for (const Side side : {Side::left, Side::right})
    placement.T_stage_wrist[flow::Placement::index_of(side)] = wrist_of(side);
  for (flow::HandInput input : reader_.setup().hands) {
    input.filter = {}; // poses of samples as they are
    hands_.emplace_back(std::move(input), placement, false);
    frame_.hands[hands_.back().slot].present = true;
    show(hands_.back());
  }
}

void GloveFrames::show(const flow::GloveHand& hand) noexcept {
  flow::HandFrame& shown = frame_.hands[hand.slot];
  shown.sensors = hand.latest.present;
  shown.left_out = hand.left_out();
  shown.angles = hand.angles;
  shown.T_stage_wrist = hand.T_stage_wrist;
  shown.pose = hand.skeleton().pose(shown.angles, shown.T_stage_wrist);
  shown.swapped = hand.latest.side != hand.input.first.side;
}

void GloveFrames::note_silence(HostTime now) noexcept {
  for (const flow::GloveHand& hand : hands_)
    frame_.hands[hand.slot].silent = now - hand.latest.arrival > silent_after;
}

bool GloveFrames::next() {
  while (const auto entry = reader_.next()) {
    const auto* const recorded = std::get_if<recording::RecordedSample>(&*entry);
    if (recorded == nullptr || recorded->glove >= hands_.size()) {
      exact_ = exact_ && recorded == nullptr && !std::holds_alternative<recording::Gap>(*entry);
      continue;
    }
    flow::GloveHand& hand = hands_[recorded->glove];
    hand.update(recorded->sample);
    show(hand);
    ++frame_.hands[hand.slot].samples;
    frame_.tick = frame_.ticks_run++;
    frame_.woke = frame_.scheduled = recorded->sample.arrival;
    note_silence(frame_.woke);
    // Times do not fall, whatever the recording says. The first samples came before it began.
    time_s_ = std::max(time_s_, seconds_between(reader_.setup().begun_host, frame_.woke));
    return true;
  }
  return false;
}

} // namespace nendo::takes
