// nendo edit play: the shape that a timeline makes.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "cli/cli.hpp"
#include "cli/json_line.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "edit/edit_actions.hpp"
#include "takes/model_files.hpp"
#include "takes/timeline_frames.hpp"

namespace nendo::edit {

namespace {

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
