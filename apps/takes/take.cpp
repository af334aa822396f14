#include "takes/take.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/driver/chunk_file.hpp>
#include <nendo/flow/finger_supports.hpp>
#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_tools.hpp>
#include <nendo/timeline/timeline_file.hpp>

#include "takes/recorded_model.hpp"
#include "takes/timeline_frames.hpp"

namespace nendo::takes {
namespace {

using recording::LoopReplay;
using recording::TakeReader;

// A recorded loop, which goes on from where it is for a later time and begins anew for an earlier
// one.
class Replayed {
public:
  Replayed(std::filesystem::path path, deform::Mesh model)
      : path_(std::move(path)), model_(std::move(model)) {}

  Result<viewer::SceneFrame> at(double time_s) {
    if (replay_ == nullptr || time_s < time_s_) {
      if (const auto begun = begin(); !begun) return begun.error();
    }
    time_s_ = time_s;
    const HostTime until = reader_->setup().begun_host + from_seconds(time_s);
    while (next_ && !(is_tick_after(*next_, until) && seen_)) {
      if (replay_->feed(*next_)) see();
      next_ = reader_->next();
    }
    if (!seen_)
      return Error{Errc::bad_input, path_.string() + ": there is no tick of a loop in it"};
    moment_.time_s = time_s;
    return moment_;
  }

private:
  static bool is_tick_after(const recording::Entry& entry, HostTime until) {
    const auto* const tick = std::get_if<flow::LoggedTick>(&entry);
    return tick != nullptr && tick->woke > until;
  }

  Result<void> begin() {
    auto reader = TakeReader::open(path_);
    if (!reader) return reader.error();
    reader_.emplace(*std::move(reader));
    auto replay = LoopReplay::make(reader_->setup(), model_);
    if (!replay) return Error{replay.error().code, path_.string() + ": " + replay.error().message};
    replay_ = *std::move(replay);
    holds_ = {};
    seen_ = false;
    next_ = reader_->next();
    return {};
  }

  void see() {
    auto& frames = replay_->loop().frames();
    if (!frames.update()) return;
    const flow::Frame& frame = frames.front();
    holds_.follow(frame);
    viewer::set_hands(frame, holds_, moment_);
    replay_->loop().layout().unpack(frame.shape, moment_.vertices);
    moment_.radius_m = flow::radii_on_stage(
        reader_->setup().loop->options.sculptor.deformer.supports, frame.units_per_metre);
    seen_ = true;
  }

  std::filesystem::path path_;
  deform::Mesh model_;
  std::optional<TakeReader> reader_;
  std::unique_ptr<LoopReplay> replay_;
  std::optional<recording::Entry> next_;
  viewer::HoldTracker holds_;
  viewer::SceneFrame moment_;
  double time_s_ = 0.0;
  bool seen_ = false; ///< moment_ is a tick's
};

Result<Take> read_recording(const std::filesystem::path& path) {
  const auto summary = recording::summarise(path);
  if (!summary) return summary.error();
  auto model = recorded_model(path.string(), summary->setup);
  if (!model) return model.error();
  Take take;
  take.rest = *model;
  take.units_per_metre = summary->setup.loop->placement.units_per_metre;
  take.duration_s = std::max(0.0, to_seconds(summary->duration()));
  const auto replayed = std::make_shared<Replayed>(path, *std::move(model));
  take.moment_at = [replayed](double time_s) { return replayed->at(time_s); };
  return take;
}

// A timeline, which goes on from where it is for a later time and begins anew for an earlier one.
class Played {
public:
  Played(std::filesystem::path path, std::unique_ptr<TimelineFrames> frames)
      : path_(std::move(path)), frames_(std::move(frames)) {}

  Result<viewer::SceneFrame> at(double time_s) {
    if (seen_ && time_s < frames_->time_s() && time_s < moment_.time_s) {
      auto anew = TimelineFrames::open(path_);
      if (!anew) return anew.error();
      frames_ = *std::move(anew);
      holds_ = {};
      seen_ = false;
    }
    while ((!seen_ || frames_->player().has_frame_by(time_s)) && frames_->next()) {
      holds_.follow(frames_->frame());
      seen_ = true;
    }
    const flow::Frame& frame = frames_->frame();
    viewer::set_hands(frame, holds_, moment_);
    frames_->layout().unpack(frame.shape, moment_.vertices);
    moment_.radius_m = flow::radii_on_stage(frames_->player().timeline().sculptor.deformer.supports,
                                            frame.units_per_metre);
    moment_.time_s = time_s;
    return moment_;
  }

private:
  std::filesystem::path path_;
  std::unique_ptr<TimelineFrames> frames_;
  viewer::HoldTracker holds_;
  viewer::SceneFrame moment_;
  bool seen_ = false;
};

Result<Take> play_timeline(const std::filesystem::path& path) {
  auto frames = TimelineFrames::open(path);
  if (!frames) return frames.error();
  Take take;
  take.rest = (*frames)->model();
  take.units_per_metre = (*frames)->player().timeline().units_per_metre;
  take.duration_s = (*frames)->duration_s();
  const auto played = std::make_shared<Played>(path, *std::move(frames));
  take.moment_at = [played](double time_s) { return played->at(time_s); };
  return take;
}

bool is_recording(const std::filesystem::path& path) {
  constexpr std::size_t magic_bytes = 8; // before the version
  std::array<char, magic_bytes> begin{};
  std::ifstream file(path, std::ios::binary);
  const auto wanted = driver::file_header();
  return file.read(begin.data(), begin.size()) &&
         std::memcmp(begin.data(), wanted.data(), magic_bytes) == 0;
}

} // namespace

Result<Take> read_take(const std::filesystem::path& path) {
  if (timeline::is_timeline(path)) return play_timeline(path);
  if (is_recording(path)) return read_recording(path);
  auto mesh = deform::read_mesh(path);
  if (!mesh) return mesh.error();
  Take take;
  take.rest = *std::move(mesh);
  take.moment_at = [vertices = take.rest.vertices](double) -> Result<viewer::SceneFrame> {
    viewer::SceneFrame moment;
    moment.vertices = vertices;
    return moment;
  };
  return take;
}

} // namespace nendo::takes
