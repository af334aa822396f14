#include <nendo/deform/field.hpp>

#include "python/deforming.hpp"

namespace nendo::python {

deform::Wendland kernel_of(const std::string& name) {
  return choice_of(name, "kernel", "wendland-c0, wendland-c2, wendland-c4 or wendland-c6",
                   deform::wendland_named);
}

deform::Supports supports_of(const py::object& radius, Eigen::Index points) {
  constexpr double min = 1e-100, max = 1e100; // of the solver
  if (!py::isinstance<py::array>(radius))
    return deform::one_radius(number_in(
        argument_as<double>(radius, "radius", "a number, or an array (k,),"), "radius", min, max));
  const Eigen::VectorXd radii = vector_of(radius, "radius", points);
  for (const double each : radii)
    number_in(each, "radius", min, max);
  deform::Supports supports;
  deform::assign_radii(supports, radii);
  return supports;
}

void check(deform::FieldStatus status) {
  if (!is_solved(status)) raise({Errc::failed, std::string(deform::describe(status))});
}

namespace {

deform::CsrbfField solve(const py::object& start_array, const py::object& end_array,
                         const py::object& radius, const std::string& kernel,
                         const std::string& polynomial, double keep_volume, double smoothing) {
  const deform::Points starts = points_of(start_array, "starts");
  const deform::Points ends = points_of(end_array, "ends", starts.cols());
  if (starts.cols() == 0) throw py::value_error("starts: there are none");
  const deform::Supports supports = supports_of(radius, starts.cols());
  deform::CsrbfOptions options;
  options.kernel = kernel_of(kernel);
  options.polynomial =
      choice_of(polynomial, "polynomial", "none, constant or linear", deform::polynomial_named);
  options.keep_volume = number_in(keep_volume, "keep_volume", 0.0, 1.0);
  options.smoothing = number_in(smoothing, "smoothing", 0.0, 1e6);
  deform::CsrbfField field;
  check(without_gil([&] {
    deform::CsrbfSolver solver(options);
    const deform::FieldStatus status = solver.build(starts, supports);
    return is_solved(status) ? solver.solve(ends - starts, field) : status;
  }));
  return field;
}

py::array displaced(const deform::CsrbfField& field, deform::Points points) {
  without_gil([&] { deform::displace(field, points, points); });
  return array_of(points);
}

py::array displacements(const deform::CsrbfField& field, const py::object& array) {
  deform::Points points = points_of(array, "points");
  without_gil([&] {
    for (Eigen::Index at = 0; at < points.cols(); ++at)
      points.col(at) = field.displacement_at(points.col(at));
  });
  return array_of(points);
}

py::array deformed(const py::object& vertices, const py::object& starts, const py::object& ends,
                   const py::object& radius, const std::string& kernel) {
  deform::Points points = points_of(vertices, "vertices");
  return displaced(solve(starts, ends, radius, kernel, "none", 0.0, 0.0), std::move(points));
}

} // namespace

void add_fields(py::module_& module) {
  using Field = deform::CsrbfField;
  py::class_<Field>(
      module, "Field",
      "The displacement field s(x) = sum of coefficient * psi(|x - centre| / radius) + "
      "polynomial (1, x, y, z) that moves `starts` (k, 3) to `ends` (k, 3). `radius` is a "
      "number, or an array (k,). Lengths are in the units of the model. Solving "
      "releases the GIL. Raises Error if there is no usable solution. Immutable; any "
      "thread may use it.")
      .def(py::init(&solve), py::arg("starts"), py::arg("ends"), py::kw_only(), py::arg("radius"),
           py::arg("kernel") = "wendland-c2", py::arg("polynomial") = "none",
           py::arg("keep_volume") = 0.0, py::arg("smoothing") = 0.0)
      .def_property_readonly(
          "centres", [](const Field& own) { return array_of(own.centres); },
          "(f, 3), one row for each radial function.")
      .def_property_readonly(
          "radii", [](const Field& own) { return array_of(own.radii); },
          "(f,): the radius of each function.")
      .def_property_readonly(
          "coefficients", [](const Field& own) { return array_of(own.coefficients); },
          "(f, 3): the coefficient of each function.")
      .def_property_readonly(
          "polynomial",
          [](const Field& own) {
            const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = own.polynomial;
            return array_of(rows.data(), {3, 4});
          },
          "(3, 4): the polynomial; 0 without one.")
      .def_property_readonly(
          "kernel", [](const Field& own) { return name_of(own.kernel); }, "The name of psi.")
      .def_readonly("keep_volume", &Field::keep_volume, "0, compressible, to 1, volume-preserving.")
      .def("displacements", &displacements, py::arg("points"),
           "Returns s(x) at points (n, 3), as (n, 3).")
      .def(
          "displace",
          [](const Field& own, const py::object& points) {
            return displaced(own, points_of(points, "points"));
          },
          py::arg("points"), "Returns x + s(x) of points (n, 3), as (n, 3).");
  module.def(
      "deform", &deformed, py::arg("vertices"), py::arg("starts"), py::arg("ends"), py::kw_only(),
      py::arg("radius"), py::arg("kernel") = "wendland-c2",
      "Deforms vertices (n, 3) so that a surface at `starts` (k, 3) moves to `ends` (k, 3), and "
      "returns (n, 3): Field(starts, ends, ...).displace(vertices). Releases the GIL.");
}

} // namespace nendo::python
