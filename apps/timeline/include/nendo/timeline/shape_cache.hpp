#pragma once
// Shapes of a timeline that is being edited, made by a thread of its own, so that a play head can
// be anywhere at once. They are Player's, one frame after another; every k-th is kept, as many as
// the memory allows, and the last.

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nendo/timeline/player.hpp>

namespace nendo::timeline {

struct CachedShape {
  std::uint64_t frame = 0;
  double time_s = 0.0;
  bool held = false;
  double held_since_s = 0.0; ///< where the fingertips took hold, if held
  deform::BlockShape shape;
};

class ShapeCache {
public:
  static constexpr std::size_t usual_bytes = std::size_t{256} << 20;
  /// Shapes over `model` take at most most_bytes, and two of them whatever they take.
  explicit ShapeCache(deform::Mesh model, std::size_t most_bytes = usual_bytes);
  ~ShapeCache();
  ShapeCache(const ShapeCache&) = delete;
  ShapeCache& operator=(const ShapeCache&) = delete;

  /// From now on this one. Does not wait: what is being made is given up, and what must be the same
  /// in both is kept. Timelines that follow the first differ from it by edits alone (edit.hpp).
  void follow(Timeline timeline);

  struct Found {
    std::shared_ptr<const CachedShape> shape; ///< null: there is none yet
    bool fresh = false; ///< of the timeline as it is; otherwise of one before its last edits
  };
  /// The shape that is kept for the moment; while it is not made, an older one, or its neighbour.
  Found nearest(double time_s) const;

  struct Progress {
    double until_s = 0.0;       ///< fresh ones reach so far
    double duration_s = 0.0;    ///< of the timeline that is worked on
    std::uint64_t stride = 1;   ///< k
    bool done = false;          ///< all are there, or there is a complaint
    std::size_t shapes = 0;     ///< that are kept
    std::optional<Error> error; ///< as Player::make()
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
  const std::size_t most_bytes_;
  std::optional<Timeline> made_of_; ///< the worker's alone: of which the fresh ones are

  mutable std::mutex mutex_; ///< of all below
  mutable std::condition_variable changed_;
  std::optional<Timeline> wanted_; ///< and not begun yet
  std::uint64_t number_ = 0;       ///< of the latest that was wanted
  std::uint64_t settled_ = 0;      ///< of the one that these are about:
  std::vector<Shape> slots_;
  std::size_t fresh_ = 0; ///< so many at the beginning are its own
  std::uint64_t frames_ = 0;
  std::uint64_t stride_ = 1;
  double rate_hz_ = 1.0;
  bool done_ = true;
  bool ends_ = false;
  std::optional<Error> error_;

  std::thread worker_;
};

} // namespace nendo::timeline
