// nendo edit: makes, changes and plays key poses of a recorded run.

#include <cstdio>
#include <functional>
#include <limits>
#include <memory>

#include "cli/cli.hpp"
#include "cli/figures.hpp"
#include "edit/edit_actions.hpp"
#include "nendo/commands.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/edit.hpp"
#include "timeline/timeline.hpp"

namespace nendo::app::edit_command {
namespace {

using timeline::Timeline;

struct Options {
  edit::MakeOptions make;
  edit::ShowOptions show;
  edit::PlayOptions play;
  std::string file;
  std::string out;
  std::string hand;
  std::string finger;
  std::string function;
  double value = 0.0;
  std::string place;
  std::string with;
  std::string mesh; ///< the model, for mirror
  std::uint32_t key = 0;
  std::optional<unsigned> blended_key;
  double time_s = 0.0;
  double from_s = 0.0;
  std::optional<double> to_s;
  double scale = 1.0;
  double factor = 0.5;
  double within_mm = 1.0;
  std::optional<double> plane;
};

using Change = std::function<Result<void>(Timeline& timeline)>;

// Reads the file, changes what is in it and writes it back, or to --out.
int edit(const Options& options, const Change& change) {
  const auto out = edit::edited_file(options.file, options.out);
  if (!out) return cli::report(out.error());
  auto timeline = timeline::read_timeline(options.file);
  if (!timeline) return cli::report(timeline.error());
  if (const auto changed = change(*timeline); !changed)
    return cli::report({changed.error().code, options.file + ": " + changed.error().message});
  if (const auto written = timeline::write_timeline(*out, *timeline); !written)
    return cli::report(written.error());
  std::printf("%s: %zu keys, %.3f s\n", out->c_str(), timeline->key_count(), timeline->duration_s);
  std::fflush(stdout);
  return 0;
}

// Does the same with a change of one hand.
int edit_hand(const Options& options,
              const std::function<Result<void>(Timeline& timeline, Side side)>& change) {
  const auto side = edit::parse_hand(options.hand);
  if (!side) return cli::report(side.error());
  return edit(options, [&](Timeline& timeline) { return change(timeline, *side); });
}

/// Returns the time of a key that is wanted at --to or --at, and reports it if it is another one.
double time_for_key(const Timeline& timeline, Side side, double wanted_s,
                    std::optional<std::size_t> moved = {}) {
  const double time_s = timeline::time_near_end(timeline, side, wanted_s, moved);
  if (time_s != wanted_s)
    cli::note(cli::fixed(wanted_s, 3) + " s is after the end, which is at " +
              cli::fixed(timeline.duration_s, 3) + " s; the key is at " + cli::fixed(time_s, 3) +
              " s");
  return time_s;
}

int blend(const Options& options) {
  if (options.with.empty() == !options.blended_key)
    return cli::report({Errc::usage,
                        "--with, --key: give one of them: another timeline, or, with --hand, a "
                        "key to blend with its neighbours"});
  if (options.blended_key)
    return edit_hand(options, [&](Timeline& timeline, Side side) {
      return timeline::blend_key(timeline, side, *options.blended_key, options.factor);
    });
  const auto other = timeline::read_timeline(options.with);
  if (!other) return cli::report(other.error());
  return edit(options, [&](Timeline& timeline) {
    return timeline::blend(timeline, *other, options.factor);
  });
}

int mirror(const Options& options) {
  return edit(options, [&](Timeline& timeline) -> Result<void> {
    if (options.plane) return timeline::mirror(timeline, *options.plane / timeline.units_per_metre);
    const auto model = takes::timeline_model(timeline, options.mesh);
    if (!model) return model.error();
    return timeline::mirror(timeline, takes::middle_plane_m(timeline, model->mesh));
  });
}

int set_tip(const Options& options) {
  const auto finger = edit::parse_finger(options.finger);
  if (!finger) return cli::report(finger.error());
  const auto place = edit::parse_place(options.place);
  if (!place) return cli::report(place.error());
  if (!(options.within_mm > 0.0))
    return cli::report({Errc::usage, "--within: use millimetres above 0"});
  timeline::TipSet done;
  const int code = edit_hand(options, [&](Timeline& timeline, Side side) -> Result<void> {
    const Eigen::Vector3d target_m = *place / timeline.units_per_metre;
    const auto set = timeline::set_tip(timeline, side, options.key, *finger, target_m,
                                       options.within_mm / 1000.0);
    if (!set) return set.error();
    done = *set;
    return {};
  });
  if (code == 0)
    std::printf("the %s's tip is %.3f mm from its target\n", options.finger.c_str(),
                1e3 * done.off_m);
  return code;
}

int set_value(const Options& options) {
  timeline::ValueSet done;
  const int code = edit(options, [&](Timeline& timeline) -> Result<void> {
    const auto set = timeline::set_value(timeline, options.function, options.key, options.value);
    if (!set) return set.error();
    done = *set;
    return {};
  });
  if (code == 0)
    std::printf("%s is %.3f at key %zu of the %s hand\n", options.function.c_str(), done.value,
                done.key.key, std::string(name_of(done.key.side)).c_str());
  return code;
}

// Adds a command with the options that all edits have.
cli::Command add_edit_of(cli::Command& edit, const char* name, const char* summary,
                         const std::shared_ptr<Options>& options) {
  cli::Command command = edit.add_command(name, summary);
  command.add_option("FILE", options->file, "A timeline").required();
  command.add_option("--out", options->out,
                     "Where to write the changed timeline, .timeline.toml; without it, FILE");
  return command;
}

cli::Command add_edit_of_key(cli::Command& edit, const char* name, const char* summary,
                             const std::shared_ptr<Options>& options) {
  cli::Command command = add_edit_of(edit, name, summary, options);
  command.add_option("--hand", options->hand, "left or right").required();
  command.add_option("--key", options->key, "Number of the key, as in `nendo edit show`")
      .required();
  return command;
}

void add_reading(cli::Command& edit, const std::shared_ptr<Options>& options) {
  cli::Command making = edit.add_command("make", "Makes a timeline of key poses of a recorded run");
  making.add_option("TAKE", options->make.take, "A recording of `nendo run --record`").required();
  making.add_option("--out", options->make.out, "The new file, .timeline.toml").required();
  making.add_option("--tolerance", options->make.tolerance,
                    "Max error of the hands between the keys: at the fingertips, as 1mm, or at the "
                    "joints, as 0.02rad or 1deg; 0mm keeps every frame");
  making.add_option("--mesh", options->make.mesh, "The model, if it has been moved");
  making.add_flag("--json", options->make.json, "A summary as JSON");
  making.on_chosen([options] { return edit::make_timeline(options->make); });

  cli::Command showing =
      edit.add_command("show", "Shows the keys as a table, and the commands for the model");
  showing.add_option("FILE", options->show.file, "A timeline").required();
  showing.add_option("--finger", options->show.finger,
                     "Also show the position of this finger's tip");
  showing.add_flag("--functions", options->show.functions,
                   "Show the values of the puppet's functions at the keys in place of the hands");
  showing.add_flag("--json", options->show.json, "Everything about each key, as one JSON object");
  showing.on_chosen([options] { return edit::show_timeline(options->show); });

  cli::Command playing = edit.add_command("play", "Plays a timeline and writes its shape");
  playing.add_option("FILE", options->play.file, "A timeline").required();
  playing.add_duration("--until", options->play.until_s,
                       "Seconds at which it stops; without it, the end");
  playing.add_option("--mesh", options->play.mesh, "A model in place of the timeline's");
  playing.add_option("--out", options->play.out, "Where to write the shape, .obj, .ply or .stl");
  playing.add_flag("--json", options->play.json, "A summary as JSON");
  playing.add_option("--speed", options->play.speed,
                     "Speed relative to real time; 0: as fast as possible");
  playing.on_chosen([options] { return edit::play_timeline(options->play); });
}

void add_key_edits(cli::Command& edit, const std::shared_ptr<Options>& options) {
  cli::Command moving = add_edit_of_key(edit, "move", "Moves a key to another time", options);
  moving.add_duration("--to", options->time_s, "Seconds").required();
  moving.on_chosen([options] {
    return edit_hand(*options, [&](Timeline& timeline, Side side) {
      return timeline::move_key(timeline, side, options->key,
                                time_for_key(timeline, side, options->time_s, options->key));
    });
  });
  cli::Command copying = add_edit_of_key(edit, "copy", "Copies a key to another time", options);
  copying.add_duration("--to", options->time_s, "Seconds").required();
  copying.on_chosen([options] {
    return edit_hand(*options, [&](Timeline& timeline, Side side) {
      return timeline::copy_key(timeline, side, options->key,
                                time_for_key(timeline, side, options->time_s));
    });
  });
  cli::Command deleting = add_edit_of_key(edit, "delete", "Deletes a key", options);
  deleting.on_chosen([options] {
    return edit_hand(*options, [&](Timeline& timeline, Side side) {
      return timeline::delete_key(timeline, side, options->key);
    });
  });
  cli::Command adding =
      add_edit_of(edit, "add", "Adds a key with the hand's pose at that time", options);
  adding.add_option("--hand", options->hand, "left or right").required();
  adding.add_duration("--at", options->time_s, "Seconds").required();
  adding.on_chosen([options] {
    return edit_hand(*options, [&](Timeline& timeline, Side side) {
      return timeline::add_key(timeline, side, time_for_key(timeline, side, options->time_s));
    });
  });
  cli::Command setting = add_edit_of_key(
      edit, "set-tip", "Bends a finger so that its tip reaches a position (inverse kinematics)",
      options);
  setting.add_option("--finger", options->finger, "thumb, index, middle, ring or little")
      .required();
  setting.add_option("--to", options->place, "X,Y,Z in the model's units").required();
  setting.add_millimetres("--within", options->within_mm, "Max distance from it, in millimetres");
  setting.on_chosen([options] { return set_tip(*options); });
  cli::Command setting_value = add_edit_of(
      edit, "set-value",
      "Bends the finger that plays a function of the puppet until it has a value", options);
  setting_value.add_option("--function", options->function, "Its name, such as jawOpen").required();
  setting_value.add_option("--key", options->key, "Number of the key of the hand that plays it")
      .required();
  setting_value.add_option("--to", options->value, "The value at that key").required();
  setting_value.on_chosen([options] { return set_value(*options); });
}

void add_whole_edits(cli::Command& edit_command, const std::shared_ptr<Options>& options) {
  cli::Command retiming =
      add_edit_of(edit_command, "retime", "Makes a timeline slower or faster", options);
  retiming.add_option("--scale", options->scale, "Factor of all times; 2: twice as long")
      .required();
  retiming.add_duration("--from", options->from_s, "Seconds at which that begins");
  retiming.add_duration("--to", options->to_s,
                        "Seconds at which it ends; everything after is moved");
  retiming.on_chosen([options] {
    return edit(*options, [&](Timeline& timeline) {
      return timeline::retime(timeline, options->scale, options->from_s,
                              options->to_s.value_or(std::numeric_limits<double>::infinity()));
    });
  });
  cli::Command blending = add_edit_of(
      edit_command, "blend", "Blends two timelines, or a key with its neighbours", options);
  blending.add_option("--with", options->with, "Another timeline");
  blending.add_option("--hand", options->hand, "left or right, for --key");
  blending.add_option("--key", options->blended_key, "Number of the key");
  blending.add_option("--factor", options->factor, "0 (unchanged) to 1 (as the others)");
  blending.on_chosen([options] { return blend(*options); });
  cli::Command mirroring = add_edit_of(
      edit_command, "mirror", "Exchanges the motions of the left and right hands", options);
  mirroring.add_option("--plane", options->plane,
                       "The mirror's x in the model's units; without it, the model's middle");
  mirroring.add_option("--mesh", options->mesh, "The model, if it has been moved");
  mirroring.on_chosen([options] { return mirror(*options); });
}

} // namespace
} // namespace nendo::app::edit_command

void nendo::app::add_edit(cli::Command& program) {
  using namespace edit_command;
  auto options = std::make_shared<Options>();
  cli::Command command =
      program.add_command("edit", "Key poses of a recorded run: make, change, play");
  command.require_command();
  add_reading(command, options);
  add_timeline_view(command);
  add_key_edits(command, options);
  add_whole_edits(command, options);
}
