#pragma once
// Shares work out among threads.

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace nendo::render {

/// Calls work(at) once for each `at` below `count`, by `threads` threads of which the caller is
/// one, and returns when all is done. Which thread does what is left to chance: so that results do
/// not depend on it, each call must write to places of its own.
template <class Work>
void each_in_parallel(std::size_t count, unsigned threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t at; (at = next++) < count;)
      work(at);
  };
  std::vector<std::jthread> others;
  for (unsigned thread = 1; thread < threads && thread < count; ++thread)
    others.emplace_back(take);
  take();
}

} // namespace nendo::render
