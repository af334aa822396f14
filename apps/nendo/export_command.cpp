// nendo export: writes a recorded run as files for animators and for plots.

#include <array>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "cli/print.hpp"
#include "cli/quantities.hpp"
#include "export/gltf_export.hpp"
#include "export/mcap_file.hpp"
#include "export/motion_files.hpp"
#include "export/shape_files.hpp"
#include "nendo/commands.hpp"
#include "takes/model_files.hpp"
#include "takes/recorded_frames.hpp"
#include "takes/tape_commands.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/timeline.hpp"

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
  std::string tolerance = "1%";
  bool every_frame = false;
  bool samples = false;
  bool no_hands = false;
  bool json = false;
};

constexpr std::array<std::string_view, 9> export_endings{".glb", ".pc2", ".mdd", ".obj", ".ply",
                                                         ".stl", ".bvh", ".csv", ".mcap"};

bool is_sequence(const std::string& format) {
  return !ending_of("." + format, deform::mesh_endings).empty();
}

/// Returns the format of the files, or an error if they cannot go where --out says.
Result<std::string> format_of(const Options& options) {
  if (options.format.empty()) {
    if (const auto fine = cli::check_place("--out", options.out, export_endings); !fine)
      return fine.error();
    return std::string(ending_of(options.out, export_endings).substr(1));
  }
  const std::string ending = "." + options.format;
  const auto fine = is_sequence(options.format) ? cli::check_place("--out", options.out, {ending})
                                                : cli::check_place("--out", options.out);
  if (!fine) return fine.error();
  return options.format;
}

/// Reads --tolerance: a length on the stage, or a fraction of the model's diagonal.
Result<exporting::GltfOptions> parse_tolerance(const std::string& text) {
  constexpr double max = 0.1; // metres, or diagonals
  exporting::GltfOptions gltf;
  const bool percent = text.ends_with('%');
  const auto number = cli::number_of(percent ? text.substr(0, text.size() - 1) : text);
  gltf.tolerance_m = to_metres(text);
  gltf.tolerance = number.value_or(0.0) / (percent ? 100.0 : 1.0);
  const double value = gltf.tolerance_m.value_or(gltf.tolerance);
  if (value > 0.0 && value <= max) return gltf;
  return Error{Errc::usage, "--tolerance " + text + ": use " + std::string(cli::length_words) +
                                ", up to 0.1m, or a fraction of the model's diagonal like 0.01 or "
                                "1%, up to 10%"};
}

Result<void> check_rate(const Options& options, const std::string& format) {
  if (options.every_frame && options.rate_hz)
    return Error{Errc::usage, "--every-frame and --rate: give one of them"};
  if (options.every_frame && format != "glb" && format != "csv" && format != "mcap")
    return Error{Errc::usage, "--every-frame: only .glb, .csv and .mcap store the time of each "
                              "frame; use --rate"};
  return {};
}

/// A recording for ROS 2 has hands, and no model.
Result<void> check_mcap(const Options& options) {
  if (options.no_hands)
    return Error{Errc::usage, "--no-hands: an .mcap file has nothing but hands; leave it out"};
  if (options.tolerance != Options{}.tolerance)
    return Error{Errc::usage, "--tolerance: an .mcap file has no model; leave it out"};
  return {};
}

/// Returns the format of the files.
Result<std::string> check(const Options& options, const exporting::Choice& choice) {
  if (const auto fine = check(choice); !fine) return fine.error();
  if (const auto tolerance = parse_tolerance(options.tolerance); !tolerance)
    return tolerance.error();
  const auto format = format_of(options);
  if (!format) return format;
  if (const auto fine = check_rate(options, *format); !fine) return fine.error();
  if (*format == "mcap")
    if (const auto fine = check_mcap(options); !fine) return fine.error();
  if (options.samples && *format != "csv")
    return Error{Errc::usage, "--samples: needs a .csv file"};
  if (!is_sequence(*format)) return format;
  if (const auto name = exporting::NumberedName::parse(options.out); !name) return name.error();
  return format;
}

/// A recording, or a timeline, that can be played again from its beginning.
struct Take {
  exporting::Skeletons skeletons;
  exporting::OpenFrames open;
  bool has_samples = false;      ///< samples of gloves, for a table
  exporting::McapOptions mcap{}; ///< data for a recording for ROS 2, as `commands`
  std::vector<timeline::Event> commands{};
  std::vector<std::string> notes; ///< to be said once the file is written
};

