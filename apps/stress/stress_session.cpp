#include "stress/stress_session.hpp"

#include <algorithm>
#include <future>
#include <thread>
#include <utility>
#include <variant>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "cli/cli.hpp"
#include "commands/commands.hpp"
#include "session/open_hands.hpp"
#include "session/run_commands.hpp"
#include "session/run_recording.hpp"
#include "session/run_session.hpp"
#include "stress/load.hpp"

namespace nendo::stress {
namespace {

using std::chrono::milliseconds;

/// Space for 65 s at 1 kHz. Under load the main thread may not run for long.
constexpr std::size_t records_kept = 65'536;

rusage usage_of_thread() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

ThreadCosts difference(const rusage& before, const rusage& after) {
  return {after.ru_minflt - before.ru_minflt, after.ru_majflt - before.ru_majflt,
          after.ru_nvcsw - before.ru_nvcsw, after.ru_nivcsw - before.ru_nivcsw,
          seconds(after.ru_utime) - seconds(before.ru_utime) + seconds(after.ru_stime) -
              seconds(before.ru_stime)};
}

/// The message of the loop's thread once it has its rights.
struct Prepared {
  pid_t thread = 0;
  std::vector<flow::Grant> grants;
};

/// Returns whether the settings change in the second of that time of a run.
bool changes_at(HostTime start, HostTime time) noexcept {
  return static_cast<std::int64_t>(to_seconds(time - start)) % 2 != 0;
}

class SettingsChanger {
public:
  /// 0: no changes.
  explicit SettingsChanger(double per_minute) noexcept : per_minute_(per_minute) {}
  /// Requests the changes that are due. Call it some hundred times per second.
  void update(flow::DeformLoop& loop, HostTime start) {
    const HostTime now = HostClock::now();
    if (per_minute_ <= 0.0 || now < next_ || !changes_at(start, now)) return;
    constexpr double seconds_per_minute = 60.0;
    next_ =
        std::max(next_, now - milliseconds(100)) + from_seconds(seconds_per_minute / per_minute_);
    // There and back, so that the hands shape the same all the time.
    constexpr double larger = 1.25;
    flow::LoopSettings settings = loop.changes().settings();
    for (double& radius_m : settings.radius_m)
      radius_m *= asked_ % 2 == 0 ? larger : 1.0 / larger;
    if (loop.changes().change_settings(settings)) ++asked_;
  }

private:
  double per_minute_;
  std::uint64_t asked_ = 0;
  HostTime next_{};
};

/// Takes the records of the loop's ticks, and samples how long its thread had to wait for a CPU.
class Collector {
public:
  Collector(flow::TickRing& ring, pid_t thread, StressOutcome& outcome)
      : ring_(ring), delay_(thread), outcome_(outcome) {
    batch_.reserve(ring.capacity());
    delay_.sample();
  }
  void collect() {
    batch_.clear();
    ring_.drain([&](const flow::TickRecord& record) noexcept { batch_.push_back(record); });
    delay_.sample();
    for (const auto& record : batch_) {
      outcome_.tally.add(record, &delay_);
      if (outcome_.by_changes) count(record, *outcome_.by_changes);
    }
  }

private:
  void count(const flow::TickRecord& record, std::array<ChangeTally, 2>& tallies) noexcept {
    ChangeTally& tally = tallies[changes_at(outcome_.start, record.scheduled) ? 1 : 0];
    ++tally.ticks;
    tally.missed += record.missed;
    tally.lateness.record(record.woke - record.scheduled);
    tally.work.record(record.published() - record.woke);
  }

  flow::TickRing& ring_;
  RunDelay delay_;
  StressOutcome& outcome_;
  std::vector<flow::TickRecord> batch_;
};

/// The observer, if there is one, and its commands.
struct Watch {
  session::Observer* observer = nullptr;
  gloves::DeviceStatuses devices{};
  session::Asks asks{};
  session::LoopCommands for_loop{64};
  bool ends = false;                          ///< the observer has requested the end
  std::optional<flow::LoopSettings> wanted{}; ///< not passed on yet

