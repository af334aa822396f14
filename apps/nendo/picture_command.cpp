// nendo picture: a PNG of a model, without a screen.
#include "nendo/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "cli/quantities.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"
#include "render/picture.hpp"
#include "takes/model_files.hpp"
#include "takes/take.hpp"

namespace nendo::app::picture_command {
namespace {

using namespace nendo::render;

using Options = PictureOptions;

constexpr std::uint32_t max_panels = 64;

struct Wanted {
  View view;
  Size size;
};

Error bad(const std::string& option, const std::string& what) {
  return {Errc::usage, option + ": " + what};
}

/// Returns the parts between commas; none if the text is empty.
std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts;
  for (std::string_view rest = text; !rest.empty();)
    parts.emplace_back(cut(rest, ','));
  return parts;
}

/// Returns how many pictures there will be.
Result<std::uint32_t> panels_of(const Options& options) {
  const std::array counts{
      std::pair{"--turntable", options.turntable}, std::pair{"--strip", options.strip},
      std::pair{"--key-poses", options.key_poses},
      std::pair{"--time", static_cast<std::uint32_t>(parts_of(options.times).size())}};
  std::uint32_t panels = 1;
  std::string_view by;
  for (const auto& [name, count] : counts) {
    if (count == 0) continue;
    if (!by.empty()) return bad("--turntable, --strip, --key-poses and --time", "give one of them");
    by = name;
    panels = count;
    const std::uint32_t min_panels = by == "--time" ? 1 : 2;
    if (count < min_panels || count > max_panels)
      return bad(name, "use " + std::to_string(min_panels) + " to " + std::to_string(max_panels) +
                           " pictures");
  }
  return panels;
}

Result<Wanted> check(const Options& options) {
  const auto view = view_named(options.view);
  if (!view)
    return bad("--camera " + options.view,
               "use front, back, left, right, side, top or AZIMUTH,ELEVATION in degrees");
  const auto size = size_named(options.size);
  if (!size) return bad("--pixels " + options.size, "use WIDTHxHEIGHT in pixels, 16 to 8192 each");
  const auto counted = panels_of(options);
  if (!counted) return counted.error();
  const std::uint32_t panels = *counted;
  if (!options.captions.empty() && parts_of(options.captions).size() != panels)
    return bad("--captions", "use one text per picture, separated by commas");
  if (options.columns > panels)
    return bad("--columns " + std::to_string(options.columns),
               "use at most as many as there are pictures");
  if (options.numbered && panels == 1)
    return bad("--numbered",
               "needs several pictures: --turntable, --strip, --key-poses or several times");
  const double pixels = 1.0 * size->width * size->height * panels;
  if (!options.numbered && pixels > 6e7)
    return bad("--pixels " + options.size,
               "too large for " + std::to_string(panels) +
                   " pictures on one sheet; use fewer pixels, or --numbered");
  if (options.colour != "model" && options.colour != "distance")
    return bad("--colour " + options.colour, "use model or distance");
  if (const auto fine = cli::check_place("--out", options.out, {".png"}); !fine)
    return fine.error();
  return Wanted{*view, *size};
}

std::string seconds_text(double time_s) {
  return fmt::format("{:.2f} s", time_s);
}

Result<std::vector<double>> key_poses_of(const Options& options, const takes::Take& take) {
  const auto frames = take.open();
  if (!frames) return frames.error();
  auto times = takes::key_poses(**frames, options.key_poses);
  if (times.size() < options.key_poses)
    return bad("--key-poses " + std::to_string(options.key_poses),
               "only " + std::to_string(times.size()) + " poses of " + options.file + " differ");
  return times;
}

Result<std::vector<double>> named_times_of(const Options& options, const takes::Take& take) {
  std::vector<double> times;
  for (const std::string& text : parts_of(options.times)) {
    const auto time = cli::seconds_of(text);
    if (!time) return bad("--time " + text, "use " + std::string(cli::duration_words));
    times.push_back(*time + (options.by_glove_time ? take.first_sample_s : 0.0));
    if (!(times.back() >= 0.0 && times.back() <= take.duration_s))
      return bad(
          "--time " + text,
          "use a time of " + options.file + ", which lasts from " +
              seconds_text(options.by_glove_time ? -take.first_sample_s : 0.0) + " to " +
              seconds_text(take.duration_s - (options.by_glove_time ? take.first_sample_s : 0.0)));
  }
  return times;
}

// Returns the times of the take that are asked for.
Result<std::vector<double>> times_of(const Options& options, const takes::Take& take) {
  const bool has_times = !options.times.empty() || options.strip > 0 || options.key_poses > 0;
  if (has_times && !(take.duration_s > 0.0))
    return bad(options.file,
               "is a mesh, which has no times; leave out --time, --strip and --key-poses");
  if (options.key_poses > 0) return key_poses_of(options, take);
  if (!options.times.empty()) return named_times_of(options, take);
  if (options.strip == 0) return std::vector<double>{0.0};
  std::vector<double> times;
  for (std::uint32_t at = 0; at < options.strip; ++at)
    times.push_back(take.duration_s * at / (options.strip - 1));
  return times;
}

// Returns a camera that shows all scenes, so that a strip does not jump.
Camera camera_for(const std::vector<Scene>& scenes, View view, Size size) {
  std::vector<Eigen::Vector3f> points;
  for (const Scene& scene : scenes) {
    const auto outline = scene.outline();
    points.insert(points.end(), outline.begin(), outline.end());
  }
  return framing(points, view, 1.0 * size.width / size.height);
}

std::vector<Panel> draw_strip(const std::vector<Scene>& scenes, const std::vector<double>& times,
                              const std::vector<std::string>& captions, const Wanted& wanted) {
  const Camera camera = camera_for(scenes, wanted.view, wanted.size);
  std::vector<Panel> panels;
  for (std::size_t at = 0; at < scenes.size(); ++at) {
    const Lighting lighting(scenes[at], wanted.view.azimuth_deg);
    const std::string time = times.size() > 1 ? seconds_text(times[at]) : std::string();
    panels.push_back({draw(lighting, camera, wanted.size), captions.empty() ? time : captions[at]});
  }
  return panels;
}

// Draws all pictures from one distance, so that the model keeps its size as it turns.
std::vector<Panel> draw_turntable(const std::vector<Scene>& scenes, std::uint32_t count,
                                  const Wanted& wanted) {
  std::vector<Camera> cameras;
  for (std::uint32_t at = 0; at < count; ++at) {
    View view = wanted.view;
    view.azimuth_deg += 360.0 * at / count;
    cameras.push_back(camera_for(scenes, view, wanted.size));
  }
  const auto farthest =
      std::max_element(cameras.begin(), cameras.end(), [](const Camera& a, const Camera& b) {
        return a.distance_m < b.distance_m;
      })->distance_m;
  std::vector<Panel> panels;
  for (Camera& camera : cameras) {
    camera.distance_m = farthest;
    camera.target = cameras.front().target;
    const Lighting lighting(scenes.front(), camera.view.azimuth_deg);
    const long shown = std::lround(std::remainder(camera.view.azimuth_deg, 360.0));
    panels.push_back(
        {draw(lighting, camera, wanted.size), "azimuth " + std::to_string(shown) + " degrees"});
  }
  return panels;
}

/// Writes one picture, one sheet or several numbered files, and returns their names.
Result<std::vector<std::string>> write_panels(const Options& options,
                                              const std::vector<Panel>& panels) {
  std::vector<std::string> files{options.out};
  if (panels.size() > 1 && options.numbered) {
    const std::filesystem::path out(options.out);
    const std::string stem = (out.parent_path() / out.stem()).string();
    files.clear();
    for (std::size_t at = 0; at < panels.size(); ++at)
      files.push_back(fmt::format("{}-{:02}.png", stem, at));
  }
  for (std::size_t at = 0; at < files.size(); ++at) {
    const auto done =
        write_png(files[at], files.size() == panels.size()
                                 ? panels[at].image
                                 : contact_sheet(panels, static_cast<int>(options.columns)));
    if (!done) return done.error();
  }
  return files;
}

/// Paints the model of each scene by the displacements of its vertices, on one scale.
void colour_by_distance(const takes::Take& take, const std::vector<SceneFrame>& frames,
                        std::vector<Scene>& scenes) {
  const auto rest_of = [&](const SceneFrame& frame) -> const deform::Mesh& {
    return frame.mesh ? *frame.mesh : take.rest;
  };
  double farthest = 0.0;
  for (const SceneFrame& frame : frames)
    farthest = std::max(farthest, farthest_way(rest_of(frame), frame.vertices));
  const double scale = farthest > 0.0 ? farthest : 1.0;
  for (std::size_t at = 0; at < frames.size(); ++at)
    scenes[at].model.paint = paint_by_distance(rest_of(frames[at]), frames[at].vertices, scale);
  const double part = farthest / std::max(deform::diagonal_of(take.rest.vertices), 1e-300);
  cli::note(fmt::format("dark red: displaced by {:.4g}, which is {:.1f} % of the model's diagonal",
                        farthest, 100.0 * part));
}

Result<std::vector<std::string>> draw_take(const Options& options, const Wanted& wanted,
                                           const takes::Take& take) {
  const auto times = times_of(options, take);
  if (!times) return times.error();
  const SceneBuilder builder(take.rest, take.units_per_metre);
  SceneParts parts = options.parts;
  parts.hands = parts.vectors = !options.no_hands;
  std::vector<Scene> scenes;
  std::vector<SceneFrame> frames;
  for (const double time : *times) {
    auto scene_frame = take.frame_at(time);
    if (!scene_frame) return scene_frame.error();
    if (scene_frame->mesh == nullptr)
      builder.build(*scene_frame, parts, scenes.emplace_back());
    else // the model has become finer; it fills the same box
      SceneBuilder(*scene_frame->mesh, builder.units_per_metre())
          .build(*scene_frame, parts, scenes.emplace_back());
    if (options.colour == "distance") frames.push_back(*std::move(scene_frame));
  }
  if (options.colour == "distance") {
    if (!(take.duration_s > 0.0))
      return bad("--colour distance",
                 "needs a recording or a timeline; a mesh has no displacements");
    colour_by_distance(take, frames, scenes);
  }
  return write_panels(options,
                      options.turntable > 0
                          ? draw_turntable(scenes, options.turntable, wanted)
                          : draw_strip(scenes, *times, parts_of(options.captions), wanted));
}

Result<void> make_picture(const Options& options) {
  const auto wanted = check(options);
  if (!wanted) return wanted.error();
  const auto take = takes::read_take(options.file, takes::reading(options.up), options.mesh);
  if (!take) return take.error();
  const auto files = draw_take(options, *wanted, *take);
  if (!files) return files.error();
  for (const std::string& file : *files)
    report_written(file);
  return {};
}

} // namespace

