#include "python/arrays.hpp"

#include <cmath>
#include <limits>

namespace nendo::python {
namespace {

std::string text_of(const py::handle& object) {
  return std::string(py::str(object));
}

std::string in_words(std::initializer_list<py::ssize_t> shape) {
  std::string text = "(";
  char free = 'n';
  for (const py::ssize_t length : shape)
    text += (length == any ? std::string(1, free++) : std::to_string(length)) + ", ";
  if (shape.size() == 1) return text.substr(0, text.size() - 1) + ")";
  return text.substr(0, text.size() - 2) + ")";
}

/// Returns the argument as an array in C order. `wanted` names the element type.
py::array array_in_order(const py::handle& object, const char* name, const char* wanted) {
  if (!py::isinstance<py::array>(object))
    throw py::type_error(std::string(name) + ": a NumPy array of " + wanted + " is needed, not " +
                         text_of(py::type::of(object).attr("__name__")));
  auto array = py::reinterpret_borrow<py::array>(object);
  constexpr int in_order =
      py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_ | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
  if ((array.flags() & in_order) != in_order)
    throw py::value_error(std::string(name) +
                          ": an array in C order is needed; use numpy.ascontiguousarray()");
  return array;
}

[[noreturn]] void refuse_type(const py::array& array, const char* name, const std::string& wanted) {
  throw py::type_error(std::string(name) + ": " + wanted + " is needed, not " +
                       text_of(array.dtype()) + "; convert it with .astype()");
}

void check_shape(const py::array& array, const char* name,
                 std::initializer_list<py::ssize_t> shape) {
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  py::ssize_t axis = 0;
  for (const py::ssize_t length : shape) {
    if (!fits) break;
    fits = length == any || array.shape(axis) == length;
    ++axis;
  }
  if (!fits)
    throw py::value_error(std::string(name) + ": the shape " + in_words(shape) +
                          " is needed, not " + text_of(array.attr("shape")));
}

template <class Index>
std::vector<std::uint32_t> indices_of(const py::array& array, const char* name,
                                      std::size_t vertices) {
  const auto* const data = static_cast<const Index*>(array.data());
  std::vector<std::uint32_t> indices(static_cast<std::size_t>(array.size()));
  for (std::size_t at = 0; at < indices.size(); ++at) {
    if (data[at] < Index{0} || static_cast<std::size_t>(data[at]) >= vertices)
      throw py::value_error(std::string(name) + ": " + std::to_string(data[at]) +
                            " is no index of " + std::to_string(vertices) + " vertices");
    indices[at] = static_cast<std::uint32_t>(data[at]);
  }
  return indices;
}

} // namespace

ArrayView<double> view_of(const py::handle& object, const char* name,
                          std::initializer_list<py::ssize_t> shape) {
  const py::array array = array_in_order(object, name, "float64");
  if (!array.dtype().equal(py::dtype::of<double>())) refuse_type(array, name, "float64");
  check_shape(array, name, shape);
  ArrayView<double> view{static_cast<const double*>(array.data()),
                         Shape(array.shape(), array.shape() + array.ndim())};
  for (py::ssize_t at = 0; at < array.size(); ++at)
    if (!std::isfinite(view.data[at]))
      throw py::value_error(std::string(name) + ": row " +
                            std::to_string(at / (array.size() / array.shape(0))) +
                            " is not finite");
  return view;
}

deform::Points points_of(const py::handle& array, const char* name, py::ssize_t count) {
  const auto view = view_of(array, name, {count, 3});
  return Eigen::Map<const deform::Points>(view.data, 3, view.shape[0]);
}

Eigen::VectorXd vector_of(const py::handle& array, const char* name, py::ssize_t count) {
  const auto view = view_of(array, name, {count});
  return Eigen::Map<const Eigen::VectorXd>(view.data, view.shape[0]);
}

Eigen::Isometry3d motion_of(const double* matrix, const char* name) {
  constexpr double tolerance = 1e-6;
  Eigen::Isometry3d motion;
  motion.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix);
  const Eigen::Matrix3d turn = motion.linear();
  if (motion.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1) ||
      !(turn * turn.transpose()).isIdentity(tolerance) || !(turn.determinant() > 0.0))
    throw py::value_error(std::string(name) +
                          ": a rotation and a translation are needed: orthonormal axes, and the "
                          "last row 0, 0, 0, 1");
  return motion;
}

Corners corners_of(const py::handle& object, const char* name, std::size_t vertices) {
  const py::array array = array_in_order(object, name, "int32 or uint32");
  const bool is_signed = array.dtype().equal(py::dtype::of<std::int32_t>());
  if (!is_signed && !array.dtype().equal(py::dtype::of<std::uint32_t>()))
    refuse_type(array, name, "int32 or uint32");
  if (array.ndim() != 2 || array.shape(1) < 3)
    throw py::value_error(std::string(name) +
                          ": the shape (m, 3) or (m, k), k > 3, is needed, not " +
                          text_of(array.attr("shape")));
  if (array.size() > std::numeric_limits<std::int32_t>::max())
    throw py::value_error(std::string(name) + ": more than 2^31 corners");
  return {is_signed ? indices_of<std::int32_t>(array, name, vertices)
                    : indices_of<std::uint32_t>(array, name, vertices),
          static_cast<std::size_t>(array.shape(1))};
}

py::array records_of(const py::handle& object, const char* name, const py::dtype& type) {
  py::array array = array_in_order(object, name, "samples, as read() returns them,");
  if (!array.dtype().equal(type)) refuse_type(array, name, "the type of read()");
  check_shape(array, name, {any});
  return array;
}

} // namespace nendo::python
