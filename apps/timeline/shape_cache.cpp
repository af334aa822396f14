#include "timeline/shape_cache.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <nendo/flow/frame.hpp>

#include "timeline/hand_curve.hpp"

namespace nendo::timeline {
namespace {

std::size_t bytes_of(const deform::BlockShape& shape) {
  constexpr std::size_t block_bytes = sizeof(deform::VertexBlock) + sizeof(std::uint64_t);
  return sizeof(CachedShape) + shape.block_count() * block_bytes;
}

// Of a shape that is kept and the next.
std::uint64_t stride_for(std::uint64_t frames, std::size_t shape_bytes, std::size_t max_bytes) {
  const std::uint64_t max_gaps = std::max<std::uint64_t>(2, max_bytes / shape_bytes) - 1;
  return std::max<std::uint64_t>(1, (frames - 1 + max_gaps - 1) / max_gaps);
}

} // namespace

ShapeCache::ShapeCache(deform::Mesh model, std::size_t max_bytes)
    : model_(std::move(model)), max_bytes_(max_bytes), worker_([this] { work(); }) {}

ShapeCache::~ShapeCache() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    ++number_;
  }
  changed_.notify_all();
  worker_.join();
}

void ShapeCache::follow(Timeline timeline) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = std::move(timeline);
    ++number_;
    done_ = false;
  }
  changed_.notify_all();
}

void ShapeCache::work() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ends_ || wanted_; });
    if (ends_) return;
    Timeline timeline = *std::exchange(wanted_, std::nullopt);
    const std::uint64_t number = number_;
    lock.unlock();
    make_shapes(std::move(timeline), number);
  }
}

void ShapeCache::make_shapes(Timeline timeline, std::uint64_t number) {
  const auto player = Player::make(std::move(timeline), model_);
  std::optional<Error> error;
  if (player) {
    settle(**player, number);
    flow::HoldWatch holds;
    double held_since_s = 0.0;
    std::size_t slot = 0;
    for (std::uint64_t frame = 0; (*player)->next(); ++frame) {
      if (is_superseded(number)) return;
      if (holds.follow((*player)->frame())) held_since_s = (*player)->time_s();
      if (frame == frame_of(slot)) put(**player, slot++, held_since_s);
    }
  } else {
    error = player.error();
  }
  const std::lock_guard lock(mutex_);
  if (number != number_) return;
  error_ = std::move(error);
  done_ = true;
  changed_.notify_all();
}

/// Makes space for the shapes of another timeline. Those that apply to it remain fresh.
void ShapeCache::settle(const Player& player, std::uint64_t number) {
  const Timeline& timeline = player.timeline();
  const std::uint64_t frames = player.frame_count();
  const std::uint64_t stride = stride_for(frames, bytes_of(player.frame().shape), max_bytes_);
  const auto count = static_cast<std::size_t>((frames - 1 + stride - 1) / stride + 1);
  std::uint64_t unchanged = 0;
  if (made_of_ && stride == stride_ && timeline.rate_hz == rate_hz_)
    unchanged = unchanged_frames(*made_of_, frames_, timeline, frames, fresh_ * stride);
  made_of_ = timeline;
  const std::lock_guard lock(mutex_);
  if (stride != stride_ || timeline.rate_hz != rate_hz_) slots_.clear();
  slots_.resize(count);
  frames_ = frames;
  stride_ = stride;
  rate_hz_ = timeline.rate_hz;
  fresh_ = std::min(fresh_, count);
  while (fresh_ > 0 && frame_of(fresh_ - 1) >= unchanged)
    --fresh_;
  settled_ = number;
  error_.reset();
}

void ShapeCache::put(const Player& player, std::size_t slot, double held_since_s) {
  if (slot < fresh_) return; // only this thread changes it
  const flow::Frame& frame = player.frame();
  Shape shape = std::make_shared<const CachedShape>(
      CachedShape{frame.tick,
                  player.time_s(),
                  frame.held,
                  held_since_s,
                  frame.settings.radius_m,
                  {frame.functions.begin(), frame.functions.begin() + frame.function_count},
                  frame.shape,
                  player.model(frame.model)});
  const std::lock_guard lock(mutex_);
  std::swap(slots_[slot], shape); // the old one goes after the lock
  fresh_ = slot + 1;
}

