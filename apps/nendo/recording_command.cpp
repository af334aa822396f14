// nendo recording: shows, checks, repairs and cuts recordings.

#include <memory>

#include <spdlog/fmt/fmt.h>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"
#include "nendo/commands.hpp"
#include "takes/joint_study.hpp"
#include "takes/model_files.hpp"
#include "takes/recording_report.hpp"

namespace nendo::app::recording_command {
namespace {

struct Options {
  std::string file;
  std::string out;
  double from_s = 0.0;
  std::optional<double> to_s;
  std::string mesh;
  double rate_hz = 10.0;
  bool json = false;
};

Result<void> info(const Options& options) {
  const auto summary = recording::summarise(options.file);
  if (!summary) return summary.error();
  (options.json ? takes::print_take_json : takes::print_take)(options.file, *summary);
  return {};
}

Result<void> joints(const Options& options) {
  const auto studies = takes::study_joints(std::filesystem::path(options.file));
  if (!studies) return studies.error();
  (options.json ? takes::print_joints_json : takes::print_joints)(options.file, *studies);
  return {};
}

/// Returns where the damage is, without a full stop.
std::string extent_of(const recording::TakeSummary& summary) {
  if (summary.damage_count == 0) return "each chunk is intact, but its contents are not valid";
  if (summary.good_end < summary.bytes)
    return fmt::format("nothing is intact after byte {} of {}", summary.good_end, summary.bytes);
  return fmt::format("everything after the damage is intact, to the end at byte {}", summary.bytes);
}

Result<void> check(const Options& options) {
  const auto summary = recording::summarise(options.file);
  if (!summary) return summary.error();
  if (summary->is_whole()) {
    cli::print("{}: intact, {} bytes, {} ticks{}\n", options.file, summary->bytes, summary->ticks,
               summary->ending ? "" : "; it has no end, because the recorder was cut off");
    return {};
  }
  takes::print_damages(*summary);
  return Error{Errc::failed, options.file + ": is damaged; " + extent_of(*summary) +
                                 ", and `nendo recording repair` makes a new file of the "
                                 "intact chunks"};
}

void print_made(const Options& options, std::uint64_t count, const char* what,
                std::uint64_t bytes) {
  cli::print("{}: {} {}, {} bytes\n", options.out, count, what, bytes);
}

Result<void> repair(const Options& options) {
  if (auto fine = cli::check_place("--out", options.out); !fine) return fine;
  const auto made = recording::repair_take(options.file, options.out);
  if (!made) return made.error();
  print_made(options, made->chunks, "intact chunks", made->bytes);
  if (made->damages == 0) cli::note(options.file + ": was intact; the new file is a copy");
  if (made->damages > 0)
    cli::note(fmt::format("{} damaged places became gaps; a replay may differ after the first of "
                          "them",
                          made->damages));
  return {};
}

Result<void> cut(const Options& options) {
  constexpr double max_s = 1e7;
  const double to_s = options.to_s.value_or(max_s);
  if (!(options.from_s >= 0.0 && options.from_s < to_s && to_s <= max_s))
    return Error{Errc::usage, "--from, --to: use seconds from the beginning, --from before --to"};
  if (auto fine = cli::check_place("--out", options.out); !fine) return fine;
  const auto made = recording::cut_take(options.file, options.out, from_seconds(options.from_s),
                                        from_seconds(to_s));
  if (!made) return made.error();
  print_made(options, made->entries, "entries", made->bytes);
  return {};
}

Result<void> shapes(const Options& options) {
  constexpr double max_hz = 10'000.0;
  if (!(options.rate_hz > 0.0 && options.rate_hz <= max_hz))
    return Error{Errc::usage, "--rate: use more than 0 and at most 10000 shapes per second"};
  if (auto fine = cli::check_place("--out", options.out); !fine) return fine;
  const auto reader = recording::TakeReader::open(options.file);
  if (!reader) return reader.error();
  const auto model = takes::recorded_model(options.file, reader->setup(), options.mesh);
  if (!model) return model.error();
  const auto made = recording::add_shapes(options.file, options.out, model->mesh, options.rate_hz);
  if (!made) return made.error();
  print_made(options, made->shapes, "shapes", made->bytes);
  return {};
}

} // namespace
} // namespace nendo::app::recording_command

void nendo::app::add_recording(cli::Command& program) {
  using namespace recording_command;
  auto options = std::make_shared<Options>();
  cli::Command command =
      program.add_command("recording", "Shows, checks, repairs and cuts recordings");
  command.require_command();
  const auto add = [&](const char* name, const char* summary, const char* file,
                       Result<void> (*run)(const Options&)) {
    cli::Command added = command.add_command(name, summary);
    added.add_option("FILE", options->file, file).required();
    added.on_chosen([options, run] { return run(*options); });
    return added;
  };
  const char* const kept = "A recording, which is not changed";
  add("info", "Shows wearer, times, duration, rates, losses and gaps", "A recording", info)
      .add_flag("--json", options->json, "One JSON object");
  add("joints", "Shows each joint's range, noise and coupled joints, compared with anatomy",
      "A recording", joints)
      .add_flag("--json", options->json, "One JSON object");
  add("check", "Verifies all checksums and numbers; exit code 1 on damage", "A recording", check);
  add("repair", "Makes a new file of the intact chunks",
      "A damaged recording, which is not changed", repair)
      .add_option("--out", options->out, "The new file")
      .required();

  cli::Command cutting = add("cut", "Makes a new file of a part", kept, recording_command::cut);
  cutting.add_duration("--from", options->from_s, "Seconds from the beginning");
  cutting.add_duration("--to", options->to_s, "Seconds from the beginning; without it, the end");
  cutting.add_option("--out", options->out, "The new file").required();

  cli::Command shaping = add(
      "shapes", "Makes a new file that contains shapes, for programs without a loop", kept, shapes);
  shaping.add_rate("--rate", options->rate_hz, "Shapes per second; each has 12 bytes per vertex");
  shaping.add_option("--mesh", options->mesh, "The model, if it has been moved");
  shaping.add_option("--out", options->out, "The new file").required();
}
