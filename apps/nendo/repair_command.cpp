// nendo repair: makes a model closed.

#include <array>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/repair.hpp>

#include "cli/cli.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"

namespace nendo::app::repair_command {
namespace {

using namespace nendo::deform;

struct Options {
  std::string model;
  ModelOutput output;
  std::optional<double> tolerance;
  bool json = false;
};

Result<void> check(const Options& options) {
  if (options.tolerance && !(*options.tolerance >= 0.0 && std::isfinite(*options.tolerance)))
    return Error{Errc::usage, "--tolerance: use a length in the model's units, 0 or more"};
  return options.output.check(options.output.out, std::array{options.model});
}

std::size_t faces_left_out(const Repair& repaired) {
  std::size_t faces = 0;
  for (const LeftOut& left : repaired.left_out)
    faces += left.faces;
  return faces;
}

void print_json(const Options& options, const Repair& repaired) {
  cli::print_line({{"file", printable(options.model)},
                   {"out", printable(options.output.out)},
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
  report_model(options.output.out, repaired.mesh, volume_text(repaired.mesh));
}

Result<void> repair_file(const Options& options) {
  if (auto fine = check(options); !fine) return fine;
  const auto mesh = options.output.read(options.model);
  if (!mesh) return mesh.error();
  const auto repaired = deform::repair(*mesh, {options.tolerance});
  if (!repaired)
    return Error{repaired.error().code, options.model + ": " + repaired.error().message};
  if (auto done = options.output.write(options.output.out, repaired->mesh); !done) return done;
  options.json ? print_json(options, *repaired) : print_lines(options, *repaired);
  return {};
}

} // namespace
} // namespace nendo::app::repair_command

void nendo::app::add_repair(cli::Command& program) {
  using namespace repair_command;
  cli::Command command = program.add_command(
      "repair", "Makes a model closed, so that it can be cut, joined and refined: joins, removes, "
                "turns, separates and fills, and reports each change");
  Options& options = command.on_chosen<Options>(repair_file);
  command.add_option("MODEL", options.model, "OBJ, PLY, STL or glTF file").required();
  options.output.add_to(command, "Where to write the repaired model, .obj, .ply or .stl");
  command.add_option("--tolerance", options.tolerance,
                     "Max distance of vertices at open edges that become one, in the model's "
                     "units; without it, a hundred-thousandth of the model's diagonal");
  command.add_flag("--json", options.json, "Report as one JSON object");
}
