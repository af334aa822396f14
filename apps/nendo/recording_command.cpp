// nendo recording: looks after recordings.

#include <iostream>
#include <memory>

#include <spdlog/fmt/fmt.h>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "nendo/commands.hpp"
#include "takes/joint_report.hpp"
#include "takes/recorded_model.hpp"
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

int info(const Options& options) {
  const auto summary = recording::summarise(options.file);
  if (!summary) return cli::report(summary.error());
  if (options.json) {
    takes::print_take_json(options.file, *summary);
  } else {
    takes::print_take(options.file, *summary);
  }
  return 0;
}

int joints(const Options& options) {
  const auto studies = takes::study_joints(std::filesystem::path(options.file));
  if (!studies) return cli::report(studies.error());
  if (options.json) {
    takes::print_joints_json(options.file, *studies);
  } else {
    takes::print_joints(options.file, *studies);
  }
  return 0;
}

/// Returns where the damage is, without a full stop.
std::string extent_of(const recording::TakeSummary& summary) {
  if (summary.damage_count == 0) return "each chunk is whole, but not what stands in them";
  if (summary.good_end < summary.bytes)
    return "nothing is whole behind byte " + std::to_string(summary.good_end) + " of " +
           std::to_string(summary.bytes);
  return "what follows the damage is whole to the end, which is byte " +
         std::to_string(summary.bytes);
}

int check(const Options& options) {
  const auto summary = recording::summarise(options.file);
  if (!summary) return cli::report(summary.error());
  if (summary->is_whole()) {
    std::cout << fmt::format("{}: whole, {} bytes, {} ticks{}\n", options.file, summary->bytes,
                             summary->ticks,
                             summary->ending ? "" : "; it has no end, so the recorder was cut off");
    return 0;
  }
  takes::print_damages(*summary);
  return cli::report({Errc::failed, options.file + ": is damaged; " + extent_of(*summary) +
                                        ", and `nendo recording repair` makes a new file of what "
                                        "is whole"});
}

void print_made(const Options& options, std::uint64_t count, const char* what,
                std::uint64_t bytes) {
  std::cout << fmt::format("{}: {} {}, {} bytes\n", options.out, count, what, bytes);
}

int repair(const Options& options) {
  if (const auto fine = cli::check_place("--out", options.out); !fine)
    return cli::report(fine.error());
  const auto made = recording::repair_take(options.file, options.out);
  if (!made) return cli::report(made.error());
  print_made(options, made->chunks, "whole chunks", made->bytes);
  if (made->damages == 0) cli::note(options.file + ": was whole already; the new file is a copy");
  if (made->damages > 0)
    cli::note("damaged places that are gaps now: " + std::to_string(made->damages) +
              "; a replay from there on need not be the same");
  return 0;
}

int cut(const Options& options) {
  constexpr double max_s = 1e7;
  const double to_s = options.to_s.value_or(max_s);
  if (!(options.from_s >= 0.0 && options.from_s < to_s && to_s <= max_s))
    return cli::report(
        {Errc::usage, "--from, --to: use seconds from the beginning, --from before --to"});
  if (const auto fine = cli::check_place("--out", options.out); !fine)
    return cli::report(fine.error());
  const auto made = recording::cut_take(options.file, options.out, from_seconds(options.from_s),
                                        from_seconds(to_s));
  if (!made) return cli::report(made.error());
  print_made(options, made->entries, "entries", made->bytes);
  return 0;
}

int shapes(const Options& options) {
  constexpr double max_hz = 10'000.0;
  if (!(options.rate_hz > 0.0 && options.rate_hz <= max_hz))
    return cli::report({Errc::usage, "--rate: use more than 0 and at most 10000 shapes a second"});
  if (const auto fine = cli::check_place("--out", options.out); !fine)
    return cli::report(fine.error());
  const auto reader = recording::TakeReader::open(options.file);
  if (!reader) return cli::report(reader.error());
  const auto model = takes::recorded_model(options.file, reader->setup(), options.mesh);
  if (!model) return cli::report(model.error());
  const auto made = recording::add_shapes(options.file, options.out, model->mesh, options.rate_hz);
  if (!made) return cli::report(made.error());
  print_made(options, made->shapes, "shapes", made->bytes);
  return 0;
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command("recording", "Looks after recordings");
  command.require_command();

  cli::Command telling = command.add_command("info", "Who, when, how long, rates, losses, gaps");
  telling.add_option("FILE", options->file, "A recording").required();
  telling.add_flag("--json", options->json, "One JSON object");
  telling.on_chosen([options] { return info(*options); });

  cli::Command studying = command.add_command(
      "joints", "How far each joint moved, how noisily, and with which others, beside anatomy");
  studying.add_option("FILE", options->file, "A recording").required();
  studying.add_flag("--json", options->json, "One JSON object");
  studying.on_chosen([options] { return joints(*options); });

  cli::Command checking =
      command.add_command("check", "Verifies all checksums and numbers; exit code 1 on damage");
  checking.add_option("FILE", options->file, "A recording").required();
  checking.on_chosen([options] { return check(*options); });

  cli::Command repairing = command.add_command("repair", "Makes a new file of what is whole");
  repairing.add_option("FILE", options->file, "A damaged recording; it stays as it is").required();
  repairing.add_option("--out", options->out, "The new file").required();
  repairing.on_chosen([options] { return repair(*options); });

  cli::Command cutting = command.add_command("cut", "Makes a new file of a part");
  cutting.add_option("FILE", options->file, "A recording; it stays as it is").required();
  cutting.add_duration("--from", options->from_s, "Seconds from the beginning");
  cutting.add_duration("--to", options->to_s, "Seconds from the beginning; without it, the end");
  cutting.add_option("--out", options->out, "The new file").required();
  cutting.on_chosen([options] { return cut(*options); });

  cli::Command shaping = command.add_command(
      "shapes", "Makes a new file with shapes in it, for programs that have no loop");
  shaping.add_option("FILE", options->file, "A recording; it stays as it is").required();
  shaping.add_rate("--rate", options->rate_hz, "Shapes a second, 12 bytes a vertex each");
  shaping.add_option("--mesh", options->mesh, "The model, if it is no longer where it was");
  shaping.add_option("--out", options->out, "The new file").required();
  shaping.on_chosen([options] { return shapes(*options); });
}

} // namespace nendo::app::recording_command
