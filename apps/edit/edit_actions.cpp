// nendo edit make, play and view, and the arguments of all the commands.
#include "edit/edit_actions.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/take_reader.hpp>

#include "cli/cli.hpp"
#include "cli/command.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "commands/commands.hpp"
#include "edit/edit_session.hpp"
#include "takes/model_files.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/reduce.hpp"
#include "timeline/timeline.hpp"
#include "viewer/timeline_window.hpp"

namespace nendo::edit {
namespace {

// Cuts a finite number off the front.
bool cut_number(std::string_view& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

void print_json(const MakeOptions& options, const timeline::MadeTimeline& made) {
  nlohmann::ordered_json line{{"event", "made"},
                              {"result", options.out},
                              {"duration_s", made.timeline.duration_s},
                              {"events", made.timeline.events.size()},
                              {"model_notes", cli::model_notes()},
                              {"exact", made.exact}};
  for (std::size_t at = 0; at < made.hands.size(); ++at) {
    const auto& hand = made.timeline.hands[at];
    const auto& reduction = made.hands[at];
    line[std::string(name_of(hand.side))] = {{"frames", reduction.frames},
                                             {"keys", hand.keys.size()},
                                             {"max_angle_rad", reduction.worst.angle_rad},
                                             {"max_tip_mm", 1e3 * reduction.worst.tip_m}};
    if (made.timeline.rig)
      line[std::string(name_of(hand.side))]["max_point_mm"] = 1e3 * reduction.worst.point_m;
  }
  cli::print_line(line);
}

void print(const MakeOptions& options, const timeline::MadeTimeline& made) {
  std::printf("%s: %.2f s, %zu events\n", options.out.c_str(), made.timeline.duration_s,
              made.timeline.events.size());
  for (std::size_t at = 0; at < made.hands.size(); ++at) {
    const auto& hand = made.timeline.hands[at];
    const auto& reduction = made.hands[at];
    std::printf("  %-6s %zu keys of %zu frames; off by at most %.3f mm at a fingertip, %.4f rad at "
                "a joint",
                std::string(name_of(hand.side)).c_str(), hand.keys.size(), reduction.frames,
                1e3 * reduction.worst.tip_m, reduction.worst.angle_rad);
    if (made.timeline.rig)
      std::printf(", %.3f mm at a point of the puppet", 1e3 * reduction.worst.point_m);
    std::printf("\n");
  }
  std::fflush(stdout);
}

constexpr double max_speed = 1000.0;

// The moment at which so much was played; in short sleeps, so that a signal ends it soon.
void wait_for(double time_s, double speed, HostTime start) {
  if (speed == 0.0) return;
  constexpr double nap_s = 0.05;
  while (!cli::stop_requested()) {
    const double left_s = time_s / speed - to_seconds(HostClock::now() - start);
    if (left_s <= 0.0) return;
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left_s, nap_s)));
  }
}

struct Options {
  std::string file;
  std::string mesh; ///< empty: the timeline's
  std::string out;  ///< where it is saved; empty: into the file
  std::string hand; ///< side of the first selected key
  std::optional<unsigned> key;
  std::optional<double> at_s;
  std::string theme{"light"}; ///< or dark
  std::string screenshot;     ///< where the last picture goes, .png; empty: nowhere
  std::uint32_t frames = 0;   ///< pictures after which it ends; 0: as the person likes
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
      "Nendo: " + std::filesystem::path(*out).filename().string(),
      {window_size, options.theme == "dark" ? viewer::Theme::dark : viewer::Theme::light},
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

Result<Side> parse_hand(const std::string& text) {
  if (const auto side = side_named(text)) return *side;
  return Error{Errc::usage, "--hand " + text + ": use left or right"};
}

Result<hand::Finger> parse_finger(const std::string& text) {
  for (std::size_t at = 0; at < hand::finger_count; ++at)
    if (const auto finger = static_cast<hand::Finger>(at); name_of(finger) == text) return finger;
  return Error{Errc::usage, "--finger " + text + ": use thumb, index, middle, ring or little"};
}

Result<Eigen::Vector3d> parse_place(const std::string& text) {
  std::string_view rest = text;
  Eigen::Vector3d place;
  bool fine = true;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis > 0) {
      fine = fine && rest.starts_with(',');
      if (fine) rest.remove_prefix(1);
    }
    fine = fine && cut_number(rest, place[axis]);
  }
  if (fine && rest.empty()) return place;
  return Error{Errc::usage, "--to " + text + ": use X,Y,Z in the model's units"};
}

Result<std::string> edited_file(const std::string& file, const std::string& out) {
  if (!out.empty()) {
    if (const auto fine = cli::check_place("--out", out, {timeline::file_ending}); !fine)
      return fine.error();
    return out;
  }
  if (timeline::is_timeline(file)) return file;
  return Error{Errc::usage, file + ": a timeline's name ends in .timeline.toml"};
}

