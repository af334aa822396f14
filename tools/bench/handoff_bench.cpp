// nendo bench rt, the hand-off: what publishing a frame costs the thread that made it. The baseline
// is what middleware usually does: under a mutex the frame is copied for a publishing thread, which
// a condition variable then wakes.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/base/triple_buffer.hpp>

#include "bench/percentiles.hpp"
#include "bench/rt_bench.hpp"
#include "bench/two_threads.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Frame = std::vector<std::uint64_t>;

constexpr std::uint64_t publishes_a_round = 200;
constexpr std::chrono::microseconds period{500};
constexpr std::chrono::milliseconds poll_period{1};

/// Prevents the compiler from removing unused results.
std::atomic<std::uint64_t> sum_seen{0};

void read(const Frame& frame) {
  std::uint64_t sum = 0;
  for (const std::uint64_t word : frame)
    sum += word;
  sum_seen.store(sum, std::memory_order_relaxed);
}

/// The triple buffer: filled in its place, read by a thread that polls.
class Exchanged {
public:
  explicit Exchanged(std::size_t words) : value_(Frame(words)) {}
  Frame& frame() noexcept { return value_.back(); }
  void publish() noexcept { value_.publish(); }
  void read_until(const std::atomic<bool>& done) {
    while (!done) {
      if (value_.update()) read(value_.front());
      std::this_thread::sleep_for(poll_period);
    }
  }
  void wake() noexcept {}

private:
  TripleBuffer<Frame> value_;
};

class Notified {
public:
  explicit Notified(std::size_t words) : own_(words), shared_(words), published_(words) {}
  Frame& frame() noexcept { return own_; }
  void publish() {
    {
      const std::lock_guard lock(mutex_);
      shared_ = own_;
      fresh_ = true;
    }
    ready_.notify_one();
  }
  void read_until(const std::atomic<bool>& done) {
    while (!done) {
      {
        std::unique_lock lock(mutex_);
        ready_.wait(lock, [&] { return fresh_ || done; });
        fresh_ = false;
        published_.swap(shared_);
      }
      read(published_);
    }
  }
  void wake() {
    const std::lock_guard lock(mutex_);
    ready_.notify_one();
  }

private:
  Frame own_;
  Frame shared_;
  Frame published_;
  std::mutex mutex_;
  std::condition_variable ready_;
  bool fresh_ = false;
};

struct Times {
  std::vector<double> publishes_ns;
  std::vector<double> round_trips_ns; ///< round trips of a cache line, before each round
};

template <class Publisher>
void measure_round(const cli::TwoProcessors& processors, std::size_t words, Times& times) {
  Publisher publisher(words);
  PingPong ball;
  std::atomic<bool> done{false};
  const auto write = [&] {
    times.round_trips_ns.push_back(ball.measure_ns());
    auto deadline = Clock::now();
    for (std::uint64_t n = 0; n < publishes_a_round; ++n) {
      std::fill(publisher.frame().begin(), publisher.frame().end(), n);
      const auto begin = Clock::now();
      publisher.publish();
      const std::chrono::duration<double, std::nano> took = Clock::now() - begin;
      times.publishes_ns.push_back(took.count());
      std::this_thread::sleep_until(deadline += period);
    }
    done = true;
    publisher.wake();
  };
  run_on(processors, write, [&] {
    ball.answer();
    publisher.read_until(done);
  });
}

struct Cost {
  double p50_ns = 0.0;
  double p999_ns = 0.0;
  double round_trip_p50_ns = 0.0;
};

Cost cost_of(const Times& times) {
  return {percentile(times.publishes_ns, 0.5), percentile(times.publishes_ns, 0.999),
          percentile(times.round_trips_ns, 0.5)};
}

void print(std::size_t frame_bytes, std::size_t publishes, const Cost& exchanged,
           const Cost& notified, bool json) {
  const double ratio = notified.p50_ns / std::max(exchanged.p50_ns, 1.0);
  if (json) {
    cli::print_line({{"part", "handoff"},
                     {"frame_bytes", frame_bytes},
                     {"publishes", publishes},
                     {"publish_p50_ns", exchanged.p50_ns},
                     {"publish_p999_ns", exchanged.p999_ns},
                     {"notify_p50_ns", notified.p50_ns},
                     {"notify_p999_ns", notified.p999_ns},
                     {"notify_to_publish_p50", ratio},
                     {"round_trip_ns", exchanged.round_trip_p50_ns}});
  } else {
    cli::print(
        "publishing {} bytes, {} times: p50 {:.0f} ns, p99.9 {:.0f} ns (a cache line's round trip: "
        "{:.0f} ns)\n  by a mutex and a condition variable: {:.0f} ns, {:.0f} ns; {:.0f} times as "
        "long at "
        "the median\n",
        frame_bytes, publishes, exchanged.p50_ns, exchanged.p999_ns, exchanged.round_trip_p50_ns,
        notified.p50_ns, notified.p999_ns, ratio);
  }
}

} // namespace

Result<void> measure_handoff(const RtOptions& options) {
  const auto processors = cli::two_processors();
  if (!processors) return Error{Errc::failed, "the hand-off " + processors.error().message};
  // Of 778 vertices, and of 10 000.
  for (const std::size_t frame_bytes : {std::size_t{9336}, std::size_t{120'000}}) {
    const std::size_t words = frame_bytes / sizeof(std::uint64_t);
    Times exchanged_times;
    Times notified_times;
    for (std::uint64_t round = 0; round < options.rounds; ++round) {
      measure_round<Exchanged>(*processors, words, exchanged_times);
      measure_round<Notified>(*processors, words, notified_times);
    }
    const Cost exchanged = cost_of(exchanged_times);
    const Cost notified = cost_of(notified_times);
    print(frame_bytes, exchanged_times.publishes_ns.size(), exchanged, notified, options.json);
  }
  return {};
}

} // namespace nendo::bench
