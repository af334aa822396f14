#pragma once
// NumPy arrays in and out. Arrays that functions take are used as they are: with the right type and
// shape, in C order, aligned, in the machine's byte order and with finite numbers. All others are
// refused with TypeError or ValueError; nothing is converted without notice. Results are copies.

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>

#include "python/bind.hpp"

namespace nendo::python {

/// Any length of an axis.
inline constexpr py::ssize_t any = -1;

/// An array that was checked. `data` is valid as long as the caller's argument.
template <class T>
struct ArrayView {
  const T* data = nullptr;
  std::vector<py::ssize_t> shape;
};

/// Checks an array of float64, all of them finite. Throws TypeError, or ValueError naming `name`.
ArrayView<double> view_of(const py::handle& array, const char* name,
                          std::initializer_list<py::ssize_t> shape);
/// Returns (n, 3) float64 as points. Copies.
deform::Points points_of(const py::handle& array, const char* name, py::ssize_t count = any);
/// Returns (n,) float64. Copies.
Eigen::VectorXd vector_of(const py::handle& array, const char* name, py::ssize_t count = any);
/// Returns a (4, 4) matrix as a rigid motion. Throws ValueError if it is none.
Eigen::Isometry3d motion_of(const double* matrix, const char* name);
/// Returns (m, k) int32 or uint32, k >= 3. Throws ValueError for an index not below `vertices`.
struct Corners {
  std::vector<std::uint32_t> indices;
  std::size_t per_face = 3;
};
Corners corners_of(const py::handle& array, const char* name, std::size_t vertices);
/// Checks a one-dimensional array of this structured type. Throws TypeError or ValueError.
py::array records_of(const py::handle& array, const char* name, const py::dtype& type);

using Shape = std::vector<py::ssize_t>;

template <class T>
py::array_t<T> array_of(const T* data, Shape shape) {
  return py::array_t<T>(std::move(shape), data);
}
/// (n, 3).
inline py::array_t<double> array_of(const deform::Points& points) {
  return array_of(points.data(), {points.cols(), 3});
}
/// (n,).
inline py::array_t<double> array_of(const Eigen::VectorXd& numbers) {
  return array_of(numbers.data(), {numbers.size()});
}
template <class T>
py::array_t<T> array_of(const std::vector<T>& elements) {
  return array_of(elements.data(), {static_cast<py::ssize_t>(elements.size())});
}
/// Writes the 16 numbers of a motion, row by row.
inline void write_motion(const Eigen::Isometry3d& motion, double* out) {
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(out, 4, 4) = motion.matrix();
}

} // namespace nendo::python