/// Returns one line for each hand whose angles are only estimated.
std::vector<std::string> uncalibrated_notes(const Options& options, const recording::Setup& setup,
                                            const std::string& remedy) {
  std::vector<std::string> notes;
  for (std::size_t glove = 0; glove < setup.hands.size(); ++glove)
    if (!takes::is_calibrated(setup, glove))
      notes.push_back(options.file + ": the " + std::string(name_of(setup.hands[glove].side)) +
                      " hand was recorded without a calibration; " + remedy);
  return notes;
}

bool exports_samples(const Options& options, const std::string& format, bool has_loop) {
  return format == "csv" && (options.samples || !has_loop);
}

template <class Frames>
Result<std::unique_ptr<takes::FrameSource>> source_of(Result<std::unique_ptr<Frames>> frames) {
  if (!frames) return frames.error();
  return std::unique_ptr<takes::FrameSource>(*std::move(frames));
}

/// Gloves without a loop: their hands can be shown, and no model.
Result<Take> read_gloves(const Options& options, const std::string& format, Take take) {
  if (!options.mesh.empty() || options.no_hands ||
      !(format == "glb" || format == "bvh" || format == "mcap")) {
    return Error{Errc::bad_input,
                 options.file + ": has only gloves, which .csv, .bvh, .glb and .mcap can store; "
                                "shape a model with `nendo run --right replay:FILE`"};
  }
  take.open = [path = options.file] { return source_of(takes::GloveFrames::open(path)); };
  return take;
}

Result<Take> read_recorded(const Options& options, const std::string& format) {
  const auto reader = recording::TakeReader::open(options.file);
  if (!reader) return reader.error();
  const recording::Setup& setup = reader->setup();
  Take take;
  take.has_samples = exports_samples(options, format, setup.loop.has_value());
  if (take.has_samples) {
    take.notes = uncalibrated_notes(options, setup, "its angles are left out");
    return take;
  }
  if (format == "mcap") {
    auto commands = takes::recorded_commands(options.file);
    if (!commands) return commands.error();
    take.commands = *std::move(commands);
    take.mcap.begun_utc_ns = setup.begun.time_since_epoch().count();
  }
  for (const auto& hand : setup.hands)
    if (auto& skeleton = take.skeletons[flow::Placement::index_of(hand.side)]; !skeleton)
      skeleton.emplace(hand.skeleton(hand.first.side)); // layers play over it
  if (!setup.loop) {
    take.notes = uncalibrated_notes(options, setup, "its angles are those of an average hand");
    return read_gloves(options, format, std::move(take));
  }
  auto model = takes::recorded_model(options.file, setup, options.mesh);
  if (!model) return model.error();
  take.open = [path = options.file, mesh = std::move(model->mesh), up = model->up()] {
    auto frames = takes::RecordedFrames::open(path, mesh);
    if (frames) (*frames)->set_up(up);
    return source_of(std::move(frames));
  };
  return take;
}

Result<Take> read_edited(const Options& options) {
  if (options.samples)
    return Error{Errc::usage, "--samples: a timeline has none; name the recording"};
  const auto timeline = timeline::read_timeline(options.file);
  if (!timeline) return timeline.error();
  Take take;
  take.commands = timeline->events;
  for (const auto& hand : timeline->hands)
    take.skeletons[flow::Placement::index_of(hand.side)].emplace(hand.skeleton());
  take.open = [path = options.file, mesh = options.mesh] {
    return source_of(takes::TimelineFrames::open(path, mesh));
  };
  return take;
}

// Sets the rate unless it was asked for. Tables and recordings have every frame.
void settle_rate(const Options& options, const std::string& format,
                 const takes::FrameSource& source, exporting::Choice& choice) {
  if (choice.rate_hz || options.every_frame || format == "csv" || format == "mcap") return;
  choice.rate_hz = format == "bvh" ? source.rate_hz() : exporting::animators_rate_hz;
}

