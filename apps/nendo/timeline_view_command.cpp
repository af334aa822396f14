// nendo edit view: a timeline in the studio's window.

#include <memory>
#include <optional>
#include <string>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "commands/commands.hpp"
#include "edit/edit_actions.hpp"
#include "nendo/commands.hpp"
#include "nendo/run_in_studio.hpp"
#include "timeline/edit.hpp"

namespace nendo::app::timeline_view_command {
namespace {

struct Options {
  std::string file;
  std::string mesh; ///< empty: the timeline's
  std::string out;  ///< where it is saved; empty: into the file
  std::string hand; ///< side of the first selected key
  std::optional<unsigned> key;
  std::optional<double> at_s;
  session::ViewOptions view;
};

Result<void> check(const Options& options) {
  if (options.key && options.hand.empty())
    return Error{Errc::usage, "--key: say whose with --hand left or --hand right"};
  if (!options.hand.empty() && !options.key)
    return Error{Errc::usage, "--hand: is for --key; give both"};
  return cli::check_place("--screenshot", options.view.screenshot, {".png"});
}

/// Sets the first position of the play head, and the selection.
Result<void> begin_at(const Options& options, studio::FirstTimeline& first) {
  const timeline::Timeline& timeline = first.frames->player().timeline();
  if (options.key) {
    const auto side = edit::parse_hand(options.hand);
    if (!side) return side.error();
    first.key = timeline::KeyRef{*side, *options.key};
    if (timeline::find_key(timeline, *first.key) == nullptr)
      return Error{Errc::usage, "--hand, --key: the " + options.hand + " hand has no key " +
                                    std::to_string(*options.key) +
                                    "; `nendo edit show` lists them"};
  }
  if (options.at_s && !(*options.at_s >= 0.0 && *options.at_s <= timeline.duration_s))
    return Error{Errc::usage, "--at: the timeline lasts from 0 to " +
                                  std::to_string(timeline.duration_s) + " s"};
  first.at_s = options.at_s;
  return {};
}

Result<int> view_timeline(const Options& options) {
  const auto out = edit::edited_file(options.file, options.out);
  if (!out) return out.error();
  if (const auto fine = check(options); !fine) return fine.error();
  auto frames = takes::TimelineFrames::open(options.file, options.mesh);
  if (!frames) return frames.error();
  studio::FirstTimeline first{options.file, *out, *std::move(frames)};
  if (const auto begun = begin_at(options, first); !begun) return begun.error();
  cli::install_stop_signals();
  run_command::RunArguments arguments;
  arguments.view = options.view;
  arguments.view.window = true;
  return run_command::run_in_studio(arguments, first);
}

} // namespace
} // namespace nendo::app::timeline_view_command

void nendo::app::add_timeline_view(cli::Command& edit) {
  using namespace timeline_view_command;
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
  command.add_option("--theme", options->view.theme, "The window's colours")
      .one_of({"light", "dark"});
  command.add_option("--screenshot", options->view.screenshot,
                     "Where the window's last picture goes, .png");
  command.add_option(
      "--frames", options->view.frames,
      "The window's pictures, once all shapes are made, after which it ends; 0: when "
      "it is closed");
  command.on_chosen([options] {
    const auto code = view_timeline(*options);
    return code ? *code : cli::report(code.error());
  });
}
