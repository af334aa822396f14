#include "session/setting_options.hpp"

#include <type_traits>

#include <nlohmann/json.hpp>

#include "cli/processors.hpp"

namespace nendo::session {

void SettingArguments::add(cli::Command& command, const flow::BrushesSetting& brushes) {
  command.add_option(std::string(brushes.option), values_[brushes.name], std::string(brushes.help));
}

void SettingArguments::add(cli::Command& command, const flow::NumberSetting& number) {
  command.add_option(std::string(number.option), numbers_[number.name],
                     fmt::format("{} ({}; without it, {:g})", number.help,
                                 flow::in_words(number.range, number.unit), number.of(usual_)));
}

void SettingArguments::add(cli::Command& command, const flow::SwitchSetting& on) {
  command.add_flag(std::string(on.option), on.of(switched_), std::string(on.help));
}

void SettingArguments::add_filter(cli::Command& command) {
  flow::for_each_filter_setting([&](const auto& setting) {
    if (!setting.option.empty()) add(command, setting);
  });
}

Result<flow::LoopSettings> SettingArguments::parse() const {
  flow::LoopSettings settings = switched_;
  Result<void> fine;
  flow::for_each_setting([&](const auto& setting) {
    if constexpr (requires { setting.named; }) {
      const auto text = values_.find(setting.name);
      if (!fine || text == values_.end() || text->second.empty()) return;
      if (const auto chosen = parse_setting(setting, text->second))
        setting.of(settings) = *chosen;
      else
        fine = chosen.error();
    }
  });
  if (fine) fine = parse_brushes(settings);
  flow::for_each_setting([&](const auto& setting) {
    if constexpr (std::is_same_v<decltype(setting), const flow::NumberSetting&>)
      if (fine) fine = parse_number(setting, settings);
  });
  if (!fine) return fine.error();
  return settings;
}

/// The other kinds of settings are set before.
Result<void> SettingArguments::parse_number(const flow::NumberSetting& number,
                                            flow::LoopSettings& settings) const {
  const auto found = numbers_.find(number.name);
  if (found == numbers_.end() || !found->second) return {};
  number.of(settings) = *found->second;
  if (!number.range.has(*found->second))
    return Error{Errc::usage, fmt::format("{} {}: use {}", number.option, *found->second,
                                          flow::in_words(number.range, number.unit))};
  if (number.has_effect != nullptr && !number.has_effect(settings))
    return Error{Errc::usage, fmt::format("{} {}: has no effect alone; add {}", number.option,
                                          *found->second, number.remedy)};
  return {};
}

/// A brush without a mode selects type 2, which has brushes.
Result<void> SettingArguments::parse_brushes(flow::LoopSettings& settings) const {
  constexpr const flow::BrushesSetting& brushes = flow::setting::brushes;
  const auto text = values_.find(brushes.name);
  if (text == values_.end() || text->second.empty()) return {};
  const auto parsed = flow::parse_brushes(text->second);
  if (!parsed)
    return Error{
        Errc::usage,
        fmt::format("{} {}: use {}, or five of them separated by commas, thumb to little finger",
                    brushes.option, text->second, deform::brush_words())};
  brushes.of(settings) = *parsed;
  if (values_.at(flow::setting::mode.name).empty()) settings.mode = flow::Mode::type2;
  return {};
}

void LoopArguments::add_to(const cli::Command& whole, bool short_names) {
  cli::Command command = whole.under("Timing");
  const auto name = [&](const char* brief, const char* full) {
    return short_names ? std::string(brief) + "," + full : std::string(full);
  };
  command.add_option(
      name("-p", "--priority"), priority,
      "SCHED_FIFO priority of the loop, 1 to 97, usually 80; readers of gloves run two above; "
      "0: ordinary scheduling");
  command.add_option(name("-a", "--affinity"), affinity,
                     "CPUs for the loop, like 1 or 0,2 or 0-3; without it, all");
  command.add_flag(name("-m", "--mlockall"), lock_memory, "Lock the process in memory");
  command.add_option(
      "--policy", policy,
      "After a tick that took too long: skip (miss deadlines, keep the grid), "
      "catch-up:N (run the last N late), re-anchor (restart the grid); or sample: no grid, "
      "one tick per sample");
  command.add_option(
      "--spin", spin,
      "Wake early and spin until the deadline: on, off, auto (below 2000 Hz); only if "
      "SCHED_FIFO is granted");
  command.add_option(
      "--threads", threads,
      "2: a second thread computes half of a large model, with the same result bit for "
      "bit. It spins, and keeps a processor busy; cannot be combined with --priority");
}

/// The loop may have to wait for the second thread, so other threads must not delay it. But a
/// thread that spins above all others would leave them no processor.
Result<void> LoopArguments::check_threads() const {
  if (threads != 1 && threads != 2)
    return Error{Errc::usage, "--threads " + std::to_string(threads) + ": use 1 or 2"};
  if (threads == 1) return {};
  if (priority > 0)
    return Error{Errc::usage, "--threads 2: cannot be combined with --priority " +
                                  std::to_string(priority) +
                                  ", because a spinning thread with SCHED_FIFO blocks its "
                                  "processor; use --priority 0, or one thread"};
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
    return Error{Errc::usage, "--spin on: needs --priority, because the ordinary scheduler delays "
                              "a thread that spins"};
  loop.sculptor.deformer.evaluation.threads = static_cast<int>(threads);
  return check_threads();
}

void add_polynomial_option(cli::Command& command, std::string& name) {
  command.add_option("--polynomial", name,
                     "none, constant or linear; constant and linear move the whole model");
}

Result<deform::CsrbfOptions> csrbf_for(const flow::LoopSettings& settings,
                                       const std::string& polynomial) {
  const auto known = deform::polynomial_named(polynomial);
  if (!known)
    return Error{Errc::usage,
                 "--polynomial " + polynomial + ": unknown; use none, constant or linear"};
  const flow::NumberSetting& volume = flow::setting::keep_volume;
  if (volume.of(settings) > 0.0 && *known != deform::Polynomial::none)
    return Error{Errc::usage,
                 fmt::format("{} and --polynomial {}: cannot be combined, because a polynomial "
                             "stretches the whole model; give one of them",
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
