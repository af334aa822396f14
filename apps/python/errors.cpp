#include <cerrno>

#include <unistd.h>

#include "python/bind.hpp"

namespace nendo::python {
namespace {

constexpr const char* module_name = "nendo._nendo";

const char* name_of_code(Errc code) noexcept {
  switch (code) {
  case Errc::failed:
    return "failed";
  case Errc::usage:
    return "usage";
  case Errc::no_device:
    return "no_device";
  case Errc::no_permission:
    return "no_permission";
  case Errc::bad_input:
    return "bad_input";
  }
  return "failed";
}

[[noreturn]] void raise_as(const char* kind, const Error& error) {
  const py::object type = py::module_::import(module_name).attr(kind);
  const py::object made = type(to_str(error.message));
  made.attr("code") = name_of_code(error.code);
  PyErr_SetObject(type.ptr(), made.ptr());
  throw py::error_already_set();
}

/// Makes an exception class of the module. `bases` are one class or a tuple.
py::object add_exception(py::module_& module, const char* name, const char* doc,
                         const py::object& bases) {
  const std::string full = std::string("nendo.") + name;
  const auto made = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr));
  if (!made) throw py::error_already_set();
  module.attr(name) = made;
  return made;
}

} // namespace

void raise(const Error& error) {
  raise_as(error.code == Errc::no_permission ? "AccessError"
           : error.code == Errc::no_device   ? "NotFoundError"
                                             : "Error",
           error);
}

void check_readable(const std::filesystem::path& file) {
  if (::access(file.c_str(), R_OK) == 0) return;
  if (errno == EACCES)
    raise_as("AccessError", {Errc::no_permission, file.string() + ": you may not read it"});
  if (errno == ENOENT || errno == ENOTDIR)
    raise_as("NotFoundError", {Errc::bad_input, file.string() + ": there is no such file"});
}

py::str to_str(std::string_view text) {
  auto made = py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
  if (!made) throw py::error_already_set();
  return made;
}

void warn(std::string_view text) {
  if (PyErr_WarnEx(PyExc_UserWarning, std::string(text).c_str(), 1) != 0)
    throw py::error_already_set();
}

std::optional<Side> side_of(const std::optional<std::string>& name) {
  if (!name) return std::nullopt;
  return choice_of(*name, "side", "\"left\" or \"right\"", side_named);
}

void close_at_exit(const py::object& object) {
  py::module_::import(module_name).attr("_open_ones").attr("add")(object);
}

double number_in(double number, const char* what, double min, double max) {
  if (number >= min && number <= max) return number; // false for NaN
  const auto text = [](double bound) { return std::string(py::str(py::float_(bound))); };
  throw py::value_error(std::string(what) + ": use " + text(min) + " to " + text(max));
}

void add_errors(py::module_& module) {
  const py::object open_ones = py::module_::import("weakref").attr("WeakSet")();
  module.attr("_open_ones") = open_ones;
  py::module_::import("atexit").attr("register")(py::cpp_function([open_ones] {
    for (const py::handle each : py::list(open_ones))
      each.attr("close")();
  }));
  const py::object error = add_exception(module, "Error",
                                         "An error of Nendo, with a message in one line. `code` is "
                                         "its kind: \"failed\", \"usage\" (an "
                                         "argument is wrong), \"no_device\", \"no_permission\" or "
                                         "\"bad_input\" (a file cannot be used).",
                                         py::reinterpret_borrow<py::object>(PyExc_Exception));
  error.attr("code") = name_of_code(Errc::failed);
  const auto with = [&error](PyObject* base) {
    return py::make_tuple(error, py::reinterpret_borrow<py::object>(base));
  };
  add_exception(module, "AccessError", "A device or file that this user may not open.",
                with(PyExc_PermissionError));
  add_exception(module, "NotFoundError",
                "A device, file or run that does not exist, or that does not answer.",
                with(PyExc_FileNotFoundError));
}

} // namespace nendo::python
