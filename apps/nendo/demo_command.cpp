// nendo demo: two emulated CyberGloves and the real serial driver play a face, or shape a Moai;
// with an emulated FASTRAK the hands walk round it; or simulated hands make a flat cake, a bowl and
// ears of clay.

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/emulator/served_emulator.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/sculpting/placing.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/quantities.hpp"
#include "export/gltf_export.hpp"
#include "nendo/commands.hpp"
#include "nendo/picture.hpp"
#include "render/picture.hpp"
#include "session/run_and_report.hpp"
#include "takes/model_files.hpp"
#include "takes/take.hpp"

namespace nendo::app::demo_command {
namespace {

constexpr double rate_hz = 90.0;
constexpr double max_s = 3600.0;

struct Options {
  std::string what = "face";
  std::string mode = "type1";
  double duration_s = 10.0;
  std::string out = "nendo-demo.obj";
  std::string picture = "nendo-demo.png";
  std::string record; ///< empty: beside `out`; an earlier demo's recording is replaced

  bool is_face() const noexcept { return what == "face"; }
  bool is_space() const noexcept { return what == "space"; }
};

/// A device on a pseudo-terminal, which answers the driver as the real one's electronics would.
struct DemoDevice {
  std::unique_ptr<emulator::DeviceEmulator> unit;
  std::unique_ptr<emulator::ServedEmulator> server;
};

Result<DemoDevice> serve(const emulator::EmulatorOptions& options) {
  auto unit = emulator::DeviceEmulator::open(options);
  if (!unit) return unit.error();
  DemoDevice device{*std::move(unit), nullptr};
  device.server = std::make_unique<emulator::ServedEmulator>(*device.unit);
  return device;
}

Result<DemoDevice> emulate_glove(Side side, const Options& demo) {
  emulator::EmulatorOptions options;
  options.side = side;
  options.sensors = 22;
  options.rate_hz = rate_hz;
  options.seed = 7;
  if (demo.is_face()) options.motion = "faces";
  if (demo.is_space()) options.motion = "rest";
  return serve(options);
}

/// A FASTRAK with a receiver on each wrist, whose wearer walks round the model.
Result<DemoDevice> emulate_tracker() {
  emulator::EmulatorOptions options;
  options.device = "fastrak";
  options.motion = "walk";
  options.tracker.stations = {1, 2};
  options.tracker.noise = true;
  return serve(options);
}

/// An expression of the motion "faces", and a moment at which both hands hold it.
struct Expression {
  const char* caption;
  double time_s; ///< since the gloves' first samples
};
constexpr std::array expressions{Expression{"at rest", 1.0}, Expression{"smile", 2.24},
                                 Expression{"frown", 3.84},  Expression{"surprise", 5.44},
                                 Expression{"wink", 7.04},   Expression{"pout", 8.64}};
constexpr double min_strip_s = 4.5; ///< from here on, there are expressions to show

/// Whether the picture shows the face's expressions. Otherwise it shows the model before and after.
bool makes_strip(const Options& options) {
  return options.is_face() && options.duration_s >= min_strip_s;
}

std::string beside(const std::string& out, const char* ending) {
  return std::filesystem::path(out).replace_extension(ending).string();
}

/// A ball that is large enough to walk round. Fingertips in type 2 push it inwards along their
/// paths.
void set_space(session::RunOptions& run) {
  const flow::Mode mode = run.loop.sculptor.mode;
  if (mode == flow::Mode::clay) {
    run.model_size_m = sculpting::usual_size_m(mode);
    return;
  }
  run.model_size_m = 0.6;
  run.radius = "6cm";
  if (mode != flow::Mode::type2) return;
  flow::LoopSettings settings = flow::plain_settings_of(run.loop.sculptor);
  settings.brushes.fill(deform::Brush::push);
  flow::set_plain_settings(run.loop.sculptor, settings);
}

Result<session::RunOptions> run_options(const Options& options) {
  const auto mode = flow::mode_named(options.mode);
  const bool is_clay_in_space = options.is_space() && mode == flow::Mode::clay;
  if (!mode || (flow::is_by_hands(*mode) && !is_clay_in_space))
    return Error{Errc::usage, "--mode " + options.mode +
                                  ": use type1 or type2, or with the demo space also clay; `nendo "
                                  "demo clay` has its own mode"};
  if (auto fine = cli::check_duration(options.duration_s, cli::End::needed); !fine)
    return fine.error();
  if (options.duration_s > max_s) return Error{Errc::usage, "--duration: use at most 1h"};
  constexpr std::array<std::string_view, 4> demos{"face", "moai", "space", "clay"};
  if (std::find(demos.begin(), demos.end(), options.what) == demos.end())
    return Error{Errc::usage, options.what + ": no such demo; use face, moai, space or clay"};
  if (auto fine = cli::check_place("--record", options.record); !fine) return fine.error();
  if (auto fine = cli::check_place("--out", options.out, deform::mesh_endings); !fine)
    return fine.error();
  if (auto fine = cli::check_place("--picture", options.picture, {".png"}); !fine)
    return fine.error();
  session::RunOptions run;
  run.mesh = cli::shipped_model(options.is_space() ? "clay.ply" : options.what + ".obj").string();
  run.out = options.out;
  if (!makes_strip(options)) run.picture = options.picture;
  run.duration_s = options.duration_s;
  run.calibration.calibration = "none"; // what is stored is a real hand's
  run.loop.rate_hz = rate_hz;
  run.loop.sculptor.mode = *mode;
  if (options.is_space()) set_space(run);
  run.recording.file = options.record;
  if (options.record.empty() && options.what != "clay") { // which records nothing
    run.recording.file = beside(options.out, ".nendo");
    std::error_code ignored; // if it stays, the recording's own check says so
    std::filesystem::remove(run.recording.file, ignored);
  }
  if (auto fine = run.recording.check(run.out, run.loop.switch_action); !fine) return fine.error();
  if (!options.is_face()) {
    if (!options.is_space()) run.loop.sculptor.deformer.injective.emplace();
    return run;
  }
  run.puppet_file = cli::shipped_model("face.puppet.toml").string();
  auto puppet = puppet::read_puppet(run.puppet_file);
  if (!puppet) return puppet.error();
  run.puppet = *std::move(puppet);
  return run;
}

/// Draws the face's expressions of a recording on one sheet.
Result<void> draw_strip(const Options& options, const std::string& recording,
                        const takes::Take& take) {
  picture_command::PictureOptions picture;
  picture.file = recording;
  picture.out = options.picture;
  picture.view = "5,4";
  picture.size = "520x420";
  picture.by_glove_time = true;
  for (const auto& [caption, time_s] : expressions) {
    // The gloves began before the recording: on a busy machine, by seconds.
    const double recorded_s = time_s + take.first_sample_s;
    if (!(recorded_s >= 0.0 && recorded_s <= take.duration_s)) continue;
    picture.times += (picture.times.empty() ? "" : ",") + std::to_string(time_s);
    picture.captions += (picture.captions.empty() ? "" : ",") + std::string(caption);
  }
  if (picture.times.empty()) picture.strip = 2;
  return picture_command::draw_picture(picture, take);
}

/// Exports a recording as an animation for Blender.
Result<void> animate(const takes::Take& take, const std::string& out) {
  const auto source = take.open();
  if (!source) return source.error();
  exporting::GltfOptions gltf;
  gltf.generator = "Nendo " NENDO_VERSION;
  exporting::Choice choice;
  choice.rate_hz = exporting::animators_rate_hz;
  const auto done = exporting::export_gltf(**source, choice, gltf, out);
  if (!done) return done.error();
  return {};
}

/// Makes pictures and the animation, and says where everything is.
Result<void> show(const Options& options, const session::RunOptions& run) {
  const auto take = takes::read_take(run.recording.file);
  if (!take) return take.error();
  if (makes_strip(options))
    if (auto drawn = draw_strip(options, run.recording.file, *take); !drawn) return drawn;
  const std::string animation = beside(options.out, ".glb");
  if (auto done = animate(*take, animation); !done) return done;
  std::cout << (makes_strip(options) ? "\nPicture of six expressions: "
                                     : "\nPicture of the model before and after: ")
            << options.picture << "\nAnimation, for Blender: " << animation
            << "\nLast shape, for any 3-D viewer: " << options.out
            << "\nRecording: " << run.recording.file << '\n';
  return {};
}

/// Opens the hands, runs the session, and prints its summary.
Result<void> run_hands(session::RunOptions& run, deform::Mesh model) {
  EventCount event_count;
  auto opened = session::open_hands(run, model, event_count);
  if (!opened) return opened.error();
  for (auto& hand : opened->hands) // the default calibration is right for emulated hands
    hand.uncalibrated = false;
  const auto outcome = session::run_and_report(run, *opened, std::move(model), {}, {}, {});
  return outcome ? Result<void>() : outcome.error();
}

struct Work {
  const char* glove; ///< the glove on each hand
  const char* name;  ///< the shape's name in the name of its file
  const char* caption;
  double duration_s;
};
constexpr std::array works{Work{"sim:press", "cake", "Pressed by two palms: a flat cake", 10.4},
                           Work{"sim:knead", "bowl", "Thumbed: a bowl", 15.8},
                           Work{"sim:grip", "ears", "Pinched and pulled: two ears", 5.4}};
constexpr render::View view{-165.0, 24.0}; // both ears are seen from there
constexpr render::Size panel_size{460, 400};

std::string named(const std::string& out, const char* name) {
  const std::filesystem::path path(out);
  return (path.parent_path() / path.stem()).string() + "-" + name + path.extension().string();
}

/// Runs one session and returns the final shape.
Result<deform::Mesh> shape_of(const Work& work, const std::string& out) {
  session::RunOptions run;
  run.mesh = cli::shipped_model("clay.ply").string();
  run.left = run.right = work.glove;
  run.out = named(out, work.name);
  run.duration_s = work.duration_s;
  run.model_size_m = sculpting::usual_size_m(flow::Mode::clay);
  run.calibration.calibration = "none"; // what is stored is a real hand's
  run.loop.rate_hz = rate_hz;
  run.loop.sculptor.mode = flow::Mode::clay;
  if (auto fine = run.recording.check(run.out, run.loop.switch_action); !fine) return fine.error();
  auto model = takes::read_model(run.mesh);
  if (!model) return model.error();
  std::cout << work.glove << " for " << work.duration_s << " s\n" << std::flush;
  if (auto done = run_hands(run, std::move(model->mesh)); !done) return done.error();
  return deform::read_mesh(run.out);
}

render::Panel panel_of(const deform::Mesh& shape, const char* caption) {
  using namespace nendo::render;
  SceneFrame frame;
  frame.vertices = shape.vertices;
  Scene scene;
  SceneBuilder(shape, 1.0).build(frame, {}, scene); // the ball's units are metres
  const Camera camera = framing(scene.outline(), view, 1.0 * panel_size.width / panel_size.height);
  return {draw(Lighting(scene, view.azimuth_deg), camera, panel_size), caption};
}

/// Runs the sessions one after another, and draws their shapes on one sheet. Each shape's file gets
/// its name before the ending, e.g. NAME-bowl.ply.
Result<void> demonstrate_clay(const std::string& out, const std::string& picture) {
  cli::install_stop_signals();
  std::vector<render::Panel> panels;
  for (const Work& work : works) {
    if (cli::stop_requested()) break;
    const auto shape = shape_of(work, out);
    if (!shape) return shape.error();
    panels.push_back(panel_of(*shape, work.caption));
  }
  const auto sheet = render::contact_sheet(panels, static_cast<int>(panels.size()));
  if (auto drawn = render::write_png(picture, sheet); !drawn) return drawn;
  std::cout << "\nPicture: " << picture << "\nShapes, for any 3-D viewer: ";
  for (std::size_t at = 0; at < panels.size(); ++at)
    std::cout << (at > 0 ? ", " : "") << named(out, works[at].name);
  std::cout << '\n';
  return {};
}

void set_wrists(const std::string& tty, session::RunOptions& run) {
  for (const Side side : {Side::left, Side::right})
    run.wrists.trackers[flow::Placement::index_of(side)] =
        "fastrak:" + tty + "?station=" + (side == Side::left ? "1" : "2");
  // The emulated wearer walks on a circle of 0.3 m; the hands begin nearer to the model's middle.
  run.wrists.movement_scale = run.loop.sculptor.mode == flow::Mode::clay ? 0.4 : 1.0;
}

const char* in_words(const Options& options) {
  if (options.is_face()) return "Ten fingers play a face";
  return options.is_space() ? "Both hands walk round the model and shape it"
                            : "Both hands shape the Moai";
}

Result<void> demonstrate(const Options& options) {
  auto run = run_options(options);
  if (!run) return run.error();
  if (options.what == "clay") return demonstrate_clay(options.out, options.picture);
  auto model = takes::read_model(run->mesh);
  if (!model) return model.error();
  cli::install_stop_signals();
  const auto left = emulate_glove(Side::left, options);
  if (!left) return left.error();
  const auto right = emulate_glove(Side::right, options);
  if (!right) return right.error();
  run->left = "serial:" + left->unit->tty_path();
  run->right = "serial:" + right->unit->tty_path();
  std::cout << "Two emulated CyberGloves stream at " << left->unit->tty_path() << " and "
            << right->unit->tty_path() << ". ";
  DemoDevice tracker;
  if (options.is_space()) {
    auto emulated = emulate_tracker();
    if (!emulated) return emulated.error();
    tracker = *std::move(emulated);
    set_wrists(tracker.unit->tty_path(), *run);
    std::cout << "An emulated FASTRAK has a station for each wrist at " << tracker.unit->tty_path()
              << ". ";
  }
  std::cout << in_words(options) << " for " << run->duration_s << " s.\n" << std::flush;
  if (auto done = run_hands(*run, std::move(model->mesh)); !done) return done;
  return show(options, *run);
}

} // namespace
} // namespace nendo::app::demo_command

void nendo::app::add_demo(cli::Command& program) {
  using namespace demo_command;
  cli::Command command = program.add_command(
      "demo",
      "Two emulated CyberGloves play a face, or shape a Moai, through the real driver, also "
      "with a tracker on each wrist, or simulated hands knead clay; writes a picture, a "
      "recording and an animation");
  Options& options = command.on_chosen<Options>(demonstrate);
  command.add_option(
      "DEMO", options.what,
      "face: ten fingers animate it; moai: hands shape it; space: hands with an emulated FASTRAK "
      "walk round it; clay: whole hands make a cake, a bowl and ears, in about 30 s, for which "
      "only "
      "--out and --picture apply");
  command.add_option("--mode", options.mode,
                     "type1 (from rest): the rest shape follows the fingertips; type2 "
                     "(accumulating): strokes; clay, "
                     "with the demo space: whole hands press");
  command.add_duration("--duration", options.duration_s, "How long, e.g. 30s or 2m, up to 1h");
  command.add_option("--out", options.out, "Where the shape goes, .obj, .ply or .stl");
  command.add_option("--picture", options.picture, "Where the picture goes, .png");
  command.add_option(
      "--record", options.record,
      "Where the recording goes; without it, beside --out, replacing that of an earlier demo");
}