Result<exporting::Exported> export_take(const Take& take, const std::string& format,
                                        const Options& options, exporting::Choice choice) {
  if (take.has_samples) {
    if (choice.rate_hz)
      return Error{Errc::usage, "--rate: a table of samples has every sample; leave it out"};
    return exporting::export_samples_csv(options.file, choice, options.out);
  }
  const auto source = take.open();
  if (!source) return source.error();
  settle_rate(options, format, **source, choice);
  if (format == "glb") {
    auto gltf = parse_tolerance(options.tolerance);
    if (!gltf) return gltf.error();
    gltf->hands = !options.no_hands;
    gltf->generator = "Nendo " NENDO_VERSION;
    return exporting::export_gltf(**source, choice, *gltf, options.out);
  }
  deform::Points offset = (*source)->model(0).offset;
  if ((*source)->up() == deform::UpAxis::z && (format == "pc2" || format == "mdd"))
    deform::lay_z_up(offset);
  const auto counted_from = [&](Result<exporting::Exported> done) {
    if (done) done->offset = offset;
    return done;
  };
  using exporting::PointCache;
  if (format == "pc2" || format == "mdd")
    return counted_from(exporting::export_point_caches(
        take.open, choice, format == "pc2" ? PointCache::pc2 : PointCache::mdd, options.out));
  auto frames = exporting::ChosenFrames::make(**source, choice);
  if (!frames) return frames.error();
  if (format == "bvh")
    return counted_from(exporting::export_hands_bvh(*frames, take.skeletons, options.out));
  if (format == "mcap") {
    exporting::McapOptions mcap = take.mcap;
    mcap.library = "Nendo " NENDO_VERSION;
    return counted_from(exporting::export_mcap(*frames, take.commands, mcap, options.out));
  }
  if (format == "csv") return counted_from(exporting::export_motion_csv(*frames, options.out));
  auto done = exporting::export_mesh_sequence(*frames, options.out);
  if (!done) return done;
  for (const std::string& lost : deform::lost_in_file("." + format, (*source)->model(0)))
    cli::note(options.out + ": " + lost);
  return done;
}

/// Reports the offset that the files of a model far from zero do not contain.
void note_offset(const std::string& format, const exporting::Exported& done) {
  if (done.offset.isZero(0.0)) return;
  const std::string place =
      fmt::format("({}, {}, {})", done.offset.x(), done.offset.y(), done.offset.z());
  if (format == "pc2" || format == "mdd")
    cli::note(done.files.front() + ": its vertices count from " + place +
              " in model units, because 32-bit floats are coarse so far from zero; move the mesh "
              "that plays it to that place");
  else
    cli::note(done.files.front() + ": the middle of the stage is " + place + " in model units");
}

void print_json(const std::string& format, const exporting::Exported& done) {
  nlohmann::ordered_json line{{"event", "exported"},        {"format", format},
                              {"frames", done.frames},      {"first_s", done.first_s},
                              {"last_s", done.last_s},      {"bytes", done.bytes},
                              {"files", done.files.size()}, {"exact", done.exact}};
  if (done.rate_hz) line["rate_hz"] = *done.rate_hz;
  if (!done.begin_s.empty()) line["begin_s"] = done.begin_s;
  if (!done.offset.isZero(0.0))
    line["offset"] = {done.offset.x(), done.offset.y(), done.offset.z()};
  line["model_notes"] = cli::model_notes();
  line["result"] = done.files.empty() ? std::string() : done.files.front();
  if (done.morphs) {
    line["morphs"] = {{"by", name_of(done.morphs->basis)},
                      {"models", done.morphs->models},
                      {"targets", done.morphs->targets},
                      {"keys", done.morphs->keys},
                      {"greatest_error", done.morphs->greatest_error}};
    if (done.morphs->basis == exporting::MorphBasis::key_shapes)
      line["morphs"]["tolerance"] = done.morphs->tolerance;
  }
  cli::print_line(line);
}

/// Explains why the targets are not named after the puppet's functions.
void print_no_functions(const exporting::MorphReport& morphs) {
  if (morphs.has_puppet)
    std::cout << "the targets are not named after the puppet's functions, because the shapes are "
                 "not sums of them (undo, reset, type 2, changed settings or another model)\n";
}

void print_morphs(const exporting::MorphReport& morphs) {
  if (morphs.models > 1)
    cli::print("{} meshes, shown one after another, because the model or its puppet "
               "changed\n",
               morphs.models);
  if (morphs.basis != exporting::MorphBasis::key_shapes) {
    const bool named = morphs.basis == exporting::MorphBasis::functions;
    cli::print("{} morph targets{}; the max error of a vertex is {:.1e} of the model's diagonal\n",
               morphs.targets,
               named ? ", named after the puppet's functions" : " of the control vectors",
               morphs.greatest_error);
    if (!named) print_no_functions(morphs);
    return;
  }
  cli::print("{} morph targets of key shapes, within {:.3g} % of the model's diagonal, "
             "{:.2g} mm on the stage (--tolerance); the max error is {:.2g} %\n",
             morphs.targets, 100.0 * morphs.tolerance, 1e3 * morphs.tolerance * morphs.diagonal_m,
             100.0 * morphs.greatest_error);
  print_no_functions(morphs);
}

