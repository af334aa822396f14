#pragma once
// The parts that evaluation and weights share: the field, lists for each thread, and the second
// thread.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include <hwy/cache_control.h>

#include <nendo/base/atomics.hpp>
#include <nendo/base/job_offer.hpp>

#include "field/block_evaluator.hpp"
#include "field/block_field.hpp"

namespace nendo::deform {

/// A second thread that gets its work within a microsecond. It spins between jobs, so it keeps a
/// core busy as long as it lives.
class SpinWorker {
public:
  struct Job {
    void (*function)(void* context) noexcept = nullptr;
    void* context = nullptr;
  };

  SpinWorker() : thread_([this] { work(); }) {}
  ~SpinWorker() {
    offer_.offer({});
    thread_.join(); // the thread takes this last job as soon as it runs
  }
  SpinWorker(const SpinWorker&) = delete;
  SpinWorker& operator=(const SpinWorker&) = delete;

  /// Offers the job to the other thread. Wait-free. Call end() before the next run().
  void run(const Job& job) noexcept { offer_.offer(job); }
  /// Withdraws the job if the other thread, which may have no core, has not begun it. Otherwise
  /// spins until the job is done.
  void end() noexcept {
    if (offer_.withdraw()) return;
    while (!offer_.is_done())
      relax();
  }

private:
  void work() noexcept {
    for (Job job;;) {
      // If fewer cores are free than there are threads, this thread must leave its core to one that
      // has work.
      for (int turn = 0; !offer_.take(job); ++turn) {
        relax();
        if (turn % patience == patience - 1) std::this_thread::yield();
      }
      if (job.function == nullptr) return;
      job.function(job.context);
      offer_.done();
    }
  }

  static constexpr int patience = 4096;

  JobOffer<Job> offer_;
  std::thread thread_;
};

/// Returns whether a shape is too large to be expected to stay in the caches (350 000 vertices).
inline bool leaves_caches(const BlockShape& shape) noexcept {
  return shape.block_count() * sizeof(VertexBlock) > std::size_t{4} << 20;
}

/// Lists of centres, for one thread.
class ListArrays {
public:
  void reserve(std::size_t entries);
  ListScratch scratch() const noexcept {
    return {lists_.get(),
            {{{names_[0].get(), numbers_[0].get(), numbers_[1].get(), numbers_[2].get(),
               numbers_[3].get()},
              {names_[1].get(), numbers_[4].get(), numbers_[5].get(), numbers_[6].get(),
               numbers_[7].get()}}}};
  }

private:
  std::size_t entries_ = 0;
  VectorArray<std::uint32_t> lists_;
  std::array<VectorArray<std::uint32_t>, 2> names_;
  std::array<VectorArray<float>, 8> numbers_;
};

/// A thread takes this many blocks at a time, so that taking them costs little.
inline constexpr std::size_t blocks_per_piece = 16;

struct BlockEvaluator::Parts {
  Parts(const BlockLayout& layout, Eigen::Index entries, int threads);

  BlockField field;
  std::array<ListArrays, 2> lists;
  std::vector<std::uint8_t> reached;
  std::optional<SpinWorker> worker;
  /// Where vertices are asked for the next field, if the field before it was halfway.
  std::optional<BoundedShape> places;
  bool is_halfway = false; ///< the field is
  bool has_places = false;

  /// Calls range(begin, end, thread) for pieces of `count` blocks. One thread takes them from the
  /// front and the other from the back until they meet, so that each finds most of its pieces in
  /// its own core's caches the next time. Fewer than min_shared pieces are not shared, since they
  /// are done before the other thread has begun. The result of a piece must depend on the piece
  /// alone. Writes past the caches are flushed once a thread, because a flush takes as long as many
  /// blocks.
  template <class Range>
  void in_pieces(std::size_t count, std::size_t min_shared, const Range& range) noexcept;
};

template <class Range>
void BlockEvaluator::Parts::in_pieces(std::size_t count, std::size_t min_shared,
                                      const Range& range) noexcept {
  if (!worker || count < min_shared * blocks_per_piece) {
    range(std::size_t{0}, count, std::size_t{0});
    hwy::FlushStream();
    return;
  }
  struct Shared {
    const Range& range;
    std::size_t count, pieces;
    std::atomic<std::size_t> taken{0};

    void work(std::size_t thread) noexcept {
      for (std::size_t own = 0; taken.fetch_add(1, std::memory_order_relaxed) < pieces; ++own) {
        const std::size_t begin = (thread == 0 ? own : pieces - 1 - own) * blocks_per_piece;
        range(begin, std::min(begin + blocks_per_piece, count), thread);
      }
      hwy::FlushStream();
    }
  } shared{range, count, (count + blocks_per_piece - 1) / blocks_per_piece};
  worker->run({[](void* context) noexcept { static_cast<Shared*>(context)->work(1); }, &shared});
  shared.work(0);
  worker->end();
}

} // namespace nendo::deform
