#include "bench/deform_frames.hpp"

#include <ctime>
#include <random>

#include "reference/table1.hpp"

namespace nendo::bench {

ThreadClock::time_point ThreadClock::now() noexcept {
  std::timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

std::array<deform::Points, poses> random_ends(const deform::Points& starts) {
  std::mt19937 random(1);
  std::array<deform::Points, poses> ends;
  for (auto& end : ends)
    end = starts + reference::table1_displacements(random);
  return ends;
}

namespace {

deform::DeformerOptions undoable(const deform::Points& mesh, double radius, int threads,
                                 const deform::CsrbfOptions& csrbf) {
  deform::DeformerOptions options;
  options.supports = deform::one_radius(radius);
  options.csrbf = csrbf;
  options.evaluation.threads = threads;
  constexpr std::size_t bytes_a_block = 832; // and as many for the step
  options.undo_bytes =
      bytes_a_block * (static_cast<std::size_t>(mesh.cols()) / deform::block_size + 2);
  return options;
}

} // namespace

Strokes::Strokes(const deform::Points& mesh, const deform::Points& starts, double radius,
                 int threads, const deform::CsrbfOptions& csrbf)
    : starts_(starts), ends_(random_ends(starts)),
      deformer_(mesh, starts.cols(), one_piece, undoable(mesh, radius, threads, csrbf)) {
  deformer_.begin(starts_);
}

} // namespace nendo::bench
