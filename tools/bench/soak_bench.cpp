// nendo bench soak: days of records in minutes, through a pseudo-terminal and the real driver, with
// faults; every record has to be accounted for, and memory must not grow.

#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <nendo/driver/open_glove.hpp>
#include <nendo/emulator/emulator.hpp>

#include "bench/bench.hpp"
#include "bench/test_pattern.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"
#include <nendo/emulator/served_emulator.hpp>

namespace nendo::bench::soak_bench {
namespace {

using namespace std::chrono_literals;

struct Options {
  std::uint64_t records = 10'000'000;
  // A lost byte and another one too many in one record leave its length as it was: nothing in the
  // record could expose that, so they do not come together.
  std::vector<std::string> faults{"lose=0.2%", "drop=0.01%", "flip=0.01%", "burst=0.2%"};
  bool json = false;
};

/// A few records at the end, with no good one after them, cannot have been missed yet.
constexpr std::uint64_t undecided = 5;

struct Tally {
  std::uint64_t sent = 0, faulted = 0, delivered = 0, flipped = 0, broken = 0;
  driver::StreamStats stats;
  double seconds = 0.0;
  long memory_begin_kb = 0, memory_end_kb = 0;
};

long resident_kb() {
  long pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

std::uint64_t accounted(const driver::Glove& glove) {
  const driver::StreamStats stats = glove.stats();
  return stats.records + stats.missed;
}

/// Takes what is in the ring.
void take(SampleRing& ring, Tally& tally) {
  GloveSample sample;
  while (ring.try_pop(sample)) {
    ++tally.delivered;
    const auto verdict = judge_pattern(sample, 1);
    tally.flipped += verdict == PatternVerdict::flipped ? 1U : 0U;
    tally.broken += verdict == PatternVerdict::broken ? 1U : 0U;
  }
}

Result<Tally> soak(const Options& options) {
  emulator::EmulatorOptions device;
  device.cyberglove.pattern = true;
  device.pace = emulator::EmulatorPace::host;
  device.faults = options.faults;
  auto emulator = emulator::DeviceEmulator::open(device);
  if (!emulator) return emulator.error();
  emulator::ServedEmulator server(**emulator);
  SampleRing ring(1U << 16U);
  Tally tally;
  auto glove = driver::open_glove("serial:" + (*emulator)->tty_path());
  auto started = glove ? (*glove)->start(ring) : Result<void>(glove.error());
  const auto begin = std::chrono::steady_clock::now();
  const std::uint64_t warm = options.records / 20;
  while (started && !cli::stop_requested() && (*emulator)->stats().records_sent < options.records) {
    take(ring, tally);
    if (tally.memory_begin_kb == 0 && tally.delivered >= warm)
      tally.memory_begin_kb = resident_kb();
    std::this_thread::sleep_for(1ms);
  }
  const auto served = server.finish();
  tally.sent = (*emulator)->stats().records_sent;
  // What was sent last is on its way, and takes as long as the machine is loaded.
  const auto patience = std::chrono::steady_clock::now() + 10s;
  while (started && accounted(**glove) + undecided < tally.sent &&
         std::chrono::steady_clock::now() < patience) {
    take(ring, tally);
    std::this_thread::sleep_for(1ms);
  }
  tally.seconds = to_seconds(std::chrono::steady_clock::now() - begin);
  tally.memory_end_kb = resident_kb();
  if (started) (*glove)->stop();
  if (started) take(ring, tally);
  if (!started) return started.error();
  if (!served) return served.error();
  tally.stats = (*glove)->stats();
  tally.faulted = (*emulator)->stats().records_faulted;
  return tally;
}

std::string complaint_about(const Tally& tally) {
  constexpr long max_growth_kb = 2048;
  const std::uint64_t accounted = tally.stats.records + tally.stats.missed;
  if (tally.broken > 0) return "records of wrong structure were delivered";
  if (accounted > tally.sent || accounted + undecided < tally.sent)
    return "the records sent are not the sum of those delivered and missed";
  if (tally.delivered + tally.stats.ring_refused != tally.stats.records)
    return "the samples taken and refused are not the sum of those delivered";
  if (tally.memory_end_kb > tally.memory_begin_kb + max_growth_kb) return "memory grew";
  return {};
}

void print(const Tally& tally, bool json) {
  const driver::StreamStats& stats = tally.stats;
  if (json) {
    cli::print_line({{"sent", tally.sent},
                     {"faulted", tally.faulted},
                     {"delivered", stats.records},
                     {"missed", stats.missed},
                     {"bad_records", stats.bad_records},
                     {"implausible", stats.implausible},
                     {"ring_refused", stats.ring_refused},
                     {"flipped", tally.flipped},
                     {"broken", tally.broken},
                     {"bytes", stats.bytes},
                     {"seconds", tally.seconds},
                     {"memory_begin_kb", tally.memory_begin_kb},
                     {"memory_end_kb", tally.memory_end_kb}});
    return;
  }
  cli::print("{} records sent in {:.1f} s, {} of them changed by a fault\n", tally.sent,
             tally.seconds, tally.faulted);
  cli::print("{} delivered + {} missed; {} bad records, {} of them implausible; {} samples "
             "refused, because the ring was full\n",
             stats.records, stats.missed, stats.bad_records, stats.implausible, stats.ring_refused);
  cli::print("delivered with one wrong bit in a sensor: {}; of wrong structure: {}\n",
             tally.flipped, tally.broken);
  cli::print("memory: {} kB after a twentieth of the records, {} kB at the end\n",
             tally.memory_begin_kb, tally.memory_end_kb);
}

int bench_soak(const Options& options) {
  if (options.records < 1000) {
    return cli::report({Errc::usage, "--records: use 1000 or more"});
  }
  cli::install_stop_signals();
  spdlog::set_level(spdlog::level::off);
  const auto tally = soak(options);
  if (!tally) return cli::report(tally.error());
  if (cli::stop_requested())
    return cli::report({Errc::failed, "stopped before all records were sent"});
  print(*tally, options.json);
  const std::string complaint = complaint_about(*tally);
  return complaint.empty() ? 0 : cli::report({Errc::failed, complaint});
}

} // namespace
} // namespace nendo::bench::soak_bench

void nendo::bench::add_soak(cli::Command& bench) {
  using namespace soak_bench;
  cli::Command command =
      bench.add_command("soak", "Sends millions of records with faults, as fast as possible, and "
                                "checks that each is accounted for");
  Options& options = command.on_chosen<Options>(bench_soak);
  command.add_option("--records", options.records, "Number of records");
  command.add_option(
      "--fault", options.faults,
      "A fault, as for `nendo emulate`; the default ones change about 1 % of the records");
  command.add_flag("--json", options.json, "One JSON object");
}
