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
#include "takes/model_files.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/reduce.hpp"
#include "timeline/timeline.hpp"

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

Result<TimelineOfTake> timeline_of_take(const MakeOptions& options) {
  const auto tolerance = parse_tolerance(options.tolerance);
  if (!tolerance) return tolerance.error();
  const auto reader = recording::TakeReader::open(options.take);
  if (!reader) return reader.error();
  recording::Setup setup = reader->setup();
  auto model = takes::recorded_model(options.take, setup, options.mesh);
  if (!model) return model.error();
  const std::string first =
      options.out.substr(0, options.out.size() - timeline::file_ending.size()) + ".first.ply";
  const auto is_midway = takes::begin_with_first_shape(first, setup, *model);
  if (!is_midway) return is_midway.error();
  auto made = timeline::timeline_of_take(options.take, setup, model->mesh, *tolerance);
  if (!made) return made.error();
  if (!options.mesh.empty() && !*is_midway) {
    made->timeline.mesh = std::filesystem::absolute(options.mesh).string();
    made->timeline.mesh_sum = recording::sum_of(model->mesh.vertices);
  }
  return TimelineOfTake{*std::move(made), std::move(model->mesh), *is_midway ? first : ""};
}

int make_timeline(const MakeOptions& options) {
  if (const auto fine = cli::check_place("--out", options.out, {timeline::file_ending}); !fine)
    return cli::report(fine.error());
  const auto of_take = timeline_of_take(options);
  if (!of_take) return cli::report(of_take.error());
  const timeline::MadeTimeline* const made = &of_take->made;
  if (const auto written = timeline::write_timeline(options.out, made->timeline); !written)
    return cli::report(written.error());
  if (!of_take->first_shape.empty())
    cli::note(options.take + ": begins in the middle of a run; the shape of that moment is in " +
              of_take->first_shape + ", which is the timeline's model");
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

} // namespace nendo::edit
