#pragma once
// Caches the shapes of a timeline that is being edited, so that a play head can jump to any time. A
// thread of its own plays the timeline frame by frame and keeps every k-th shape, as memory allows,
// and the last one.

#include <array>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "timeline/player.hpp"
#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// Returns a number of frames at the beginning that are the same in both, bit for bit. It may be
/// too low, but never too high. `frames_before` and `frames_after` are Player::frame_count(). The
/// rates must be equal. At most `most` frames are compared.
std::uint64_t unchanged_frames(const Timeline& before, std::uint64_t frames_before,
                               const Timeline& after, std::uint64_t frames_after,
                               std::uint64_t most);

struct CachedShape {
  std::uint64_t frame = 0;
  double time_s = 0.0;
  bool held = false;
  double held_since_s = 0.0;        ///< where the fingertips grabbed, if held
  std::array<double, 5> radius_m{}; ///< each finger's radius then
  std::vector<float> functions;     ///< their values, of a puppet
  deform::BlockShape shape;
  std::shared_ptr<const flow::ModelVersion> model; ///< that the shape is of
};

class ShapeCache {
public:
  static constexpr std::size_t usual_bytes = std::size_t{256} << 20;
  /// The shapes of `model` take at most `max_bytes`, but two are always kept.
  explicit ShapeCache(deform::Mesh model, std::size_t max_bytes = usual_bytes);
  ~ShapeCache();
  ShapeCache(const ShapeCache&) = delete;
  ShapeCache& operator=(const ShapeCache&) = delete;

  /// Caches this timeline from now on. Does not block. Work on the previous timeline stops, and
  /// shapes that are the same in both are kept. Later timelines may differ from the first one by
  /// edits only (edit.hpp).
  void follow(Timeline timeline);

  struct Found {
    std::shared_ptr<const CachedShape> shape; ///< null if there is none yet
    bool fresh = false;                       ///< false if it was made before the last edits
  };
  /// Returns the cached shape for that time. Until that shape is made, it returns an older one or a
  /// neighbour.
  Found nearest(double time_s) const;

  /// Returns all shapes that are kept, in the order of time.
  std::vector<std::shared_ptr<const CachedShape>> all() const;

  struct Progress {
    double until_s = 0.0;       ///< shapes are fresh up to this time
    double duration_s = 0.0;    ///< the current timeline's duration
    std::uint64_t stride = 1;   ///< k
    bool done = false;          ///< all shapes are made, or there is an error
    std::size_t shapes = 0;     ///< that are kept
    std::optional<Error> error; ///< an error of Player::make()
  };
  Progress progress() const;
  /// Blocks until Progress::done.
  void wait() const;

private:
  using Shape = std::shared_ptr<const CachedShape>;
  void work();
  void make_shapes(Timeline timeline, std::uint64_t number);
  void settle(const Player& player, std::uint64_t number);
  void put(const Player& player, std::size_t slot, double held_since_s);
  bool is_superseded(std::uint64_t number) const;
  std::uint64_t frame_of(std::size_t slot) const noexcept;
  std::size_t slot_near(double time_s) const noexcept;

  const deform::Mesh model_;
  const std::size_t max_bytes_;
  std::optional<Timeline> made_of_; ///< the timeline of the fresh shapes; used by the worker only

  mutable std::mutex mutex_; ///< guards all members below
  mutable std::condition_variable changed_;
  std::optional<Timeline> wanted_; ///< the next timeline; nothing once work on it has begun
  std::uint64_t number_ = 0;       ///< number of the latest wanted timeline
  std::uint64_t settled_ = 0;      ///< number of the timeline that the following members describe
  std::vector<Shape> slots_;
  std::size_t fresh_ = 0; ///< the number of fresh shapes, which come first
  std::uint64_t frames_ = 0;
  std::uint64_t stride_ = 1;
  double rate_hz_ = 1.0;
  bool done_ = true;
  bool ends_ = false;
  std::optional<Error> error_;

  std::thread worker_;
};

} // namespace nendo::timeline
