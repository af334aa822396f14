#pragma once
// Small pictures of a timeline's shapes, for the strip of them along its time. A thread that has
// the processor only when no other thread wants it draws them one after another. Main thread.

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include <nendo/base/event_count.hpp>
#include <nendo/base/job_offer.hpp>

#include "render/image.hpp"
#include "timeline/shape_cache.hpp"

namespace nendo::edit {

class ShapePictures {
public:
  using Shape = std::shared_ptr<const timeline::CachedShape>;
  using Picture = std::shared_ptr<const render::Image>;
  static constexpr render::Size picture_size{280, 112};
  /// Parts of picture_size.width at both sides beyond these have no part of a model at rest.
  static constexpr int model_width_px = 140;

  /// units_per_metre: the timeline's
  explicit ShapePictures(double units_per_metre);
  /// Ends after the picture that is being drawn.
  ~ShapePictures();
  ShapePictures(const ShapePictures&) = delete;
  ShapePictures& operator=(const ShapePictures&) = delete;

  /// Returns the pictures of these shapes, and null for those that are null or not drawn yet, which
  /// are drawn next, in this order. Equal shapes have the same picture. Wait-free but for memory.
  std::vector<Picture> of(std::span<const Shape> shapes);
  /// From now on, the thread competes with others: someone waits for the pictures.
  void hurry() noexcept;
  /// Returns how many pictures were drawn so far.
  std::uint64_t drawn_count() const noexcept { return drawn_; }

private:
  struct Job {
    Shape shape;
    Picture picture;
  };
  class Painter;
  void work();
  void keep_only(std::span<const Shape> shapes);

  std::unique_ptr<Painter> painter_; ///< the worker's
  std::map<std::weak_ptr<const timeline::CachedShape>, Picture, std::owner_less<>> pictures_;
  Job job_;
  bool has_job_ = false; ///< the worker has job_
  JobOffer<Job*> offer_;
  EventCount offered_;
  std::atomic<std::uint64_t> drawn_ = 0;
  std::atomic<bool> ends_ = false;
  std::thread worker_;
};

} // namespace nendo::edit
