#include "takes/recorded_frames.hpp"

#include <algorithm>
#include <utility>

#include <nendo/flow/rig_setup.hpp>

namespace nendo::takes {
namespace {

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

} // namespace nendo::takes
