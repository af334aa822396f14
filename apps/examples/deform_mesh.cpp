// Deforms a mesh by control vectors, without a glove: each row of the table says where a point
// begins, and by how much it moves; RADIUS is how far it takes the surface along, in model units.
//   deform_mesh IN.obj VECTORS.csv RADIUS OUT.obj    the table has x,y,z,dx,dy,dz

#include <cstdlib>
#include <iostream>
#include <string>

#include <nendo/deform/control_vectors.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/type1.hpp>

namespace {

int fail(const nendo::Error& error) {
  std::cerr << "deform_mesh: " << error.message << "\n";
  return static_cast<int>(error.code);
}

} // namespace

int main(int argc, char** argv) {
  using namespace nendo;
  const double radius = argc == 5 ? std::strtod(argv[3], nullptr) : 0.0;
  if (!(radius > 0.0))
    return fail({Errc::usage, "usage: deform_mesh IN.obj VECTORS.csv RADIUS OUT.obj"});
  auto mesh = deform::read_mesh(argv[1]);
  if (!mesh) return fail(mesh.error());
  const auto vectors = deform::read_control_vectors(argv[2]);
  if (!vectors) return fail(vectors.error());

  deform::Type1Deformer deformer(mesh->vertices, vectors->starts.cols(),
                                 {deform::one_radius(radius)});
  deform::FieldStatus status = deformer.grab(vectors->starts);
  deform::BlockShape shape; // vertices in blocks, as vector instructions want them
  if (is_solved(status)) status = deformer.apply(vectors->starts + vectors->displacements, shape);
  if (!is_solved(status)) return fail({Errc::failed, std::string(deform::describe(status))});
  deformer.layout().unpack(shape, mesh->vertices);

  if (const auto written = deform::write_mesh(argv[4], *mesh); !written)
    return fail(written.error());
  std::cout << mesh->vertices.cols() << " vertices, moved by " << vectors->starts.cols()
            << " control vectors: " << argv[4] << "\n";
  return 0;
}
