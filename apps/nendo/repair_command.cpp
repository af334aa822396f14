// nendo repair: a model made closed, without gloves or clock.

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/repair.hpp>

#include "cli/cli.hpp"
#include "cli/json_line.hpp"
#include "cli/output_place.hpp"
#include "nendo/commands.hpp"
#include "takes/model_files.hpp"

namespace nendo::app::repair_command {
namespace {

using namespace nendo::deform;

struct Options {
  std::string model;
  std::string out;
  std::string up; ///< empty: y
  std::optional<double> tolerance;
  bool json = false;
  bool force = false;
};

Result<void> check(const Options& options) {
  if (options.tolerance && !(*options.tolerance >= 0.0 && std::isfinite(*options.tolerance)))
    return Error{Errc::usage, "--tolerance: use a length in the model's units, 0 or more"};
  if (auto fine = cli::check_place("--out", options.out, mesh_endings); !fine) return fine;
  return cli::check_spares(options.model, "--out", options.out, options.force);
}

std::size_t faces_left_out(const Repair& repaired) {
  std::size_t faces = 0;
  for (const LeftOut& left : repaired.left_out)
    faces += left.faces;
  return faces;
}

void print_json(const Options& options, const Repair& repaired) {
  cli::print_line({{"file", printable(options.model)},
                   {"out", printable(options.out)},
                   {"tolerance", repaired.tolerance},
                   {"joined_vertices", repaired.joined},
                   {"dropped_faces", repaired.dropped},
                   {"dropped_corners", repaired.repeated},
                   {"split_edges", repaired.split},
                   {"turned_faces", repaired.turned},
                   {"separated_vertices", repaired.separated},
                   {"filled_holes", repaired.filled},
                   {"crossing_lids", repaired.filled_crossing},
                   {"dropped_vertices", repaired.stray},
                   {"left_out_faces", faces_left_out(repaired)},
                   {"skipped_junctions", repaired.skipped_junctions},
                   {"vertices", repaired.mesh.vertices.cols()},
                   {"faces", repaired.mesh.face_count()},
                   {"volume", volume_of(repaired.mesh)}});
}

void print_lines(const Options& options, const Repair& repaired) {
  const std::string name = printable(options.model);
  for (const std::string& line : lines_of(repaired))
    std::cout << name << ": " << line << '\n';
  if (lines_of(repaired).empty()) std::cout << name << ": nothing to repair\n";
  char sizes[128];
  std::snprintf(sizes, sizeof sizes, ": %td vertices, %zu faces, volume %.9g\n",
                repaired.mesh.vertices.cols(), repaired.mesh.face_count(),
                volume_of(repaired.mesh));
  std::cout << printable(options.out) << sizes;
}

Result<void> repair_file(const Options& options) {
  if (auto fine = check(options); !fine) return fine;
  const ReadOptions reading = takes::reading(options.up);
  const auto model = takes::read_model(options.model, reading);
  if (!model) return model.error();
  const auto repaired = deform::repair(model->mesh, {options.tolerance});
  if (!repaired)
    return Error{repaired.error().code, options.model + ": " + repaired.error().message};
  if (auto done = takes::write_model(options.out, repaired->mesh, takes::axis_of(reading)); !done)
    return done;
  if (options.json)
    print_json(options, *repaired);
  else
    print_lines(options, *repaired);
  return {};
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command(
      "repair", "Makes a model closed: joins, drops, turns, separates and fills what keeps it from "
                "being cut, joined or refined, and says what it did");
  command.add_option("MODEL", options->model, "OBJ, PLY, STL or glTF file").required();
  command.add_option("--out", options->out, "Where to write the repaired model, .obj, .ply or .stl")
      .required();
  command.add_option("--tolerance", options->tolerance,
                     "How far apart vertices at open edges may be that become one, in the model's "
                     "units; without it, a hundred-thousandth of the model's diagonal");
  takes::add_up_option(command, options->up);
  command.add_flag("--json", options->json, "Print what was done as one JSON object");
  command.add_flag("--force", options->force, cli::force_summary);
  command.on_chosen([options] {
    const auto done = repair_file(*options);
    return done ? 0 : cli::report(done.error());
  });
}

} // namespace nendo::app::repair_command
