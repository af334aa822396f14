#include "takes/take.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/recording/chunk_file.hpp>
#include <nendo/recording/take_tools.hpp>

#include "takes/model_files.hpp"
#include "takes/recorded_frames.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/timeline.hpp"

namespace nendo::takes {
namespace {

using OpenFrames = decltype(Take::open);

/// The scenes of a take at any time. It plays on for a later time, and restarts for an earlier
/// one.
class ScenePlayer {
public:
  /// `source` may be the frames that were opened first, or null.
  explicit ScenePlayer(OpenFrames open, std::unique_ptr<FrameSource> source = nullptr)
      : open_(std::move(open)), opened_(std::move(source)) {}

  /// Returns the scene of the last frame that is not later than `time_s`, or of the first frame.
  Result<render::SceneFrame> at(double time_s) {
    if (source_ == nullptr || time_s < scene_.time_s) {
      if (const auto begun = begin(); !begun) return begun.error();
    }
    const double latest_s = time_s + rounding / source_->rate_hz();
    while (has_next_ && next_.time_s <= latest_s)
      advance();
    render::SceneFrame scene = scene_;
    scene.time_s = time_s;
    return scene;
  }

private:
  static constexpr double rounding = 1e-6; // of the time between two frames

  Result<void> begin() {
    if (opened_ == nullptr) {
      auto opened = open_();
      if (!opened) return opened.error();
      opened_ = *std::move(opened);
    }
    source_ = std::move(opened_);
    holds_ = {};
    model_ = 0;
    mesh_ = nullptr;
    has_next_ = read_next();
    advance();
    return {};
  }

  void advance() {
    std::swap(scene_, next_);
    has_next_ = read_next();
  }

  /// Makes the scene of the next frame. Returns false if there is none.
  bool read_next() {
    if (!source_->next()) return false;
    const flow::Frame& frame = source_->frame();
    holds_.follow(frame);
    render::set_hands(frame, holds_, next_);
    source_->layout(frame.model).unpack(frame.shape, next_.vertices);
    if (frame.model != model_) {
      model_ = frame.model;
      mesh_ = std::make_shared<const deform::Mesh>(source_->model(model_));
    }
    next_.mesh = mesh_;
    next_.radius_m = frame.settings.radius_m;
    next_.time_s = source_->time_s();
    return true;
  }

