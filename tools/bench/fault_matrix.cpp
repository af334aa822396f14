#include "bench/fault_matrix.hpp"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <thread>

#include <stdlib.h>

#include <nendo/driver/open_glove.hpp>
#include <nendo/emulator/emulator.hpp>

#include "bench/test_pattern.hpp"
#include <nendo/emulator/served_emulator.hpp>

namespace nendo::bench {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr double matrix_rate_hz = 90.0;
constexpr std::uint64_t edge_records = 20; ///< sent before the first and after the last look

/// A folder for the links, gone afterwards.
class LinkFolder {
public:
  LinkFolder() {
    std::string name = (fs::temp_directory_path() / "nendo-faults-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  LinkFolder(const LinkFolder&) = delete;
  LinkFolder& operator=(const LinkFolder&) = delete;
  ~LinkFolder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }
  const fs::path& path() const noexcept { return path_; }

private:
  fs::path path_;
};

/// What one run saw.
struct Watch {
  HostTime last_arrival{};
  std::uint64_t delivered = 0, flipped = 0, broken = 0;
  HostClock::duration longest_gap{};
  Side side = Side::right;
  SensorMask present;

  void see(const GloveSample& sample, unsigned steps_a_count) {
    if (delivered++ > 0) longest_gap = std::max(longest_gap, sample.arrival - last_arrival);
    last_arrival = sample.arrival;
    side = sample.side;
    present = sample.present;
    const auto verdict = judge_pattern(sample, steps_a_count);
    flipped += verdict == PatternVerdict::flipped ? 1U : 0U;
    broken += verdict == PatternVerdict::broken ? 1U : 0U;
  }
};

/// Records of 12 bits are those of 22 sensors, so that the other glove has as many.
const char* other_glove(const GloveCase& glove) {
  return glove.sensors == 18 || !glove.options.empty() ? "swap@2s=22" : "swap@2s=18";
}

emulator::EmulatorOptions emulator_options(const FaultCase& fault, const GloveCase& glove,
                                           const std::string& link) {
  emulator::EmulatorOptions options;
  options.link = link;
  options.sensors = glove.sensors;
  options.rate_hz = matrix_rate_hz;
  options.cyberglove.model = glove.model;
  options.cyberglove.pattern = true;
  options.cyberglove.restart_s = 1.75; // the longest that is known of
  for (const std::string& text : fault.faults) {
    if (text == "swap@2s=sensors")
      options.faults.push_back(other_glove(glove));
    else if (text == "stale")
      options.cyberglove.streaming = true;
    else if (text == "reply3")
      options.cyberglove.reply_bytes = 3;
    else if (text == "lsb")
      options.cyberglove.period_low_first = true;
    else
      options.faults.push_back(text);
  }
  return options;
}

std::string complaint_about(const FaultOutcome& outcome, const Watch& watch, double end_gap_s) {
  const FaultCase& fault = *outcome.fault;
  const bool fine = !outcome.glove->options.empty();
  if (outcome.broken > 0) return "records of wrong structure were delivered";
  if (outcome.flipped > 0 && !fault.flips) return "wrong counts were delivered";
  if (outcome.delivered == 0) return "nothing was delivered";
  if (outcome.longest_gap_s > fault.longest_gap_s) return "the glove took too long to come back";
  if (end_gap_s > 0.5) return "the glove did not come back";
  if ((watch.side == Side::left) != fault.swaps_hand) return "the hand is the wrong one";
  const bool few = (outcome.glove->sensors == 18) != fault.swaps_sensors;
  if (!fine && !(watch.present == (few ? sensors_18 : sensors_22)))
    return "the sensors are wrong ones";
  const std::uint64_t accounted = outcome.stats.records + outcome.stats.missed;
  const bool counted = accounted <= outcome.sent && accounted + edge_records >= outcome.sent;
  if (fault.counts_all && !counted)
    return "the records sent are not the sum of those delivered and missed";
  return {};
}

Result<FaultOutcome> run_case(const FaultCase& fault, const GloveCase& glove, double seconds,
                              const std::string& link, const std::atomic<bool>& stop) {
  FaultOutcome outcome;
  outcome.fault = &fault;
  outcome.glove = &glove;
  auto emulator = emulator::DeviceEmulator::open(emulator_options(fault, glove, link));
  if (!emulator) return emulator.error();
  emulator::ServedEmulator server(**emulator);
  SampleRing ring(4096);
  Watch watch;
  const HostTime begin = HostClock::now();
  auto opened = driver::open_glove("serial:" + link + std::string(glove.options));
  auto started = opened ? (*opened)->start(ring) : Result<void>(opened.error());
  const unsigned steps = opened && (*opened)->info().counts.max_count > 255 ? 16 : 1;
  while (started && !stop && to_seconds(HostClock::now() - begin) < seconds) {
    GloveSample sample;
    while (ring.try_pop(sample))
      watch.see(sample, steps);
    std::this_thread::sleep_for(5ms);
  }
  const double end_gap_s = to_seconds(HostClock::now() - watch.last_arrival);
  if (started) (*opened)->stop();
  const auto served = server.finish();
  if (!started) return started.error();
  if (!served) return served.error();
  const auto sent = (*emulator)->stats();
  outcome.stats = (*opened)->stats();
  outcome.sent = sent.records_sent;
  outcome.faulted = sent.records_faulted;
  outcome.delivered = watch.delivered;
  outcome.flipped = watch.flipped;
  outcome.broken = watch.broken;
  outcome.longest_gap_s = to_seconds(watch.longest_gap);
  outcome.complaint = complaint_about(outcome, watch, end_gap_s);
  return outcome;
}

} // namespace

const std::vector<FaultCase>& fault_cases() {
  // Gaps: a fault's own time, 1.5 s until silence is noticed, the dialogue, and what a busy machine
  // adds.
  static const std::vector<FaultCase> cases{
      {"none", "a good line", {}, 0.5},
      {"drop", "bytes get lost, 1 in 1000", {"drop=0.1%"}, 0.5},
      {"insert", "bytes come in, 1 in 1000", {"insert=0.1%"}, 0.5},
      {"flip", "bits turn over, in 1 byte of 1000", {"flip=0.1%"}, 0.5, true},
      {"lose", "whole records get lost, 1 in 20", {"lose=5%"}, 0.5},
      {"burst", "up to 64 random bytes before 1 record in 50", {"burst=2%"}, 0.5},
      {"stale stream", "a host that died left the glove streaming", {"stale"}, 0.5},
      {"modem probe", "ModemManager's junk on the line", {"junk@2500ms"}, 0.5},
      {"3-byte replies", "set commands are answered with three bytes", {"reply3"}, 0.5},
      {"T low first", "the words of ?T come low byte first", {"lsb"}, 0.5},
      {"silence", "nothing for 2 s", {"silence@2s+2s"}, 5.0, false, false},
      {"glove pulled", "out of its box for 2 s (eg)", {"eg@2s+2s"}, 5.0, false, false},
      {"power cut", "the box restarts, options lost", {"restart@2s"}, 6.0, false, false},
      {"unplugged", "the port vanishes for 1 s", {"unplug@2s+1s"}, 4.5, false, false},
      {"other hand", "a left glove for the right one", {"swap@2s=left"}, 5.0, false, false, true},
      {"fewer sensors",
       "another glove in the box",
       {"swap@2s=sensors"},
       5.0,
       false,
       false,
       false,
       true},
  };
  return cases;
}

const std::vector<GloveCase>& glove_cases() {
  static const std::vector<GloveCase> cases{
      {"CyberGlove I, 18", 1, 18, ""},
      {"CyberGlove II, 22", 2, 22, ""},
      {"CyberGlove III, 22", 3, 22, ""},
      {"CyberGlove III, 12-bit", 3, 22, "?hires=on"},
  };
  return cases;
}

Result<std::vector<FaultOutcome>> run_fault_matrix(double seconds, unsigned at_once,
                                                   const std::atomic<bool>& stop) {
  const LinkFolder folder;
  const std::size_t gloves = glove_cases().size();
  std::vector<FaultOutcome> outcomes(fault_cases().size() * gloves);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::optional<Error> error; // guarded by mutex
  const auto work = [&] {
    for (std::size_t k = next++; k < outcomes.size() && !stop; k = next++) {
      const std::string link = folder.path() / ("glove" + std::to_string(k));
      auto outcome =
          run_case(fault_cases()[k / gloves], glove_cases()[k % gloves], seconds, link, stop);
      const std::lock_guard lock(mutex);
      outcome ? outcomes[k] = *std::move(outcome), void() : void(error = outcome.error());
    }
  };
  {
    std::vector<std::jthread> workers;
    for (unsigned k = 0; k < at_once; ++k)
      workers.emplace_back(work);
  }
  if (error) return *error;
  return outcomes;
}

} // namespace nendo::bench
