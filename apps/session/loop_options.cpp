#include "session/loop_options.hpp"

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/flow/setting.hpp>

#include "cli/two_processors.hpp"

namespace nendo::session {

void LoopArguments::add_to(cli::Command& command, bool short_names) {
  const auto name = [&](const char* brief, const char* full) {
    return short_names ? std::string(brief) + "," + full : std::string(full);
  };
  command
      .add_option(
          name("-p", "--priority"), priority,
          "SCHED_FIFO priority of the loop, 1 to 97, 80 is usual; readers of gloves run two "
          "above; 0: ordinary scheduling")
      .under("Timing");
  command
      .add_option(name("-a", "--affinity"), affinity,
                  "CPUs that the loop may use, like 1 or 0,2 or 0-3; without it, all")
      .under("Timing");
  command.add_flag(name("-m", "--mlockall"), lock_memory, "Lock the process in memory")
      .under("Timing");
  command
      .add_option(
          "--policy", policy,
          "After a tick that took too long: skip (miss deadlines, keep the grid), "
          "catch-up:N (run the last N late), re-anchor (begin the grid anew); or sample: no "
          "grid, a tick for each sample as it comes")
      .under("Timing");
  command
      .add_option("--spin", spin,
                  "Wake early and spin to the deadline: on, off, auto (below 2000 Hz); only where "
                  "SCHED_FIFO is granted")
      .under("Timing");
  command
      .add_option("--threads", threads,
                  "2: a second thread takes half of a large model, to the same shape bit for bit. "
                  "It spins, so that it is there at once, and keeps a processor busy; not with "
                  "--priority")
      .under("Timing");
}

/// The loop may have to wait for the second thread, so other threads must not delay it. But a
/// thread that spins above all others would leave them no processor.
Result<void> LoopArguments::check_threads() const {
  if (threads != 1 && threads != 2)
    return Error{Errc::usage, "--threads " + std::to_string(threads) + ": use 1 or 2"};
  if (threads == 1) return {};
  if (priority > 0)
    return Error{Errc::usage, "--threads 2: not with --priority " + std::to_string(priority) +
                                  "; a thread that spins with SCHED_FIFO leaves its processor to "
                                  "nobody: use --priority 0, or one thread"};
  const auto processors = cli::two_processors();
  if (!processors) return Error{Errc::failed, "--threads 2: " + processors.error().message};
  return {};
}

Result<void> LoopArguments::parse(flow::LoopOptions& loop, flow::RealtimeOptions& realtime) const {
  if (priority > flow::max_priority) {
    return Error{Errc::usage, "--priority " + std::to_string(priority) +
                                  ": use 1 to 97 (readers of gloves run two above), or 0 for "
                                  "ordinary scheduling"};
  }
  realtime.priority = priority;
  realtime.lock_memory = lock_memory;
  if (!affinity.empty()) {
    auto cpus = flow::parse_cpus(affinity, "--affinity");
    if (!cpus) return cpus.error();
    realtime.affinity = *std::move(cpus);
  }
  if (const auto known = flow::parse_policy(policy, loop); !known)
    return Error{Errc::usage, "--policy " + known.error().message};
  if (spin != "on" && spin != "off" && spin != "auto")
    return Error{Errc::usage, "--spin " + spin + ": use on, off or auto"};
  // A margin costs the same whatever the rate: at 2 kHz it is a tenth of the processor and more.
  constexpr double max_auto_rate_hz = 2000.0;
  loop.spin = spin == "on" || (spin == "auto" && loop.rate_hz < max_auto_rate_hz);
  if (spin == "on" && priority == 0)
    return Error{Errc::usage, "--spin on: only with --priority; the ordinary scheduler makes a "
                              "thread that spins later, not sooner"};
  loop.sculptor.deformer.evaluation.threads = static_cast<int>(threads);
  return check_threads();
}

void add_polynomial_option(cli::Command& command, std::string& name) {
  command.add_option("--polynomial", name,
                     "none, constant or linear; anything but none moves the whole model");
}

Result<deform::CsrbfOptions> csrbf_for(const flow::LoopSettings& settings,
                                       const std::string& polynomial) {
  const auto known = deform::polynomial_named(polynomial);
  if (!known)
    return Error{Errc::usage,
                 "--polynomial " + polynomial + ": unknown; use none, constant or linear"};
  const flow::NumberSetting& volume = flow::setting::keep_volume;
  if (volume.of(settings) > 0.0 && *known != deform::Polynomial::none)
    return Error{
        Errc::usage,
        fmt::format("{} cannot be combined with --polynomial {}: a polynomial stretches the "
                    "whole model; choose one of them",
                    volume.option, polynomial)};
  flow::SculptorOptions sculptor;
  flow::set_plain_settings(sculptor, settings);
  sculptor.deformer.csrbf.polynomial = *known;
  return sculptor.deformer.csrbf;
}

nlohmann::ordered_json grants_json(const std::vector<flow::Grant>& grants) {
  auto lines = nlohmann::ordered_json::array();
  for (const auto& grant : grants) {
    nlohmann::ordered_json line{
        {"name", grant.name}, {"wanted", grant.wanted}, {"granted", grant.granted}};
    if (!grant.granted) {
      line["why"] = grant.why;
      line["remedy"] = grant.remedy;
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

} // namespace nendo::session
