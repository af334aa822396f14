#pragma once
// Makes other models for a loop at random, as who runs it does, and is as late as it likes.

#include <memory>
#include <random>

#include <nendo/flow/deform_loop.hpp>

namespace nendo::test {

class LateMaker {
public:
  /// Models of that many vertices or more are not subdivided, but refined at any time.
  explicit LateMaker(unsigned seed, std::size_t max_vertices = 3000)
      : random_(seed), max_vertices_(max_vertices) {}

  /// To be called between two ticks.
  void turn(flow::DeformLoop& loop) {
    if (!finer_ && random_() % 40 == 0) begin(loop.changes().newest_model());
    if (!finer_ || (late_ > 0 && late_-- > 0)) return;
    if (!asked_) {
      asked_ = static_cast<bool>(loop.changes().hold_still());
      late_ = random_() % 8;
    } else if (loop.changes().is_still()) {
      give(loop);
    }
  }
  bool is_idle(flow::DeformLoop& loop) const { return !finer_ && !loop.changes().is_changing(); }
  int made() const noexcept { return made_; }

private:
  void begin(const flow::ModelVersion& model) {
    late_ = random_() % 8;
    if (random_() % 2 == 0) {
      if (auto refined = flow::PendingModel::make(model, *flow::model_asked_by(flow::Refine{})))
        finer_ = std::make_unique<flow::PendingModel>(*std::move(refined));
    } else if (model.layout().vertex_count() < max_vertices_) {
      finer_ = std::make_unique<flow::PendingModel>(model);
    }
  }
  void give(flow::DeformLoop& loop) {
    if (finer_->is_of(loop.changes().newest_model()) && random_() % 8 != 0) {
      made_ += loop.changes().change_model(*finer_) ? 1 : 0;
    } else {
      loop.changes().keep_model();
    }
    finer_.reset();
    asked_ = false;
  }

  std::mt19937 random_;
  std::size_t max_vertices_;
  std::unique_ptr<flow::PendingModel> finer_;
  bool asked_ = false;
  unsigned long late_ = 0; ///< turns until it continues
  int made_ = 0;
};

} // namespace nendo::test
