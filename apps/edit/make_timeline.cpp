// nendo edit make: key poses of a recording.

#include <cstdio>

#include <nlohmann/json.hpp>

#include <nendo/recording/take_reader.hpp>

#include "cli/cli.hpp"
#include "cli/json_line.hpp"
#include "cli/model_files.hpp"
#include "cli/output_place.hpp"
#include "edit/edit_actions.hpp"
#include "edit/edit_words.hpp"
#include "takes/recorded_model.hpp"
#include "timeline/from_take.hpp"
#include "timeline/timeline_file.hpp"

namespace nendo::edit {
namespace {

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

} // namespace

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

} // namespace nendo::edit
