#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "cli/figures.hpp"
#include "stress/report.hpp"

namespace nendo::stress {
namespace {

std::string duration_text(double us) {
  if (us < 1000.0) return fmt::format("{:.0f} us", us);
  return us < 1e6 ? fmt::format("{:.3g} ms", us / 1e3) : fmt::format("{:.3g} s", us / 1e6);
}

std::string rate_text(double rate_hz) {
  return rate_hz >= 1000.0 ? fmt::format("{:g} kHz", rate_hz / 1000.0)
                           : fmt::format("{:g} Hz", rate_hz);
}

double period_us(const StressOptions& options) {
  return 1e6 / options.run.loop.rate_hz;
}

/// The ticks that began when the next one was due already.
std::uint64_t later_than(const flow::Histogram& lateness, double us) {
  std::uint64_t later = 0;
  lateness.for_each([&](std::chrono::nanoseconds value, std::uint64_t count) {
    if (to_microseconds(value) >= us) later += count;
  });
  return later;
}

const flow::Grant* refused_grant(const StressOutcome& outcome, std::string_view name) {
  const auto found =
      std::find_if(outcome.grants.begin(), outcome.grants.end(),
                   [&](const flow::Grant& grant) { return grant.name == name && !grant.granted; });
  return found != outcome.grants.end() ? &*found : nullptr;
}

/// A rate that a tick of this length leaves some air, in round numbers.
std::string slower(double work_us) {
  const double rate_hz = std::max(1.0, 0.7e6 / std::max(work_us, 1.0));
  const double step = std::pow(10.0, std::floor(std::log10(rate_hz)));
  const double round_hz = std::max(1.0, std::floor(rate_hz / step) * step);
  return fmt::format("{} (-i {:.0f})", rate_text(round_hz), 1e6 / round_hz);
}

struct Why {
  std::string reason;
  std::string remedy;
};

Why too_much_work(const StressOptions& options, const StressOutcome& outcome, double work_us) {
  const bool may_share = outcome.environment.cpus > 1 && options.run.loop.stages.deform &&
                         options.run.loop.sculptor.deformer.evaluation.threads < 2;
  // A second thread is refused to a loop with real-time priority, which is usual here.
  const std::string share = options.run.realtime.priority > 0 ? "--threads 2 -p 0" : "--threads 2";
  return {fmt::format("the work of a tick takes {}, and the next one is due after {}",
                      duration_text(work_us), duration_text(period_us(options))),
          "a model of fewer vertices, " + (may_share ? share + ", " : "") + "or " +
              slower(work_us)};
}

/// Why another thread could have the processor: the loop has no right to it before others.
Why preempted(const StressOptions& options, const StressOutcome& outcome) {
  const flow::Grant* const policy = refused_grant(outcome, "policy");
  const std::string load = options.load.empty() ? "" : ", such as the load that --load made";
  if (policy != nullptr)
    return {"other threads had the processor" + load + ", and " + policy->wanted + " is refused",
            policy->remedy};
  if (options.run.realtime.priority == 0) {
    const bool shares = options.run.loop.sculptor.deformer.evaluation.threads > 1;
    return {"other threads had the processor" + load + ", and the loop has no real-time priority",
            fmt::format("-p {}{}", flow::usual_priority, shares ? " without --threads 2" : "")};
  }
  const double cpu = outcome.costs.cpu_s / std::max(outcome.elapsed_s, 1e-9);
  const auto& limit = outcome.environment.rt_runtime_us;
  if (limit && *limit >= 0 && cpu >= 0.9 * static_cast<double>(*limit) / 1e6) {
    return {
        fmt::format("the kernel stops real-time threads that use more than {:.0f} % of a second",
                    static_cast<double>(*limit) / 1e4),
        "a lower rate, or --spin off"};
  }
  return {"other real-time threads, or the kernel, had the processor",
          fmt::format("a higher priority than {} (-p), or a CPU of its own (--affinity)",
                      options.run.realtime.priority)};
}

Why stopped_outside(const StressOptions& options, const StressOutcome& outcome) {
  const Environment& machine = outcome.environment;
  const std::string floor =
      outcome.floor.gaps.count() > 0
          ? fmt::format(" (even a thread that only reads the clock is stopped for up to {})",
                        duration_text(to_microseconds(outcome.floor.gaps.max())))
          : "";
  if (machine.hypervisor)
    return {"the host of this virtual machine stopped it" + floor,
            "a machine that is not virtual, fewer programs on the host, or " +
                slower(0.7 * std::max(period_us(options),
                                      to_microseconds(outcome.tally.longest_outage())))};
  if (const flow::Grant* const sleep = refused_grant(outcome, "dma_latency"))
    return {"the machine stopped for a while" + floor + ", and its deep sleep is not prevented",
            sleep->remedy};
  if (!machine.governor.empty() && machine.governor != "performance")
    return {"the machine stopped for a while" + floor + ", and its governor is " + machine.governor,
            "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"};
  return {"interrupts, the firmware or the kernel stopped it" + floor,
          "another CPU (--affinity), or a kernel with PREEMPT_RT"};
}

Why unexplained(const StressOptions& options, const StressOutcome& outcome) {
  if (refused_grant(outcome, "policy") != nullptr || options.run.realtime.priority == 0)
    return preempted(options, outcome);
  return {"something that the kernel does not report had the processor",
          "`nendo stress --floor 5` beside an idle machine, and compare"};
}

Why why_late(const StressOptions& options, const StressOutcome& outcome) {
  const TickTally& tally = outcome.tally;
  const double work_us =
      to_microseconds(tally[Measure::work].raw.percentile(0.5)); // what it usually takes
  if (work_us >= 0.9 * period_us(options)) return too_much_work(options, outcome, work_us);
  const auto& causes = tally.causes();
  const auto worst =
      std::max_element(causes.begin(), causes.end(),
                       [](const auto& a, const auto& b) { return a.lateness < b.lateness; });
  if (worst->incidents == 0) return unexplained(options, outcome); // all are below the threshold
  switch (static_cast<Cause>(worst - causes.begin())) {
  case Cause::host_gap:
    return stopped_outside(options, outcome);
  case Cause::own_work:
    return too_much_work(options, outcome,
                         to_microseconds(tally[Measure::work].raw.percentile(0.99)));
  case Cause::input:
    return {"taking what the gloves had sent took the time", "a lower rate of the gloves (?rate=)"};
  case Cause::preemption:
    return preempted(options, outcome);
  default:
    return unexplained(options, outcome);
  }
}

} // namespace

Verdict judge(const StressOptions& options, const StressOutcome& outcome) {
  const flow::Histogram& lateness = outcome.tally[Measure::lateness].corrected;
  Verdict verdict;
  verdict.judged = options.run.loop.policy != flow::OverrunPolicy::sample;
  verdict.due = std::max(outcome.tally.ticks() + outcome.missed, lateness.count());
  verdict.max_late_us = lateness.count() > 0 ? to_microseconds(lateness.max()) : 0.0;
  if (!verdict.judged) return verdict;
  verdict.late = std::max(outcome.missed, later_than(lateness, period_us(options)));
  verdict.punctual = verdict.late == 0 && verdict.due > 0;
  if (verdict.punctual) return verdict;
  if (verdict.due == 0) {
    verdict.reason = "no tick ran";
    verdict.remedy = "a longer test (-D)";
    return verdict;
  }
  Why why = why_late(options, outcome);
  verdict.reason = std::move(why.reason);
  verdict.remedy = std::move(why.remedy);
  return verdict;
}

std::string in_words(const Verdict& verdict, const StressOptions& options,
                     const StressOutcome& outcome) {
  const flow::Histogram& lateness = outcome.tally[Measure::lateness].corrected;
  const std::string usual = lateness.count() > 0
                                ? duration_text(to_microseconds(lateness.percentile(0.999)))
                                : std::string("0 us");
  if (!verdict.judged) {
    return fmt::format("Paced by samples: no rate to keep; {} ticks, each at most {} after its "
                       "sample had come, and 99.9 % of them within {}.",
                       cli::thousands(verdict.due), duration_text(verdict.max_late_us), usual);
  }
  const std::string rate = rate_text(options.run.loop.rate_hz);
  if (verdict.punctual) {
    return fmt::format("{}: yes, with each of {} ticks on time: at most {} after its deadline, and "
                       "99.9 % of them within {}.",
                       rate, cli::thousands(verdict.due), duration_text(verdict.max_late_us),
                       usual);
  }
  if (verdict.due == 0)
    return fmt::format("{}: not known: no tick ran; try {}.", rate, verdict.remedy);
  return fmt::format("{}: no: {} of {} ticks were late, by up to {}, because {}; try: {}.", rate,
                     cli::thousands(verdict.late), cli::thousands(verdict.due),
                     duration_text(verdict.max_late_us), verdict.reason, verdict.remedy);
}

} // namespace nendo::stress