void print(const exporting::Exported& done, bool samples) {
  const std::string more = done.files.size() > 1 ? " to " + done.files.back() : std::string();
  const std::string rate =
      done.rate_hz ? fmt::format(", {:.4g} per second (--rate)", *done.rate_hz) : "";
  cli::print("{}{}: {} {}{}, {:.2f} s, {:.1f} MB\n", done.files.front(), more, done.frames,
             samples ? "samples" : "frames", rate, done.last_s - done.first_s,
             static_cast<double>(done.bytes) / 1e6);
  if (done.morphs) print_morphs(*done.morphs);
  for (std::size_t at = 1; at < done.begin_s.size(); ++at)
    cli::print("the model changes at {0:.2f} s, where {1} begins; for its mesh, export "
               "--from {0:.2f} --to {2:.2f} as NAME-%d.obj\n",
               done.begin_s[at], done.files[at],
               done.begin_s[at] + 1.0 / done.rate_hz.value_or(1.0));
  std::cout << std::flush;
}

Result<void> export_command(const Options& options) {
  cli::install_stop_signals();
  const exporting::Choice choice{options.from_s, options.to_s, options.rate_hz,
                                 &cli::stop_requested()};
  const auto format = check(options, choice);
  if (!format) return format.error();
  const auto take =
      timeline::is_timeline(options.file) ? read_edited(options) : read_recorded(options, *format);
  if (!take) return take.error();
  const auto done = export_take(*take, *format, options, choice);
  if (!done) return done.error();
  for (const std::string& note : take->notes)
    cli::note(note);
  if (!done->exact) takes::note_missing(options.file);
  note_offset(*format, *done);
  if (options.json)
    print_json(*format, *done);
  else
    print(*done, take->has_samples);
  return {};
}

} // namespace
} // namespace nendo::app::export_command

void nendo::app::add_export(cli::Command& program) {
  using namespace export_command;
  cli::Command command = program.add_command(
      "export",
      "Writes a recording as animation, tables, or messages of ROS 2: glTF, point caches, "
      "meshes, BVH, CSV, MCAP");
  Options& options = command.on_chosen<Options>(export_command::export_command);
  command.set_footer(
      "A recording of `nendo record` has hands and no model: .csv (every sample: counts, angles, "
      "both\nclocks), .bvh, .glb and .mcap.");
  command
      .add_option("TAKE", options.file,
                  "A recording of `nendo run` or `nendo record`, or a timeline of `nendo edit`")
      .required();
  command
      .add_option("--out", options.out,
                  "Where to write: .glb (model and hands), .pc2 or .mdd (the model's vertices), "
                  "NAME-%04d.obj, .ply or .stl (one mesh per frame), .bvh (one file per hand), "
                  ".csv (angles and fingertips), .mcap (hands for ROS 2 and Foxglove)")
      .required();
  command.add_option("--format", options.format, "Format, if the name's ending does not say it")
      .one_of({"glb", "pc2", "mdd", "obj", "ply", "stl", "bvh", "csv", "mcap"});
  command.add_rate("--rate", options.rate_hz,
                   "Frames per second, each the nearest of the take; without it, .csv and .mcap "
                   "have every frame at its own time, .bvh the take's rate, and other formats 24");
  command.add_flag("--every-frame", options.every_frame,
                   ".glb: every frame of the take, at its own time");
  command.add_flag("--samples", options.samples,
                   ".csv: one row per sample of the gloves in place of one per frame");
  command.add_duration("--from", options.from_s, "Seconds from the beginning");
  command.add_duration("--to", options.to_s, "Seconds from the beginning at which it ends");
  command.add_option("--mesh", options.mesh, "The model, if it has been moved");
  command.add_option(
      "--tolerance", options.tolerance,
      ".glb: max error of vertices where key shapes are needed: a length on the stage "
      "like 1mm, or a fraction of the model's diagonal like 0.01 or 1%");
  command.add_flag("--no-hands", options.no_hands, ".glb: only the model");
  command.add_flag("--json", options.json, "A summary as JSON");
}
