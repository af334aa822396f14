#include "bench/deform_frames.hpp"

#include <ctime>
#include <random>

#include "bench/table1.hpp"

namespace nendo::app {

ThreadClock::time_point ThreadClock::now() noexcept {
  std::timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

std::array<deform::Points, poses> random_ends(const deform::Points& starts) {
  std::mt19937 random(1);
  std::array<deform::Points, poses> ends;
  for (auto& end : ends)
    end = starts + table1_displacements(random);
  return ends;
}

void stroke(deform::Type2Deformer& deformer, const deform::Points& starts,
            const std::array<deform::Points, poses>& ends, std::size_t n) {
  deformer.end_at(n % 2 == 0 ? ends[n % poses] : starts);
}

} // namespace nendo::app
