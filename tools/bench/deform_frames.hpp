#pragma once
// Times frames of the deformation, with poses of ten fingertips and strokes there and back. The
// best time of many counts.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>

#include <nendo/deform/type2.hpp>

namespace nendo::bench {

inline constexpr std::size_t poses = 16; ///< different ones, so that nothing is learnt by heart
/// The piece length with which end_at() applies any stroke in one piece.
inline constexpr double one_piece = 1e9;

/// Random end points of the fingertips, the same in every run.
std::array<deform::Points, poses> random_ends(const deform::Points& starts);

/// A clock that counts this thread's processor time, without the time of other work.
struct ThreadClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ThreadClock>;
  static constexpr bool is_steady = true;
  static time_point now() noexcept;
};

/// The best time of a few consecutive frames. Several measurements take turns. A turn lasts a
/// millisecond or a hundred frames, but at least eight frames, so that the caches hold the data of
/// this measurement and not of the one before it.
template <class Clock>
class BestBy {
public:
  /// Measures one turn. frame(n) makes the n-th frame of the turn.
  template <class Frame>
  void measure(std::size_t vertices, const Frame& frame) {
    constexpr std::chrono::milliseconds turn(1);
    constexpr std::size_t min_frames = 8;
    constexpr std::size_t max_frames = 100;
    const std::size_t frames =
        std::clamp<std::size_t>(100'000 / std::max<std::size_t>(vertices, 1), 2, 64);
    const auto begin = Clock::now();
    auto last = begin;
    for (std::size_t n = 0; n < min_frames || (n < max_frames && last - begin < turn);) {
      for (std::size_t end = n + frames; n < end; ++n)
        frame(n);
      const auto now = Clock::now();
      const std::chrono::duration<double, std::micro> took = now - last;
      us_ = std::min(us_, took.count() / static_cast<double>(frames));
      last = now;
    }
  }
  /// Returns the best time in microseconds, or 0 if nothing was measured.
  double us() const noexcept { return us_ < 1e300 ? us_ : 0.0; }
  double per_second() const noexcept { return us_ < 1e300 ? 1e6 / us_ : 0.0; }

private:
  double us_ = 1e300;
};

/// Calls `round` once, and again until the time is over.
template <class Round>
void for_seconds(double seconds, const Round& round) {
  const auto begin = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  do
    round();
  while (passed() < seconds);
}

using Best = BestBy<std::chrono::steady_clock>;
/// For frames that take longer than the scheduler lets a thread run without interruption.
using BestOfThread = BestBy<ThreadClock>;

/// Type-2 strokes of ten fingertips, forth and back, each applied as one piece. The way back is not
/// quite the inverse of the way forth: after thousands of strokes the vertices would gather in a
/// few places. So each turn begins with the original mesh.
class Strokes {
public:
  Strokes(const deform::Points& mesh, const deform::Points& starts, double radius, int threads = 1,
          const deform::CsrbfOptions& csrbf = {});

  /// Measures one turn.
  template <class Clock>
  void measure(BestBy<Clock>& best) {
    begin();
    best.measure(deformer_.layout().vertex_count(), [&](std::size_t n) { stroke(n); });
  }
  void begin() { deformer_.go(deform::HistoryMove::undo, starts_); }
  void stroke(std::size_t n) { deformer_.end_at(n % 2 == 0 ? ends_[n % poses] : starts_); }
  const deform::Type2Deformer& deformer() const noexcept { return deformer_; }

private:
  deform::Points starts_;
  std::array<deform::Points, poses> ends_;
  deform::Type2Deformer deformer_;
};

} // namespace nendo::bench
