// nendo replay: replays a recorded run, at any speed or as fast as possible.

#include <algorithm>
#include <iostream>
#include <thread>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/text.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/simd.hpp>
#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_tools.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::replay_command {
namespace {

struct Options {
  std::string file;
  std::string mesh;
  std::string out;
  double speed = 1.0;
  double from_s = 0.0;
  std::optional<double> to_s;
  bool loops = false;
  bool no_clock = false;
  bool json = false;
};

/// The result of a replay.
struct Replayed {
  std::uint64_t ticks = 0;
  bool to_the_end = false;
  bool exact = false;             ///< nothing was missing
  std::optional<bool> same_shape; ///< as the live run has made; nothing: that is unknown
  std::uint64_t shapes = 0;       ///< recorded shapes that were compared
  double farthest = 0.0;          ///< distance of a vertex from where they have it, model units
  double elapsed_s = 0.0;
  deform::Mesh shape;
};

Result<void> check(const Options& options) {
  constexpr double min_speed = 0.01;
  constexpr double max_speed = 100.0;
  constexpr double max_s = 1e7;
  if (!(options.speed >= min_speed && options.speed <= max_speed))
    return Error{Errc::usage, "--speed: use a number from 0.01 to 100"};
  const double to_s = options.to_s.value_or(max_s);
  if (!(options.from_s >= 0.0 && options.from_s < to_s && to_s <= max_s))
    return Error{Errc::usage, "--from, --to: use seconds from the beginning, --from before --to"};
  if (options.loops && options.no_clock)
    return Error{Errc::usage, "--loop and --no-clock: give one of them"};
  return cli::check_place("--out", options.out, deform::mesh_endings);
}

HostTime host_time(const recording::Setup& setup, double seconds) {
  return setup.begun_host + from_seconds(seconds);
}

/// Sleeps until a tick is due, in short intervals, so that a signal ends the wait.
class Pace {
public:
  Pace(const Options& options, HostTime first) : options_(options), first_(first) {}

  void wait_for(HostTime tick) {
    if (options_.no_clock || tick < first_) return;
    if (!begun_) begun_ = HostClock::now();
    const double due_s = to_seconds(tick - first_) / options_.speed;
    double left_s = 0.0;
    while (!cli::stop_requested() &&
           (left_s = due_s - to_seconds(HostClock::now() - *begun_)) > 0.0)
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left_s, 0.05)));
  }

private:
  const Options& options_;
  HostTime first_;
  std::optional<HostTime> begun_;
};

// Compares the loop's shape with the one that was recorded after the latest tick, if any.
void compare_shapes(recording::TakeReader& reader, flow::DeformLoop& loop, Replayed& done) {
  const auto recorded = reader.take_shape();
  if (!recorded) return;
  loop.frames().update();
  const flow::Frame& frame = loop.frames().front();
  deform::Points shape;
  loop.changes().layout(frame.model).unpack(frame.shape, shape);
  const auto distance = recording::distance_between(*recorded, shape);
  if (!distance) return;
  ++done.shapes;
  done.farthest = std::max(done.farthest, *distance);
}

Result<Replayed> replay_once(const Options& options, const takes::RecordedModel& model) {
  auto reader = recording::TakeReader::open(options.file);
  if (!reader) return reader.error();
  auto replay = recording::LoopReplay::make(reader->setup(), model.mesh);
  if (!replay) return Error{replay.error().code, options.file + ": " + replay.error().message};
  constexpr double no_end_s = 1e8;
  const HostTime last = host_time(reader->setup(), options.to_s.value_or(no_end_s));
  Pace pace(options, host_time(reader->setup(), options.from_s));
  const HostTime start = HostClock::now();
  Replayed done;
  done.to_the_end = true;
  while (const auto entry = reader->next()) {
    compare_shapes(*reader, (*replay)->loop(), done);
    if (const auto* tick = std::get_if<flow::LoggedTick>(&*entry)) {
      if (tick->woke >= last) done.to_the_end = false;
      pace.wait_for(tick->woke);
      if (cli::stop_requested()) done.to_the_end = false;
      if (!done.to_the_end) break;
    }
    if ((*replay)->feed(*entry)) ++done.ticks;
  }
  if (done.to_the_end) compare_shapes(*reader, (*replay)->loop(), done);
  done.exact = (*replay)->is_exact() && reader->chunks().damage_count() == 0;
  done.elapsed_s = to_seconds(HostClock::now() - start);
  done.shape = (*replay)->loop().final_mesh();
  const auto& ending = reader->ending();
  if (done.to_the_end && done.exact && model.is_recorded && ending && ending->shape)
    done.same_shape = *ending->shape == recording::sum_of(done.shape.vertices);
  return done;
}

