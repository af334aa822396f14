#include "python/meshes.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/join.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/repair.hpp>
#include <nendo/deform/subdivision.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::python {
namespace {

using Triple = std::array<double, 3>;

deform::UpAxis up_axis(const std::string& name) {
  if (name != "y" && name != "z") throw py::value_error("up: use \"y\" or \"z\"");
  return name == "z" ? deform::UpAxis::z : deform::UpAxis::y;
}

deform::Points vertices_of(const py::object& array) {
  deform::Points vertices = points_of(array, "vertices");
  if (vertices.cols() == 0) throw py::value_error("vertices: there are none");
  return vertices;
}

PyMesh mesh_of(const py::object& vertices, const py::object& faces) {
  deform::Mesh mesh;
  mesh.vertices = vertices_of(vertices);
  Corners corners = corners_of(faces, "faces", mesh.vertex_count());
  mesh.face_corners = std::move(corners.indices);
  for (std::size_t end = corners.per_face; end <= mesh.face_corners.size(); end += corners.per_face)
    mesh.face_starts.push_back(deform::to_index(end));
  return PyMesh(std::move(mesh));
}

PyMesh read(const std::filesystem::path& path, const std::optional<std::string>& up, bool weld) {
  deform::ReadOptions options;
  if (up) options.up = up_axis(*up);
  options.weld = weld;
  check_readable(path);
  auto model = value_of(without_gil([&] { return deform::read_model(path, options); }));
  return PyMesh(std::move(model.mesh), std::move(model.notes));
}

/// Without the GIL, and with the mesh's name in the message of an error.
template <class Call>
auto computed(const char* what, Call call) {
  auto result = without_gil(call);
  if (!result) raise({result.error().code, std::string(what) + ": " + result.error().message});
  return *std::move(result);
}

std::vector<PyMesh> parts_of(const deform::CutModel& model) {
  std::vector<PyMesh> parts;
  for (deform::Mesh& part : deform::separate(model))
    parts.emplace_back(std::move(part));
  return parts;
}

std::vector<PyMesh> cut(const PyMesh& own, const Triple& point, const Triple& normal) {
  const auto vector = [](const Triple& from) { return Eigen::Vector3d(from[0], from[1], from[2]); };
  return parts_of(computed("the mesh", [&] {
    return deform::cut_model(*own.mesh, deform::CutPlane{vector(point), vector(normal)});
  }));
}

std::vector<PyMesh> cut_by_wire(const PyMesh& own, const py::object& starts,
                                const py::object& ends) {
  const deform::Points from = points_of(starts, "starts");
  const deform::Points to = points_of(ends, "ends", from.cols());
  deform::CutWire wire;
  for (Eigen::Index at = 0; at < from.cols(); ++at)
    wire.places.push_back({from.col(at), to.col(at)});
  return parts_of(computed("the mesh", [&] { return deform::cut_model(*own.mesh, wire); }));
}

PyMesh join(const std::vector<PyMesh>& meshes, double seam_width) {
  deform::JoinOptions options;
  options.seam_width = number_in(seam_width, "seam_width", 0.0, 1e100);
  std::vector<deform::JoinPart> parts;
  for (const PyMesh& each : meshes)
    parts.push_back({each.mesh.get(), "mesh " + std::to_string(parts.size())});
  if (parts.empty()) throw py::value_error("meshes: there are none");
  auto joined = value_of(without_gil([&] { return deform::join(parts, options); }));
  return PyMesh(std::move(joined.mesh));
}

PyMesh repair(const PyMesh& own, std::optional<double> tolerance) {
  deform::RepairOptions options;
  if (tolerance) options.tolerance = number_in(*tolerance, "tolerance", 0.0, 1e100);
  auto made = computed("the mesh", [&] { return deform::repair(*own.mesh, options); });
  std::vector<std::string> lines = deform::lines_of(made);
  return PyMesh(std::move(made.mesh), std::move(lines));
}

PyMesh with_vertices(const PyMesh& own, const py::object& vertices) {
  deform::Mesh mesh = *own.mesh;
  mesh.vertices = points_of(vertices, "vertices", mesh.vertices.cols());
  return PyMesh(std::move(mesh));
}

void add_properties(py::class_<PyMesh>& mesh) {
  mesh.def("__repr__",
           [](const PyMesh& own) {
             return to_str("<nendo.Mesh of " + std::to_string(own.mesh->vertex_count()) +
                           " vertices and " + std::to_string(own.mesh->face_count()) + " faces>");
           })
      .def_property_readonly(
          "vertices", [](const PyMesh& own) { return array_of(own.mesh->vertices); },
          "(n, 3) float64, a copy.")
      .def_property_readonly(
          "faces", [](const PyMesh& own) { return faces_of(*own.mesh); },
          "(t, 3) uint32: the triangles; polygons are triangulated.")
      .def_property_readonly(
          "face_starts", [](const PyMesh& own) { return array_of(own.mesh->face_starts); },
          "(m + 1,) uint32: polygon f has the corners face_corners[face_starts[f]:"
          "face_starts[f + 1]].")
      .def_property_readonly(
          "face_corners", [](const PyMesh& own) { return array_of(own.mesh->face_corners); },
          "(k,) uint32: indices of vertices.")
      .def_property_readonly(
          "normals", [](const PyMesh& own) { return array_of(deform::vertex_normals(*own.mesh)); },
          "(n, 3): unit normals of the vertices; 0 without a face.")
      .def_readonly("notes", &PyMesh::notes,
                    "What the reader or the repair changed, one line each.")
      .def_property_readonly(
          "diagonal", [](const PyMesh& own) { return deform::diagonal_of(own.mesh->vertices); },
          "The diagonal of its bounding box.")
      .def_property_readonly(
          "fault",
          [](const PyMesh& own) {
            return to_str(deform::describe(deform::check_closed_manifold(*own.mesh), *own.mesh));
          },
          "Why it is no closed, two-manifold surface; empty if it is.")
      .def_property_readonly(
          "volume", [](const PyMesh& own) { return deform::volume_of(*own.mesh); },
          "The volume that a closed surface encloses.");
}

void add_functions(py::class_<PyMesh>& mesh) {
  mesh.def_static(
          "read", &read, py::arg("path"), py::kw_only(), py::arg("up") = py::none(),
          py::arg("weld") = true,
          "Reads OBJ, PLY, STL or glTF, with materials and textures. `up` is the file's axis "
          "that points up, \"y\" or \"z\". With `weld`, vertices at one place are merged where "
          "the format cannot share them. Blocks, without the GIL. Raises Error.")
      .def(
          "write",
          [](const PyMesh& own, const std::filesystem::path& path, const std::string& up) {
            const auto axis = up_axis(up);
            check(without_gil([&] { return deform::write_mesh(path, *own.mesh, {}, axis); }));
          },
          py::arg("path"), py::kw_only(), py::arg("up") = "y",
          "Writes .obj, .ply or .stl. Blocks, without the GIL. Raises Error.")
      .def("with_vertices", &with_vertices, py::arg("vertices"),
           "Returns the mesh with other vertices (n, 3); faces, materials and textures stay.")
      .def(
          "subdivide",
          [](const PyMesh& own) {
            return without_gil([&] { return PyMesh(deform::subdivide(*own.mesh).mesh); });
          },
          "Returns a finer mesh of the same surface: a triangle becomes four.")
      .def("repair", &repair, py::arg("tolerance") = py::none(),
           "Returns a closed, two-manifold mesh, whose notes say what was repaired. Vertices at "
           "open "
           "edges within `tolerance` (default: 1e-5 of the diagonal) are merged. Raises Error.")
      .def("cut", &cut, py::arg("point"), py::arg("normal"),
           "Cuts a closed mesh by a plane, and returns its parts. Raises Error.")
      .def(
          "cut_by_wire", &cut_by_wire, py::arg("starts"), py::arg("ends"),
          "Cuts a closed mesh by the surface that a straight wire sweeps; (k, 3) each: its ends at "
          "each time. Returns the parts. Raises Error.");
}

} // namespace

py::array faces_of(const deform::Mesh& mesh) {
  const std::vector<std::uint32_t> corners = deform::corners_of_triangles(mesh);
  return array_of(corners.data(), {static_cast<py::ssize_t>(corners.size() / 3), 3});
}

deform::Mesh read_near_zero(const std::filesystem::path& file) {
  check_readable(file);
  auto mesh = value_of(without_gil([&] { return deform::read_mesh(file); }));
  deform::count_from(deform::usual_offset(mesh), mesh);
  return mesh;
}

void add_meshes(py::module_& module) {
  py::class_<PyMesh> mesh(module, "Mesh",
                          "A polygon mesh: vertices (n, 3) float64, and faces (m, 3) or (m, k) "
                          "int32 or uint32, both in "
                          "C order. It never changes; any thread may use it.");
  mesh.def(py::init(&mesh_of), py::arg("vertices"), py::arg("faces"));
  add_properties(mesh);
  add_functions(mesh);
  module.def("join", &join, py::arg("meshes"), py::kw_only(), py::arg("seam_width") = 0.0,
             "Joins closed meshes that overlap into one, without the GIL. The seam is blended to "
             "`seam_width` on each side; 0: sharp. Raises Error.");
}

} // namespace nendo::python
