#pragma once
// Worker processes of this program that compete with the loop.

#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

#include <nendo/base/result.hpp>

namespace nendo::stress {

/// Parses the kinds of --load: "cpu" (arithmetic, a worker for each CPU), "mem" (copies 64 MiB to
/// and fro), "io" (writes and syncs a temporary file). Error: usage.
Result<std::vector<std::string>> parse_load(const std::string& text);

/// The workers run while this lives. The kernel ends them with this process, however that ends.
/// They have ordinary priority, whatever the caller's is.
class Load {
public:
  /// Starts workers of the kinds that parse_load() returned. It forks, so call it before there are
  /// other threads. Error: failed.
  static Result<Load> start(const std::vector<std::string>& kinds);
  ~Load(); ///< ends the workers and waits for them
  Load(Load&& other) noexcept : workers_(std::move(other.workers_)) { other.workers_.clear(); }
  Load& operator=(Load&&) = delete;

  const std::vector<pid_t>& workers() const noexcept { return workers_; }

private:
  Load() = default;

  std::vector<pid_t> workers_;
};

} // namespace nendo::stress