void print(const Options& options, const Replayed& done) {
  const auto sum = recording::sum_of(done.shape.vertices);
  if (options.json) {
    nlohmann::ordered_json line{
        {"event", "replayed"},           {"ticks", done.ticks}, {"elapsed_s", done.elapsed_s},
        {"to_the_end", done.to_the_end}, {"exact", done.exact}, {"same_shape", nullptr},
        {"vertices", sum.vertices},      {"crc32c", sum.crc},   {"result", options.out}};
    if (done.same_shape) line["same_shape"] = *done.same_shape;
    line["model_notes"] = cli::model_notes();
    line["shapes"] = done.shapes;
    line["farthest_from_shapes"] = done.farthest;
    cli::print_line(line);
    return;
  }
  cli::print("replayed {} ticks in {:.2f} s; ", done.ticks, done.elapsed_s);
  if (done.same_shape) {
    std::cout << (*done.same_shape ? "the shape is that of the live run, bit for bit\n"
                                   : "the shape is NOT that of the live run\n");
  } else {
    std::cout << (done.exact ? "nothing is missing\n"
                             : "something is missing in the recording, so the shape may differ\n");
  }
  if (done.shapes > 0)
    cli::print("{} recorded shapes were compared; the max distance of a vertex is {:.3g}\n",
               done.shapes, done.farthest);
  std::cout << std::flush;
}

/// Error: usage, if --from is after the end, where nothing could be replayed.
Result<void> check_from(const Options& options) {
  if (options.from_s <= 0.0) return {};
  const auto summary = recording::summarise(options.file);
  if (!summary) return summary.error();
  const double end_s = to_seconds(summary->duration());
  if (options.from_s < end_s) return {};
  return Error{Errc::usage, fmt::format("--from {:g}: {} lasts {:.2f} s; use less", options.from_s,
                                        options.file, end_s)};
}

/// Replays until a signal comes, or once. The last shape is that of the last replay.
Result<Replayed> replay_all(const Options& options, const takes::RecordedModel& model) {
  for (;;) {
    auto done = replay_once(options, model);
    if (!done) return done;
    print(options, *done);
    if (!options.loops || cli::stop_requested()) return done;
  }
}

Result<void> replay(const Options& options) {
  if (auto fine = check(options); !fine) return fine;
  const auto reader = recording::TakeReader::open(options.file);
  if (!reader) return reader.error();
  if (auto fine = check_from(options); !fine) return fine;
  if (!reader->setup().loop)
    return Error{Errc::bad_input, options.file + ": " + std::string(recording::without_loop)};
  const auto model = takes::find_recorded_model(*reader->setup().loop, options.mesh);
  if (!model) return model.error();
  const std::string simd(deform::simd_names().front());
  if (reader->setup().loop->simd != simd)
    cli::note("recorded with the instructions " + printable(reader->setup().loop->simd) +
              ", replayed with " + simd + ", which round differently");
  cli::install_stop_signals();
  const auto done = replay_all(options, *model);
  if (!done) return done.error();
  if (!options.out.empty()) {
    if (auto written = takes::write_model(options.out, done->shape, model->up()); !written)
      return written;
    if (!options.json) report_model(options.out, done->shape);
  }
  if (done->same_shape.value_or(true)) return {};
  return Error{Errc::failed, options.file + ": the shape is not the recorded one"};
}

} // namespace
} // namespace nendo::app::replay_command

void nendo::app::add_replay(cli::Command& program) {
  using namespace replay_command;
  cli::Command command =
      program.add_command("replay", "Replays a recorded run: the same shape, bit for bit");
  Options& options = command.on_chosen<Options>(replay);
  command.add_option("FILE", options.file, "A recording of `nendo run --record`").required();
  command.add_option("--speed", options.speed, "Speed relative to real time, 0.01 to 100");
  command.add_flag("--no-clock", options.no_clock, "As fast as possible");
  command.add_flag("--loop", options.loops, "Repeat until Ctrl-C");
  command.add_duration(
      "--from", options.from_s,
      "Seconds from the beginning; everything before is replayed as fast as possible");
  command.add_duration("--to", options.to_s, "Seconds from the beginning at which it ends");
  command.add_option("--mesh", options.mesh, "The model, if it has been moved");
  command.add_option("--out", options.out, "Where to write the shape, .obj, .ply or .stl");
  command.add_flag("--json", options.json, "A summary as JSON");
}
