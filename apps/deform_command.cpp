// nendo deform: the deformation alone, without gloves or clock.

#include <iostream>
#include <memory>

#include <nendo/deform/control_vectors.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "cli.hpp"
#include "commands.hpp"
#include "kernel_options.hpp"

namespace nendo::app {
namespace {

using namespace nendo::deform;

struct Options {
  std::string mesh;
  std::string vectors;
  std::string out;
  double radius = 0.0;
  KernelOptions kernel;
};

Result<Eigen::VectorXd> radii_for(const ControlVectors& vectors, const Options& options) {
  if (vectors.radii.size() > 0) return vectors.radii;
  if (!(options.radius > 0.0)) {
    return Error{Errc::usage,
                 "--radius is missing: " + options.vectors +
                     " has no radius column; give --radius R in the mesh's units, R > 0"};
  }
  return Eigen::VectorXd::Constant(vectors.starts.cols(), options.radius).eval();
}

Result<void> deform_file(const Options& options) {
  const auto csrbf = options.kernel.parse();
  if (!csrbf) return csrbf.error();
  auto mesh = read_mesh(options.mesh);
  if (!mesh) return mesh.error();
  const auto vectors = read_control_vectors(options.vectors);
  if (!vectors) return vectors.error();
  const auto radii = radii_for(*vectors, options);
  if (!radii) return radii.error();

  CsrbfSolver solver(*csrbf);
  CsrbfField field;
  FieldStatus status = solver.build(vectors->starts, *radii);
  if (is_solved(status)) {
    const FieldStatus solved = solver.solve(vectors->displacements, field);
    if (solved != FieldStatus::ok) status = solved;
  }
  if (status == FieldStatus::merged) {
    note(options.vectors +
         ": some start points coincide; they share the mean of their displacements");
  } else if (status != FieldStatus::ok) {
    return Error{Errc::bad_input, options.vectors + ": " + std::string(describe(status))};
  }
  displace(field, mesh->vertices, mesh->vertices);
  if (!mesh->vertices.allFinite()) {
    return Error{Errc::bad_input,
                 options.vectors + ": " + std::string(describe(FieldStatus::not_finite))};
  }
  return write_mesh(options.out, *mesh);
}

} // namespace

void add_deform(Command& program) {
  auto options = std::make_shared<Options>();
  Command command = program.add_command(
      "deform", "Deforms a mesh by control vectors from a file, without gloves or clock");
  command.add_option("MESH", options->mesh, "OBJ or PLY file").required();
  command
      .add_option("--vectors", options->vectors,
                  "CSV file: x,y,z,dx,dy,dz[,radius], a control vector a line")
      .required();
  command.add_option("--radius", options->radius,
                     "Radius of the supports, in the mesh's units; a radius column wins");
  add_kernel_options(command, options->kernel);
  command.add_option("--out", options->out, "Where to write the result, .obj or .ply").required();
  command.on_chosen([options] {
    const auto done = deform_file(*options);
    return done ? 0 : report(done.error());
  });
}

} // namespace nendo::app
