// nendo bench rt, the rings: elements of 64 bytes per second from one processor to another. A
// sample counts only if a cache line's round trip took the same time before and after it, and the
// throughput is the median over a thousand elements each, so that interruptions do not change it.

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/contending_rings.hpp"
#include "bench/percentiles.hpp"
#include "bench/rt_bench.hpp"
#include "bench/two_threads.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench {
namespace {

constexpr std::size_t batch_size = 16;
constexpr std::size_t batches = 12'500;
constexpr std::size_t chunk = 1000;  ///< elements to a time
constexpr double same_regime = 1.25; ///< round trips differ by less than this factor

struct Sample {
  double elements_a_second = 0.0;
  double round_trip_ns = 0.0;
  bool steady = false; ///< the round trip was the same before and after
};

template <class Contender>
void send_all(Contender& ring) {
  std::array<Element, batch_size> batch{};
  for (std::size_t n = 0; n < batches; ++n) {
    for (std::size_t k = 0; k < batch_size; ++k)
      batch[k][0] = n + k;
    ring.send(batch);
  }
}

/// Prevents the compiler from removing unused results.
volatile std::uint64_t ring_sum_seen = 0;

/// Reads every byte of every element, and returns the median of the elements a second.
template <class Contender>
double receive_all(Contender& ring) {
  std::vector<double> rates;
  rates.reserve(batches * batch_size / chunk + 1);
  std::uint64_t sum = 0;
  const auto read = [&sum](const Element& element) {
    for (const std::uint64_t word : element)
      sum += word;
  };
  std::size_t received = 0;
  std::size_t in_chunk = 0;
  auto begin = std::chrono::steady_clock::now();
  while (received < batches * batch_size) {
    const std::size_t got = ring.receive(read);
    received += got;
    in_chunk += got;
    if (in_chunk < chunk) continue;
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> took = now - begin;
    rates.push_back(static_cast<double>(in_chunk) / took.count());
    begin = now;
    in_chunk = 0;
  }
  ring_sum_seen = sum;
  return median(std::move(rates));
}

template <class Contender>
Sample take_sample(const cli::TwoProcessors& processors) {
  const auto ring = std::make_unique<Contender>();
  PingPong ball;
  double before_ns = 0.0;
  double after_ns = 0.0;
  Sample sample;
  run_on(
      processors,
      [&] {
        ball.answer();
        send_all(*ring);
        ball.answer();
      },
      [&] {
        before_ns = ball.measure_ns();
        sample.elements_a_second = receive_all(*ring);
        after_ns = ball.measure_ns();
      });
  const auto [least, most] = std::minmax(before_ns, after_ns);
  sample.round_trip_ns = (before_ns + after_ns) / 2.0;
  sample.steady = most < same_regime * least;
  return sample;
}

struct Contender {
  const char* name;
  Sample (*take_sample)(const cli::TwoProcessors& processors);
  std::vector<Sample> samples{};
};

template <class Ring>
Contender contender() {
  return {Ring::name, take_sample<Ring>};
}

/// The baseline first.
std::vector<Contender> contenders() {
  return {
      contender<PlainContender<16>>(),
      contender<PlainContender<0>>(),
      contender<SingleContender>(),
      contender<DrainedContender>(),
      contender<BatchContender>(),
#ifdef NENDO_READERWRITERQUEUE
      contender<ReaderWriterQueueContender>(),
#endif
#ifdef NENDO_BOOST_LOCKFREE
      contender<BoostContender>(),
#endif
  };
}

struct Row {
  const char* name;
  double elements_a_second = 0.0;
  std::size_t samples = 0; ///< in the regime that most steady samples were in
  std::size_t dropped = 0;
};

Row row_of(const Contender& contender, double round_trip_ns) {
  Row row{contender.name};
  std::vector<double> rates;
  for (const Sample& sample : contender.samples) {
    const auto [least, most] = std::minmax(sample.round_trip_ns, round_trip_ns);
    if (sample.steady && most < same_regime * least) rates.push_back(sample.elements_a_second);
  }
  row.samples = rates.size();
  row.dropped = contender.samples.size() - rates.size();
  row.elements_a_second = median(std::move(rates));
  return row;
}

void print(const Row& row, const Row& plain, double round_trip_ns, bool json) {
  const double to_plain = plain.samples > 0 ? row.elements_a_second / plain.elements_a_second : 0.0;
  if (json) {
    cli::print_line({{"part", "rings"},
                     {"ring", row.name},
                     {"element_bytes", sizeof(Element)},
                     {"elements_a_second", row.elements_a_second},
                     {"to_plain", to_plain},
                     {"samples", row.samples},
                     {"dropped", row.dropped},
                     {"round_trip_ns", round_trip_ns}});
  } else {
    cli::print("  {:28} {:7.1f} million/s  {:5.2f}  {:4} samples, {} dropped\n", row.name,
               row.elements_a_second / 1e6, to_plain, row.samples, row.dropped);
  }
}

} // namespace

Result<void> measure_rings(const RtOptions& options) {
  const auto processors = cli::two_processors();
  if (!processors) return Error{Errc::failed, "the rings' benchmark " + processors.error().message};
  auto rings = contenders();
  for (std::uint64_t round = 0; round < options.rounds; ++round) {
    for (std::size_t n = 0; n < rings.size(); ++n) {
      Contender& turn = rings[(n + round) % rings.size()];
      turn.samples.push_back(turn.take_sample(*processors));
    }
  }
  std::vector<double> trips_ns;
  for (const Contender& ring : rings)
    for (const Sample& sample : ring.samples)
      if (sample.steady) trips_ns.push_back(sample.round_trip_ns);
  const double round_trip_ns = median(std::move(trips_ns));
  if (!options.json) {
    cli::print(
        "elements of {} bytes from processor {} to {}, with a round trip of {:.0f} ns; beside "
        "a plain ring\n",
        sizeof(Element), processors->first, processors->second, round_trip_ns);
  }
  const Row plain = row_of(rings.front(), round_trip_ns);
  for (const Contender& ring : rings)
    print(row_of(ring, round_trip_ns), plain, round_trip_ns, options.json);
  return {};
}

} // namespace nendo::bench