  OpenFrames open_;
  std::unique_ptr<FrameSource> opened_;
  std::unique_ptr<FrameSource> source_;
  render::HoldTracker holds_;
  render::SceneFrame scene_;
  render::SceneFrame next_; ///< if has_next_
  bool has_next_ = false;
  std::uint32_t model_ = 0;                  ///< the latest frame's
  std::shared_ptr<const deform::Mesh> mesh_; ///< the mesh of that version; null: Take::rest
};

/// The mean time of the first samples of all gloves. It is negative where they came before the
/// recording began.
double first_sample_s(const recording::Setup& setup) {
  double sum_s = 0.0;
  for (const auto& hand : setup.hands)
    sum_s += seconds_between(setup.begun_host, hand.first.time());
  return setup.hands.empty() ? 0.0 : sum_s / static_cast<double>(setup.hands.size());
}

Result<Take> read_recording(const std::filesystem::path& path, const std::string& named) {
  const auto summary = recording::summarise(path);
  if (!summary) return summary.error();
  auto model = recorded_model(path.string(), summary->setup, named);
  if (!model) return model.error();
  const recording::LoopSetup& loop = *summary->setup.loop;
  Take take;
  take.rest = model->mesh;
  take.units_per_metre = loop.placement.units_per_metre;
  take.duration_s = std::max(0.0, to_seconds(summary->duration()));
  take.first_sample_s = first_sample_s(summary->setup);
  const auto open = [path,
                     model = std::move(model->mesh)]() -> Result<std::unique_ptr<FrameSource>> {
    auto frames = RecordedFrames::open(path, model);
    if (!frames) return frames.error();
    return std::unique_ptr<FrameSource>(*std::move(frames));
  };
  take.open = open;
  const auto player = std::make_shared<ScenePlayer>(open);
  take.frame_at = [player](double time_s) { return player->at(time_s); };
  return take;
}

Result<Take> read_edited(const std::filesystem::path& path, const std::string& named) {
  auto frames = TimelineFrames::open(path, named);
  if (!frames) return frames.error();
  const timeline::Timeline& timeline = (*frames)->player().timeline();
  Take take;
  take.rest = (*frames)->model(0);
  take.units_per_metre = timeline.units_per_metre;
  take.duration_s = (*frames)->duration_s();
  const auto open = [timeline, rest = take.rest]() -> Result<std::unique_ptr<FrameSource>> {
    auto again = TimelineFrames::make(timeline, rest);
    if (!again) return again.error();
    return std::unique_ptr<FrameSource>(*std::move(again));
  };
  take.open = open;
  const auto player = std::make_shared<ScenePlayer>(open, *std::move(frames));
  take.frame_at = [player](double time_s) { return player->at(time_s); };
  return take;
}

bool is_recording(const std::filesystem::path& path) {
  constexpr std::size_t magic_bytes = 8; // before the version
  std::array<char, magic_bytes> begin{};
  std::ifstream file(path, std::ios::binary);
  const auto wanted = recording::file_header();
  return file.read(begin.data(), begin.size()) &&
         std::memcmp(begin.data(), wanted.data(), magic_bytes) == 0;
}

constexpr std::size_t max_poses = 20'000; // of longer takes, every other frame, or fewer

struct Pose {
  double time_s;
  std::vector<double> numbers;
};

std::vector<double> numbers_of(const flow::Frame& frame) {
  if (frame.function_count > 0)
    return {frame.functions.begin(), frame.functions.begin() + frame.function_count};
  std::vector<double> numbers;
  for (const flow::HandFrame& hand : frame.hands)
    for (std::size_t angle = 0; hand.present && angle < hand::angle_count; ++angle)
      numbers.push_back(hand.angles[hand::angle_at(angle)]);
  return numbers;
}

double squared_difference(const Pose& one, const Pose& other) {
  double sum = 0.0;
  for (std::size_t at = 0; at < std::min(one.numbers.size(), other.numbers.size()); ++at) {
    const double apart = one.numbers[at] - other.numbers[at];
    sum += apart * apart;
  }
  return sum;
}

std::vector<Pose> poses_of(FrameSource& frames) {
  std::vector<Pose> poses;
  std::size_t every = 1;
  for (std::size_t number = 0; frames.next(); ++number) {
    if (number % every != 0) continue;
    poses.push_back({frames.time_s(), numbers_of(frames.frame())});
    if (poses.size() < max_poses) continue;
    for (std::size_t at = 1; 2 * at < poses.size(); ++at)
      poses[at] = std::move(poses[2 * at]);
    poses.resize((poses.size() + 1) / 2);
    every *= 2;
  }
  return poses;
}

/// Which of them the hands hold. Hands pass many poses on their way; they mean those that they
/// hold.
std::vector<bool> held(const std::vector<Pose>& poses) {
  constexpr double about_s = 0.1;
  constexpr double max_part = 0.05; // of the fastest change, squared
  std::vector<double> change(poses.size());
  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t at = 0; at < poses.size(); ++at) {
    while (poses[at].time_s - poses[from].time_s > about_s)
      ++from;
    while (to + 1 < poses.size() && poses[to + 1].time_s - poses[at].time_s <= about_s)
      ++to;
    change[at] = squared_difference(poses[from], poses[to]);
  }
  const double most = poses.empty() ? 0.0 : *std::max_element(change.begin(), change.end());
  std::vector<bool> held;
  held.reserve(change.size());
  for (const double one : change)
    held.push_back(one <= max_part * most);
  return held;
}

/// The one that is farthest from all that were chosen: of those that are held, or else of all.
std::size_t farthest(const std::vector<double>& nearest, const std::vector<bool>& held) {
  std::size_t best = 0;
  for (const bool any : {false, true}) {
    for (std::size_t at = 0; at < nearest.size(); ++at)
      if ((any || held[at]) && nearest[at] > nearest[best]) best = at;
    if (nearest[best] > 0.0) break;
  }
  return best;
}

} // namespace

Result<Take> read_take(const std::filesystem::path& path, const deform::ReadOptions& reading,
                       const std::string& model) {
  if (timeline::is_timeline(path)) return read_edited(path, model);
  if (is_recording(path)) return read_recording(path, model);
  if (!model.empty())
    return Error{Errc::usage,
                 "--mesh: " + printable(path.string()) + " is itself a model; leave it out"};
  auto read = read_model(path.string(), reading);
  if (!read) return read.error();
  Take take;
  take.rest = std::move(read->mesh);
  take.frame_at = [vertices = take.rest.vertices](double) -> Result<render::SceneFrame> {
    render::SceneFrame scene_frame;
    scene_frame.vertices = vertices;
    return scene_frame;
  };
  return take;
}

std::vector<double> key_poses(FrameSource& frames, std::size_t count) {
  const std::vector<Pose> poses = poses_of(frames);
  const std::vector<bool> is_held = held(poses);
  std::vector<double> times;
  std::vector<double> nearest(poses.size(), std::numeric_limits<double>::infinity());
  for (std::size_t next = 0; times.size() < std::min(count, poses.size());) {
    times.push_back(poses[next].time_s);
    for (std::size_t at = 0; at < poses.size(); ++at)
      nearest[at] = std::min(nearest[at], squared_difference(poses[at], poses[next]));
    next = farthest(nearest, is_held);
    if (!(nearest[next] > 0.0)) break;
  }
  std::sort(times.begin(), times.end());
  return times;
}

} // namespace nendo::takes