  /// Waits some milliseconds, or as long as the observer takes.
  void update(flow::DeformLoop& loop, std::uint64_t& pictures) {
    if (observer == nullptr) return std::this_thread::sleep_for(milliseconds(4));
    ++pictures;
    const bool fresh = loop.frames().update();
    const flow::Frame& frame = loop.frames().front();
    observer->update({frame,
                      *loop.changes().model(frame.model),
                      fresh,
                      devices,
                      {},
                      loop.changes().puppet(frame.puppet)},
                     asks);
    for (const session::Ask& ask : std::exchange(asks, {}))
      execute(ask);
    if (const auto dropped = for_loop.dropped()) observer->report(*dropped);
    if (!wanted && fresh && frame.awaited) wanted = frame.awaited->settings;
    if (!wanted) return;
    const auto changed = loop.changes().change_settings(*std::exchange(wanted, {}));
    if (!changed) observer->report(changed.error().message);
  }

private:
  void execute(const session::Ask& ask) {
    const auto* const command = std::get_if<flow::Command>(&ask);
    const auto refuse = [this](std::string_view name) {
      observer->report(std::string(name) + ": nendo stress measures one model; use nendo run");
    };
    if (command == nullptr) return refuse("another puppet");
    if (const auto* change = std::get_if<flow::ChangeSettings>(command))
      wanted = change->settings;
    else if (std::holds_alternative<flow::EndRun>(*command))
      ends = true;
    else if (is_for_loop(*command))
      for_loop.push(*command);
    else
      refuse(commands::name_of(*command));
  }
};

void watch(const StressOptions& options, Collector& collector, const std::atomic<bool>& ended,
           StressOutcome& outcome, const StressProgress& progress, Watch& watched,
           flow::DeformLoop& loop) {
  HostTime next_report = outcome.start;
  SettingsChanger changer(options.changes_per_minute);
  while (!ended && !session::is_over(options.run, outcome.start)) {
    watched.update(loop, outcome.pictures);
    changer.update(loop, outcome.start);
    collector.collect();
    const auto& worst = outcome.tally.worst();
    outcome.broke =
        options.break_at && !worst.empty() && worst.front().lateness > *options.break_at;
    outcome.stopped = watched.ends || cli::stop_requested();
    if (outcome.broke || outcome.stopped) return;
    if (HostClock::now() < next_report) continue;
    progress(outcome.tally, to_seconds(HostClock::now() - outcome.start));
    next_report += milliseconds(250);
  }
}

void run_loop(const StressOptions& options, flow::DeformLoop& loop, flow::TickRing& ring,
              StressOutcome& outcome, const StressProgress& progress, Watch& watched) {
  std::atomic<bool> over{false};
  std::atomic<bool> ended{false};
  std::promise<Prepared> prepared;
  const auto stolen_before = stolen_s();
  outcome.wall_start = std::chrono::system_clock::now();
  outcome.start = HostClock::now();
  std::thread loop_thread([&] {
    prepared.set_value({static_cast<pid_t>(::syscall(SYS_gettid)),
                        flow::make_thread_realtime(options.run.realtime)});
    const rusage before = usage_of_thread();
    loop.run(over, session::ticks_for(options.run));
    outcome.costs = difference(before, usage_of_thread());
    ended = true;
  });
  Prepared thread = prepared.get_future().get();
  for (auto& grant : thread.grants) {
    if (grant.name == "policy") outcome.spins = grant.granted && options.run.loop.spin;
    outcome.grants.push_back(std::move(grant));
  }
  Collector collector(ring, thread.thread, outcome);
  watch(options, collector, ended, outcome, progress, watched, loop);
  over = true;
  loop_thread.join();
  collector.collect();
  outcome.elapsed_s = to_seconds(HostClock::now() - outcome.start);
  if (const auto stolen_after = stolen_s(); stolen_before && stolen_after)
    outcome.stolen_s = *stolen_after - *stolen_before;
}

} // namespace

Result<std::unique_ptr<StressOutcome>> run_stress(StressOptions options, const deform::Mesh& model,
                                                  const StressProgress& progress,
                                                  session::Observer* observer) {
  session::RunOptions& run = options.run;
  auto outcome = std::make_unique<StressOutcome>(run.loop);
  const flow::RealtimeProcess process(run.realtime);
  outcome->environment = describe_environment();
  if (options.floor_s > 0.0)
    outcome->floor = measure_floor(options.floor_s, run.realtime, cli::stop_requested());
  const auto load = Load::start(options.load);
  if (!load) return load.error();
  outcome->grants = process.grants();
  EventCount event_count;
  const auto opened = session::open_hands(run, model, event_count);
  if (!opened) return opened.error();
  const auto& hands = opened->hands;
  for (const auto& hand : hands) {
    outcome->gloves.push_back(hand.glove->info().source);
    if (!run.loop.stages.input) hand.glove->stop();
  }
  outcome->grants.insert(outcome->grants.end(), opened->grants.begin(), opened->grants.end());
  if (options.changes_per_minute > 0.0) outcome->by_changes.emplace();
  flow::TickRing ring(records_kept);
  run.loop.records = &ring;
  Watch watched;
  watched.observer = observer;
  run.loop.commands = &watched.for_loop.ring();
  const auto placed = session::place_loop(run, hands, model);
  if (!placed) return placed.error();
  watched.devices =
      gloves::DeviceWatch().look(hands, placed->loop->frames().front(), HostClock::now());
  if (observer != nullptr) observer->loop_begins({*placed, model, hands});
  run_loop(options, *placed->loop, ring, *outcome, progress, watched);
  for (const auto& hand : hands)
    hand.glove->stop();
  outcome->glove_records = session::counts_of(hands);
  const flow::LoopStats& stats = placed->loop->stats();
  outcome->overruns = stats.overruns;
  outcome->missed = stats.missed;
  outcome->failed = stats.failed;
  outcome->changes = stats.changes;
  outcome->records_refused = ring.counters().refused;
  outcome->vertices = model.vertices.cols();
  return outcome;
}

} // namespace nendo::stress
