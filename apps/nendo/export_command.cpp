// nendo export: a recorded run as files for animators and for plots.

#include <filesystem>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "cli/cli.hpp"
#include "cli/json_line.hpp"
#include "cli/output_place.hpp"
#include "export/gltf_export.hpp"
#include "export/hands_bvh.hpp"
#include "export/mesh_sequence.hpp"
#include "export/motion_csv.hpp"
#include "export/point_cache.hpp"
#include "nendo/commands.hpp"
#include "takes/recorded_frames.hpp"
#include "takes/recorded_model.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/timeline_file.hpp"

namespace nendo::app::export_command {
namespace {

struct Options {
  std::string file;
  std::string out;
  std::string format;
  std::string mesh;
  std::optional<double> rate_hz;
  double from_s = 0.0;
  std::optional<double> to_s;
  double tolerance = 1e-4;
  bool no_hands = false;
  bool json = false;
};

constexpr double animators_rate_hz = 30.0; // where the file does not tell its rate

bool is_sequence(const std::string& format) {
  return format == "obj" || format == "ply";
}

/// Returns the format of the files, or an error if they cannot go where --out says.
Result<std::string> format_of(const Options& options) {
  if (options.format.empty()) {
    if (const auto fine = cli::check_place(
            "--out", options.out, {".glb", ".pc2", ".mdd", ".obj", ".ply", ".bvh", ".csv"});
        !fine)
      return fine.error();
    return std::filesystem::path(options.out).extension().string().substr(1);
  }
  const std::string ending = "." + options.format;
  const auto fine = is_sequence(options.format) ? cli::check_place("--out", options.out, {ending})
                                                : cli::check_place("--out", options.out);
  if (!fine) return fine.error();
  return options.format;
}

Result<std::string> check(const Options& options, const exporting::Choice& choice) {
  if (const auto fine = check(choice); !fine) return fine.error();
  if (!(options.tolerance > 0.0 && options.tolerance <= 0.1))
    return Error{Errc::usage, "--tolerance: use a part of the model's diagonal, above 0 and up to "
                              "0.1"};
  const auto format = format_of(options);
  if (!format || !is_sequence(*format)) return format;
  if (const auto name = exporting::NumberedName::parse(options.out); !name) return name.error();
  return format;
}

/// A recording, or a timeline, that can be played again from its beginning.
struct Take {
  exporting::Skeletons skeletons;
  exporting::OpenFrames open;
};

Result<Take> read_recorded(const Options& options) {
  const auto reader = recording::TakeReader::open(options.file);
  if (!reader) return reader.error();
  const recording::Setup& setup = reader->setup();
  auto model = takes::recorded_model(options.file, setup, options.mesh);
  if (!model) return model.error();
  Take take;
  for (const auto& hand : setup.hands)
    take.skeletons[flow::Placement::index_of(hand.side)].emplace(hand.skeleton(hand.first.side));
  take.open = [path = options.file,
               mesh = *std::move(model)]() -> Result<std::unique_ptr<takes::FrameSource>> {
    auto frames = takes::RecordedFrames::open(path, mesh);
    if (!frames) return frames.error();
    return std::unique_ptr<takes::FrameSource>(*std::move(frames));
  };
  return take;
}

Result<Take> read_edited(const Options& options) {
  const auto timeline = timeline::read_timeline(options.file);
  if (!timeline) return timeline.error();
  Take take;
  for (const auto& hand : timeline->hands)
    take.skeletons[flow::Placement::index_of(hand.side)].emplace(hand.skeleton());
  take.open = [path = options.file,
               mesh = options.mesh]() -> Result<std::unique_ptr<takes::FrameSource>> {
    auto frames = takes::TimelineFrames::open(path, mesh);
    if (!frames) return frames.error();
    return std::unique_ptr<takes::FrameSource>(*std::move(frames));
  };
  return take;
}

// Sets the rate of formats whose frames have even times. In glTF and CSV each frame has its own
// time.
void settle_rate(const std::string& format, const takes::FrameSource& source,
                 exporting::Choice& choice) {
  if (choice.rate_hz || format == "glb" || format == "csv") return;
  choice.rate_hz = format == "bvh" ? source.rate_hz() : animators_rate_hz;
}

Result<exporting::Exported> export_take(const Take& take, const std::string& format,
                                        const Options& options, exporting::Choice choice) {
  if (format == "glb") {
    const exporting::GltfOptions gltf{options.tolerance, !options.no_hands, "Nendo " NENDO_VERSION};
    return exporting::export_gltf(take.open, choice, gltf, options.out);
  }
  const auto source = take.open();
  if (!source) return source.error();
  settle_rate(format, **source, choice);
  auto frames = exporting::ChosenFrames::make(**source, choice);
  if (!frames) return frames.error();
  if (format == "pc2")
    return exporting::export_point_cache(*frames, exporting::PointCache::pc2, options.out);
  if (format == "mdd")
    return exporting::export_point_cache(*frames, exporting::PointCache::mdd, options.out);
  if (format == "bvh") return exporting::export_hands_bvh(*frames, take.skeletons, options.out);
  if (format == "csv") return exporting::export_motion_csv(*frames, options.out);
  return exporting::export_mesh_sequence(*frames, options.out);
}

void print_json(const std::string& format, const exporting::Exported& done) {
  nlohmann::ordered_json line{{"event", "exported"},        {"format", format},
                              {"frames", done.frames},      {"first_s", done.first_s},
                              {"last_s", done.last_s},      {"bytes", done.bytes},
                              {"files", done.files.size()}, {"exact", done.exact}};
  line["result"] = done.files.empty() ? std::string() : done.files.front();
  if (done.morphs) {
    line["morphs"] = {{"by", done.morphs->by_control_vectors ? "control vectors" : "key shapes"},
                      {"targets", done.morphs->targets},
                      {"keys", done.morphs->keys},
                      {"greatest_error", done.morphs->greatest_error}};
  }
  cli::print_line(line);
}

void print(const exporting::Exported& done) {
  const std::string more = done.files.size() > 1 ? " to " + done.files.back() : std::string();
  std::cout << fmt::format("{}{}: {} frames, {:.2f} s, {:.1f} MB\n", done.files.front(), more,
                           done.frames, done.last_s - done.first_s,
                           static_cast<double>(done.bytes) / 1e6);
  if (done.morphs)
    std::cout << fmt::format(
        "{} morph targets of {}; no vertex of any frame is off by more than {:.1e} of the "
        "model's diagonal\n",
        done.morphs->targets,
        done.morphs->by_control_vectors ? "the control vectors" : "key shapes",
        done.morphs->greatest_error);
  std::cout << std::flush;
}

int export_command(const Options& options) {
  cli::install_stop_signals();
  const exporting::Choice choice{options.from_s, options.to_s, options.rate_hz,
                                 &cli::stop_requested()};
  const auto format = check(options, choice);
  if (!format) return cli::report(format.error());
  const auto take =
      timeline::is_timeline(options.file) ? read_edited(options) : read_recorded(options);
  if (!take) return cli::report(take.error());
  const auto done = export_take(*take, *format, options, choice);
  if (!done) return cli::report(done.error());
  if (!done->exact) takes::note_missing(options.file);
  if (options.json)
    print_json(*format, *done);
  else
    print(*done);
  return 0;
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command(
      "export", "Writes a recorded run as animation: glTF, point caches, meshes, BVH, CSV");
  command
      .add_option("TAKE", options->file,
                  "What `nendo run --record` recorded, or a timeline of `nendo edit`")
      .required();
  command
      .add_option("--out", options->out,
                  "Where to write: .glb (model and hands), .pc2 or .mdd (the model's vertices), "
                  "NAME-%04d.obj or .ply (a mesh a frame), .bvh (a file a hand), .csv (angles and "
                  "fingertips)")
      .required();
  command.add_option("--format", options->format, "In place of the name's ending")
      .one_of({"glb", "pc2", "mdd", "obj", "ply", "bvh", "csv"});
  command.add_option("--rate", options->rate_hz,
                     "Frames a second, each the nearest that was made; without it .glb and .csv "
                     "have every frame at its own time, .bvh has the take's rate, the others 30");
  command.add_option("--from", options->from_s, "Seconds from the beginning");
  command.add_option("--to", options->to_s, "Seconds from the beginning where it ends");
  command.add_option("--mesh", options->mesh, "The model, if it is no longer where it was");
  command.add_option("--tolerance", options->tolerance,
                     ".glb: how far vertices may be off where key shapes are needed, in parts of "
                     "the model's diagonal");
  command.add_flag("--no-hands", options->no_hands, ".glb: the model alone");
  command.add_flag("--json", options->json, "A summary as JSON");
  command.on_chosen([options] { return export_command(*options); });
}

} // namespace nendo::app::export_command