bool ShapeCache::is_superseded(std::uint64_t number) const {
  const std::lock_guard lock(mutex_);
  return number != number_;
}

std::uint64_t ShapeCache::frame_of(std::size_t slot) const noexcept {
  return std::min<std::uint64_t>(slot * stride_, frames_ - 1);
}

std::size_t ShapeCache::slot_near(double time_s) const noexcept {
  const double frame = std::clamp(time_s * rate_hz_, 0.0, static_cast<double>(frames_ - 1));
  const auto before = static_cast<std::size_t>(frame / static_cast<double>(stride_));
  if (before + 1 >= slots_.size()) return slots_.size() - 1;
  const auto distance = [&](std::size_t slot) {
    return std::abs(static_cast<double>(frame_of(slot)) - frame);
  };
  return distance(before + 1) < distance(before) ? before + 1 : before;
}

ShapeCache::Found ShapeCache::nearest(double time_s) const {
  const std::lock_guard lock(mutex_);
  if (slots_.empty()) return {};
  const std::size_t wanted = slot_near(time_s);
  for (std::size_t off = 0; off < slots_.size(); ++off) {
    if (off <= wanted && slots_[wanted - off] != nullptr)
      return {slots_[wanted - off], off == 0 && wanted < fresh_ && settled_ == number_};
    if (wanted + off < slots_.size() && slots_[wanted + off] != nullptr)
      return {slots_[wanted + off], false};
  }
  return {};
}

std::vector<std::shared_ptr<const CachedShape>> ShapeCache::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<Shape> kept;
  std::ranges::copy_if(slots_, std::back_inserter(kept),
                       [](const Shape& shape) { return shape != nullptr; });
  return kept;
}

ShapeCache::Progress ShapeCache::progress() const {
  const std::lock_guard lock(mutex_);
  Progress progress;
  progress.done = done_;
  progress.error = error_;
  progress.stride = stride_;
  progress.shapes = slots_.size() - static_cast<std::size_t>(std::ranges::count(slots_, nullptr));
  if (frames_ == 0) return progress;
  progress.duration_s = static_cast<double>(frames_ - 1) / rate_hz_;
  if (settled_ == number_ && fresh_ > 0)
    progress.until_s = static_cast<double>(frame_of(fresh_ - 1)) / rate_hz_;
  return progress;
}

void ShapeCache::wait() const {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return done_; });
}

namespace {

// The frame before the one in which the first of the events that differ is due.
std::uint64_t frames_before_events(const Timeline& before, const Timeline& after,
                                   std::uint64_t most) {
  const auto [one, other] = std::ranges::mismatch(
      before.events, after.events, [](const Event& a, const Event& b) { return same_bits(a, b); });
  double first_s = longest_s;
  if (one != before.events.end()) first_s = std::min(first_s, one->time_s);
  if (other != after.events.end()) first_s = std::min(first_s, other->time_s);
  if (one == before.events.end() && other == after.events.end()) return most;
  const double frame = std::floor(first_s * before.rate_hz) - 1.0;
  return std::min(most, frame > 0.0 ? static_cast<std::uint64_t>(frame) : 0);
}

} // namespace

std::uint64_t unchanged_frames(const Timeline& before, std::uint64_t frames_before,
                               const Timeline& after, std::uint64_t frames_after,
                               std::uint64_t most) {
  if (before.hands.size() != after.hands.size()) return 0;
  if (before.rig != after.rig || before.rig_state != after.rig_state) return 0;
  if (before.masks != after.masks) return 0;
  most = std::min({most, frames_before, frames_after});
  // In the last frame, all that was asked for and is left is done.
  if (frames_before != frames_after)
    most = std::min(most, std::min(frames_before, frames_after) - 1);
  most = frames_before_events(before, after, most);
  for (std::size_t at = 0; at < before.hands.size(); ++at) {
    if (before.hands[at].side != after.hands[at].side) return 0;
    const HandCurve one(before.hands[at].keys);
    const HandCurve other(after.hands[at].keys);
    for (std::uint64_t frame = 0; frame < most; ++frame) {
      const double time_s = static_cast<double>(frame) / after.rate_hz;
      if (!same_bits(one.at(time_s), other.at(time_s))) most = frame;
    }
  }
  return most;
}

} // namespace nendo::timeline