Result<void> draw_picture(const PictureOptions& options, const takes::Take& take) {
  const auto wanted = check(options);
  if (!wanted) return wanted.error();
  const auto files = draw_take(options, *wanted, take);
  if (!files) return files.error();
  return {};
}

} // namespace nendo::app::picture_command

void nendo::app::add_picture(cli::Command& program) {
  using namespace picture_command;
  cli::Command command =
      program.add_command("picture", "Draws a model or a recording as a PNG, without a screen");
  Options& options = command.on_chosen<Options>(make_picture);
  command
      .add_option("FILE", options.file,
                  "OBJ, PLY, STL or glTF file, or a recording of `nendo run --record`")
      .required();
  command.add_option("--out", options.out, "Where to write the picture, .png").required();
  takes::add_up_option(command, options.up);
  command.add_option("--mesh", options.mesh, "Recordings: the model, if it has been moved");
  command.add_option("--camera", options.view,
                     "front, back, left, right, side, top, or AZIMUTH,ELEVATION in degrees");
  command.add_option("--pixels", options.size, "WIDTHxHEIGHT in pixels, of each picture");
  command.add_option("--turntable", options.turntable,
                     "Number of pictures from all sides, on one sheet");
  command.add_option("--time", options.times,
                     "Recordings: the time, or times T,T,..., in seconds, on one sheet");
  command.add_flag("--glove-time", options.by_glove_time,
                   "--time counts from the first sample of the gloves, when their motion began, "
                   "and not from the beginning of the recording");
  command.add_option("--key-poses", options.key_poses,
                     "Recordings: number of poses that differ the most, on one sheet");
  command.add_option("--captions", options.captions,
                     "Captions of the pictures, separated by commas");
  command.add_option("--strip", options.strip,
                     "Recordings: number of pictures from beginning to end, on one sheet");
  command.add_option("--columns", options.columns, "Pictures per row of the sheet");
  command.add_option(
      "--colour", options.colour,
      "model: the model's colours; distance: recordings: the displacement from rest, "
      "from grey to dark red");
  command.add_flag("--numbered", options.numbered,
                   "Write one file per picture in place of a sheet: FILE-00.png and so on");
  command.add_flag("--contact", options.parts.contacts,
                   "Recordings: show where hands touch clay, and how hard");
  command.add_flag("--no-hands", options.no_hands, "Recordings: do not draw the hands");
}
