// nendo edit view: a timeline in a window.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cli/cli.hpp"
#include "cli/command.hpp"
#include "cli/output_place.hpp"
#include "commands/commands.hpp"
#include "edit/edit_actions.hpp"
#include "edit/edit_session.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/timeline.hpp"
#include "viewer/timeline_window.hpp"

namespace nendo::edit {
namespace {

struct Options {
  std::string file;
  std::string mesh; ///< empty: the timeline's
  std::string out;  ///< where it is saved; empty: into the file
  std::string hand; ///< side of the first selected key
  std::optional<unsigned> key;
  std::optional<double> at_s;
  std::string screenshot;   ///< where the last picture goes, .png; empty: nowhere
  std::uint32_t frames = 0; ///< pictures after which it ends; 0: as the person likes
};

#ifdef NENDO_WINDOW

constexpr render::Size window_size{1180, 760};

Result<void> check(const Options& options) {
  if (options.key && options.hand.empty())
    return Error{Errc::usage, "--key: say whose with --hand left or --hand right"};
  if (!options.hand.empty() && !options.key)
    return Error{Errc::usage, "--hand: is for --key; give both"};
  return cli::check_place("--screenshot", options.screenshot, {".png"});
}

/// Sets the first position of the play head, and the selection.
Result<void> begin_at(const Options& options, EditSession& session) {
  const timeline::Timeline& timeline = session.history().timeline();
  if (options.key) {
    const auto side = parse_hand(options.hand);
    if (!side) return side.error();
    const timeline::KeyRef key{*side, *options.key};
    if (timeline::find_key(timeline, key) == nullptr)
      return Error{Errc::usage, "--hand, --key: the " + options.hand + " hand has no key " +
                                    std::to_string(key.key) + "; `nendo edit show` lists them"};
    session.select(key);
  }
  if (!options.at_s) return {};
  if (!(*options.at_s >= 0.0 && *options.at_s <= timeline.duration_s))
    return Error{Errc::usage, "--at: the timeline lasts from 0 to " +
                                  std::to_string(timeline.duration_s) + " s"};
  session.seek(*options.at_s);
  return {};
}

/// Until the user quits, or this number of pictures of a shape that is made were shown. The last
/// picture is written whatever ended it.
Result<void> edit_in(viewer::TimelineWindow& window, EditSession& session, const Options& options) {
  HostTime before = HostClock::now();
  std::uint32_t shown = 0;
  std::shared_ptr<const flow::ModelVersion> model; // that the window has
  const double units_per_metre = session.history().timeline().units_per_metre;
  do {
    const HostTime now = HostClock::now();
    session.advance(to_seconds(now - before));
    before = now;
    const auto found = session.shape();
    if (found.shape && found.shape->model != model) {
      model = found.shape->model;
      window.scene_window().set_model(model->layout(),
                                      render::SceneBuilder(model->mesh, units_per_metre));
    }
    if (found.shape) window.scene_window().follow(found.shape->shape);
    const viewer::TimelineView& view = session.view();
    const bool is_settled = found.fresh && !view.computing;
    session.handle(window.show(view, session.scene_frame()));
    if (const auto error = session.progress().error) return *error;
    if (is_settled) ++shown;
  } while (!session.has_ended() && !cli::stop_requested() &&
           (options.frames == 0 || shown < options.frames));
  if (options.screenshot.empty()) return {};
  return write_png(options.screenshot, window.scene_window().screenshot());
}

int view_timeline(const Options& options) {
  const auto out = edited_file(options.file, options.out);
  if (!out) return cli::report(out.error());
  if (const auto fine = check(options); !fine) return cli::report(fine.error());
  const auto frames = takes::TimelineFrames::open(options.file, options.mesh);
  if (!frames) return cli::report(frames.error());
  cli::install_stop_signals();
  const timeline::Timeline& timeline = (*frames)->player().timeline();
  const deform::Mesh& model = (*frames)->model(0);
  EditSession session(timeline, model, *out);
  if (const auto begun = begin_at(options, session); !begun) return cli::report(begun.error());
  auto window = viewer::TimelineWindow::open(
      "Nendo: " + std::filesystem::path(*out).filename().string(), window_size,
      "on a box without a screen `nendo picture` draws a timeline, `nendo export` animates it, and "
      "the other commands of `nendo edit` change it");
  if (!window) return cli::report(window.error());
  (*window)->scene_window().set_model((*frames)->layout(0),
                                      render::SceneBuilder(model, timeline.units_per_metre));
  const auto done = edit_in(**window, session, options);
  if (session.history().is_modified()) cli::note(*out + ": not saved; the changes are lost");
  return done ? 0 : cli::report(done.error());
}

#else

int view_timeline(const Options&) {
  return cli::report(
      {Errc::failed,
       "this nendo was built without a window; install libglfw3-dev, libimgui-dev and "
       "libgl-dev and build it again, or draw a timeline with `nendo picture`, animate "
       "it with `nendo export`, and change it with the other commands of `nendo edit`"});
}

#endif

} // namespace

void add_timeline_view(cli::Command& edit) {
  const auto options = std::make_shared<Options>();
  cli::Command command =
      edit.add_command("view", "All of this in a window, with the hands' keys on a strip");
  command.set_footer("Keys in the window:" +
                     commands::key_list(commands::in_timeline, "\n  key ", "\n      "));
  command.add_option("FILE", options->file, "A timeline").required();
  command.add_option("--mesh", options->mesh, "Another model than the timeline's");
  command.add_option("--out", options->out,
                     "Where it is saved, .timeline.toml; without it, into FILE");
  command.add_duration("--at", options->at_s, "First position of the play head, in seconds");
  command.add_option("--hand", options->hand, "left or right, for --key");
  command.add_option("--key", options->key, "Number of the key that is selected at first");
  command.add_option("--screenshot", options->screenshot,
                     "Where the window's last picture goes, .png");
  command.add_option(
      "--frames", options->frames,
      "The window's pictures, once all shapes are made, after which it ends; 0: when "
      "it is closed");
  command.on_chosen([options] { return view_timeline(*options); });
}

} // namespace nendo::edit