Result<timeline::Tolerance> parse_tolerance(const std::string& text) {
  std::string_view rest = text;
  double value = 0.0;
  timeline::Tolerance tolerance;
  const auto length_m = to_metres(text);
  const bool fine = cut_number(rest, value) && value >= 0.0;
  if (fine && length_m) {
    tolerance.tip_m = tolerance.point_m = *length_m;
  } else if (fine && rest == "rad") {
    tolerance.angle_rad = value;
  } else if (fine && rest == "deg") {
    tolerance.angle_rad = from_degrees(value);
  } else {
    return Error{Errc::usage, "--tolerance " + text +
                                  ": use a length at the fingertips, like 1mm, or an angle at the "
                                  "joints, like 0.02rad or 1deg"};
  }
  return tolerance;
}

int make_timeline(const MakeOptions& options) {
  const auto tolerance = parse_tolerance(options.tolerance);
  if (!tolerance) return cli::report(tolerance.error());
  if (const auto fine = cli::check_place("--out", options.out, {timeline::file_ending}); !fine)
    return cli::report(fine.error());
  const auto reader = recording::TakeReader::open(options.take);
  if (!reader) return cli::report(reader.error());
  const auto model = takes::recorded_model(options.take, reader->setup(), options.mesh);
  if (!model) return cli::report(model.error());
  auto made = timeline::timeline_of_take(options.take, model->mesh, *tolerance);
  if (!made) return cli::report(made.error());
  if (!options.mesh.empty()) {
    made->timeline.mesh = std::filesystem::absolute(options.mesh).string();
    made->timeline.mesh_sum = recording::sum_of(model->mesh.vertices);
  }
  if (const auto written = timeline::write_timeline(options.out, made->timeline); !written)
    return cli::report(written.error());
  if (!made->exact) takes::note_missing(options.take);
  if (made->has_last_puppet)
    cli::note(options.take + ": the puppet was edited in it; the timeline plays all of it with the "
                             "last one");
  if (options.json)
    print_json(options, *made);
  else
    print(options, *made);
  return 0;
}

int play_timeline(const PlayOptions& options) {
  if (const auto fine = cli::check_place("--out", options.out, deform::mesh_endings); !fine)
    return cli::report(fine.error());
  if (!(options.speed >= 0.0 && options.speed <= max_speed))
    return cli::report({Errc::usage, "--speed: use 0 to 1000 times real time"});
  auto frames = takes::TimelineFrames::open(options.file, options.mesh);
  if (!frames) return cli::report(frames.error());
  const double until_s = options.until_s.value_or((*frames)->duration_s());
  if (!(until_s >= 0.0 && until_s <= (*frames)->duration_s()))
    return cli::report({Errc::usage, "--until: the timeline lasts from 0 to " +
                                         std::to_string((*frames)->duration_s()) + " s"});
  cli::install_stop_signals();
  const HostTime start = HostClock::now();
  const timeline::Player& player = (*frames)->player();
  while (player.has_frame_by(until_s)) {
    if (cli::stop_requested())
      return cli::report(
          {Errc::failed, options.file + ": stopped before the end; nothing was written"});
    (*frames)->next();
    wait_for((*frames)->time_s(), options.speed, start);
  }
  deform::Mesh shape = (*frames)->model((*frames)->frame().model);
  shape.vertices = (*frames)->player().final_shape();
  if (!options.out.empty())
    if (const auto written = takes::write_model(options.out, shape, (*frames)->up()); !written)
      return cli::report(written.error());
  const auto& stats = (*frames)->player().stats();
  const auto sum = recording::sum_of(shape.vertices);
  const double elapsed_s = to_seconds(HostClock::now() - start);
  if (options.json) {
    const nlohmann::ordered_json line{{"event", "played"},
                                      {"frames", stats.ticks},
                                      {"time_s", (*frames)->time_s()},
                                      {"elapsed_s", elapsed_s},
                                      {"failed", stats.failed},
                                      {"grabs", stats.grabs},
                                      {"commits", stats.commits},
                                      {"undos", stats.undos},
                                      {"redos", stats.redos},
                                      {"vertices", sum.vertices},
                                      {"crc32c", sum.crc},
                                      {"result", options.out},
                                      {"model_notes", cli::model_notes()}};
    cli::print_line(line);
    return 0;
  }
  std::printf("played %llu frames to %.3f s in %.2f s; %llu commits, %llu undone, %llu redone\n",
              static_cast<unsigned long long>(stats.ticks), (*frames)->time_s(), elapsed_s,
              static_cast<unsigned long long>(stats.commits),
              static_cast<unsigned long long>(stats.undos),
              static_cast<unsigned long long>(stats.redos));
  std::fflush(stdout);
  return 0;
}

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
  command.add_option("--theme", options->theme, "The window's colours").one_of({"light", "dark"});
  command.add_option("--screenshot", options->screenshot,
                     "Where the window's last picture goes, .png");
  command.add_option(
      "--frames", options->frames,
      "The window's pictures, once all shapes are made, after which it ends; 0: when "
      "it is closed");
  command.on_chosen([options] { return view_timeline(*options); });
}

} // namespace nendo::edit
