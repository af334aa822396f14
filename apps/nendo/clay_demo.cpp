#include "nendo/clay_demo.hpp"

#include <array>
#include <filesystem>
#include <iostream>
#include <utility>
#include <vector>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/sculpting/placing.hpp>

#include "cli/cli.hpp"
#include "render/picture.hpp"
#include "session/open_hands.hpp"
#include "session/run_report.hpp"
#include "session/run_session.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::clay_demo {
namespace {

using namespace nendo::render;

struct Work {
  const char* glove; ///< of both hands
  const char* name;  ///< of what they make, in the file's name
  const char* caption;
  double duration_s;
};
constexpr std::array works{Work{"sim:press", "cake", "Pressed by two palms: a flat cake", 10.4},
                           Work{"sim:knead", "bowl", "Thumbed: a bowl", 15.8},
                           Work{"sim:grip", "ears", "Pinched and pulled: two ears", 5.4}};
constexpr View view{-165.0, 24.0}; // both ears are seen from there
constexpr Size panel_size{460, 400};

std::string named(const std::string& out, const char* name) {
  const std::filesystem::path path(out);
  return (path.parent_path() / path.stem()).string() + "-" + name + path.extension().string();
}

session::RunOptions options_for(const Work& work, const std::string& out) {
  session::RunOptions run;
  run.mesh = cli::shipped_model("clay.ply").string();
  run.left = run.right = work.glove;
  run.out = named(out, work.name);
  run.duration_s = work.duration_s;
  run.model_size_m = sculpting::usual_size_m(flow::Mode::clay);
  run.calibration.calibration = "none"; // what is stored is a real hand's
  run.loop.rate_hz = 90.0;
  run.loop.sculptor.mode = flow::Mode::clay;
  return run;
}

/// Returns the shape that the hands leave.
Result<deform::Mesh> shape_of(const Work& work, const std::string& out) {
  session::RunOptions run = options_for(work, out);
  if (auto fine = run.recording.check(run.out, run.loop.switch_action); !fine) return fine.error();
  auto model = takes::read_model(run.mesh);
  if (!model) return model.error();
  std::cout << work.glove << " for " << work.duration_s << " s\n" << std::flush;
  EventCount event_count;
  auto opened = session::open_hands(run, model->mesh, event_count);
  if (!opened) return opened.error();
  session::RunParticipants participants;
  participants.progress = session::progress_for(run, opened->hands);
  const auto outcome = session::run_session(run, opened->hands, std::move(model->mesh),
                                            participants, opened->grants);
  if (!outcome) return outcome.error();
  session::print_summary(run, opened->hands, *outcome);
  return deform::read_mesh(run.out);
}

Panel panel_of(const deform::Mesh& shape, double units_per_metre, const char* caption) {
  SceneFrame frame;
  frame.vertices = shape.vertices;
  Scene scene;
  SceneBuilder(shape, units_per_metre).build(frame, {}, scene);
  const Camera camera = framing(scene.outline(), view, 1.0 * panel_size.width / panel_size.height);
  return {draw(Lighting(scene, view.azimuth_deg), camera, panel_size), caption};
}

} // namespace

int demonstrate(const std::string& out, const std::string& picture) {
  cli::install_stop_signals();
  std::vector<Panel> panels;
  for (const Work& work : works) {
    if (cli::stop_requested()) break;
    const auto shape = shape_of(work, out);
    if (!shape) return cli::report(shape.error());
    panels.push_back(panel_of(*shape, 1.0, work.caption)); // the ball's units are metres
  }
  if (const auto drawn = write_png(picture, contact_sheet(panels, static_cast<int>(panels.size())));
      !drawn)
    return cli::report(drawn.error());
  std::cout << "\nWhat they made: " << picture << "\nThe shapes, for any 3-D viewer: ";
  for (std::size_t at = 0; at < panels.size(); ++at)
    std::cout << (at > 0 ? ", " : "") << named(out, works[at].name);
  std::cout << '\n';
  return 0;
}

} // namespace nendo::app::clay_demo
