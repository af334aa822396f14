// nendo deform: the deformation alone, without gloves or clock.

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <nendo/deform/control_vectors.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "cli/cli.hpp"
#include "cli/output_place.hpp"
#include "nendo/commands.hpp"
#include "nendo/injective_deform.hpp"
#include "session/kernel_options.hpp"

namespace nendo::app::deform_command {
namespace {

using namespace nendo::deform;

struct Options {
  std::string mesh;
  std::string vectors;
  std::string out;
  std::string radius;
  std::string common_radius;
  bool injective = false;
  session::KernelOptions kernel;
};

Result<std::optional<Support>> common_radius(const Options& options, bool is_used) {
  if (options.common_radius.empty()) return std::optional<Support>();
  const auto common = parse_supports(options.common_radius);
  if (!common || common->size() != 1) {
    return Error{Errc::usage, "--common-radius " + options.common_radius +
                                  ": use R or R:WEIGHT, both greater than 0"};
  }
  if (!is_used) {
    return Error{Errc::usage, "--common-radius: stands beside a radius column, and " +
                                  options.vectors + " has none; leave it out"};
  }
  return std::optional(common->front());
}

Result<Supports> supports_for(const ControlVectors& vectors, const Options& options) {
  const bool has_own = !vectors.own.empty();
  const auto common = common_radius(options, has_own);
  if (!common) return common.error();
  if (has_own) return with_common(vectors.own, *common);
  if (options.radius.empty()) {
    return Error{Errc::usage,
                 "--radius is missing: " + options.vectors +
                     " has no radius column; give --radius R in the mesh's units, R > 0"};
  }
  auto shared = parse_supports(options.radius);
  if (!shared) {
    return Error{Errc::usage,
                 "--radius " + options.radius +
                     ": use a length > 0 in the mesh's units, or several with weights, "
                     "like 10+40:0.5"};
  }
  return Supports{std::move(*shared), {}};
}

Result<FieldStatus> deform_at_once(Points& vertices, const ControlVectors& vectors,
                                   const Supports& supports, const CsrbfOptions& csrbf,
                                   const Options& options) {
  CsrbfSolver solver(csrbf);
  CsrbfField field;
  FieldStatus status = solver.build(vectors.starts, supports);
  if (is_solved(status)) status = std::max(status, solver.solve(vectors.displacements, field));
  if (!is_solved(status))
    return Error{Errc::bad_input, options.vectors + ": " + std::string(describe(status))};
  displace(field, vertices, vertices);
  return status;
}

Result<FieldStatus> deform_in_links(Points& vertices, const ControlVectors& vectors,
                                    const Supports& supports, const CsrbfOptions& csrbf,
                                    const Options& options) {
  const auto done = deform_injectively(vertices, vectors, supports, csrbf, options.vectors);
  if (!done) return done.error();
  cli::note("injective: " + done->report);
  return done->status;
}

Result<void> deform_file(const Options& options) {
  const auto csrbf = options.kernel.parse();
  if (!csrbf) return csrbf.error();
  if (const auto fine = cli::check_place("--out", options.out, {".obj", ".ply"}); !fine)
    return fine.error();
  auto mesh = read_mesh(options.mesh);
  if (!mesh) return mesh.error();
  const auto vectors = read_control_vectors(options.vectors);
  if (!vectors) return vectors.error();
  const auto supports = supports_for(*vectors, options);
  if (!supports) return supports.error();

  const auto status = options.injective
                          ? deform_in_links(mesh->vertices, *vectors, *supports, *csrbf, options)
                          : deform_at_once(mesh->vertices, *vectors, *supports, *csrbf, options);
  if (!status) return status.error();
  if (*status == FieldStatus::merged) {
    cli::note(options.vectors +
              ": some start points coincide; they share the mean of their displacements");
  }
  if (!mesh->vertices.allFinite()) {
    return Error{Errc::bad_input,
                 options.vectors + ": " + std::string(describe(FieldStatus::not_finite))};
  }
  return write_mesh(options.out, *mesh);
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command(
      "deform", "Deforms a mesh by control vectors from a file, without gloves or clock");
  command.add_option("MESH", options->mesh, "OBJ or PLY file").required();
  command
      .add_option("--vectors", options->vectors,
                  "CSV file: x,y,z,dx,dy,dz[,radius], a control vector a line")
      .required();
  command.add_option("--radius", options->radius,
                     "Radius of the supports, in the mesh's units, or several with weights for a "
                     "kernel that is their sum: 10+40:0.5; a radius column wins");
  command.add_option(
      "--common-radius", options->common_radius,
      "Radius beside those of a radius column that all control vectors share, so that "
      "any choice has a solution; without it, the least of them with weight 0.01");
  session::add_kernel_options(command, options->kernel);
  command.add_flag("--injective", options->injective,
                   "Never fold: in links that each stay injective; vectors that cross are held "
                   "apart");
  command.add_option("--out", options->out, "Where to write the result, .obj or .ply").required();
  command.on_chosen([options] {
    const auto done = deform_file(*options);
    return done ? 0 : cli::report(done.error());
  });
}

} // namespace nendo::app::deform_command
